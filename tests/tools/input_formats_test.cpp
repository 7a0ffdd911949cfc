// SPDX-License-Identifier: Apache-2.0
// The input formats but for Triangle's and GeoJSON: what files written by hand give, and what is wrong is said.
#include <cstring>

#include "format_cases.hpp"
#include "io/inputs.hpp"

using namespace gcdt;
using namespace gcdt::testing;

namespace {

using Places = std::vector<std::array<double, 2>>;

io::Input from(const std::string& name, const std::string& text) {
  ScratchFolder folder;
  return io::read_input(folder.write(name, text));
}

/// What is said of a file, less its path: ":LINE: what" or ": at byte N: what".
std::string refused(const std::string& name, const std::string& text) {
  ScratchFolder folder;
  const std::string path = folder.write(name, text);
  try {
    io::read_input(path);
  } catch (const Failure& failed) {
    CHECK(failed.exit() == Exit::input);
    const std::string what = failed.what();
    CHECK(what.compare(0, path.size() + 1, path + ":") == 0);
    return what.substr(path.size());
  }
  return "accepted";
}

void check_refused(const std::string& name, std::initializer_list<Malformed> cases) {
  for (const Malformed& malformed : cases) {
    CAPTURE(malformed.text);
    CHECK(refused(name, malformed.text).substr(0, std::strlen(malformed.expected)) == malformed.expected);
  }
}

/// No prefix of a file ends otherwise than as an input or with a message that names it.
void check_prefixes(const std::string& name, const std::string& whole) {
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    CAPTURE(size);
    refused(name, whole.substr(0, size));
  }
}

/// A number with its least byte first.
template <class T>
std::string bytes(T number) {
  std::string text(sizeof number, '\0');
  std::memcpy(text.data(), &number, sizeof number);
  return text;
}
std::string turned(std::string text) {
  std::reverse(text.begin(), text.end());
  return text;
}

const std::string graph = "PSLGBIN1" + bytes<std::int64_t>(3) + bytes<std::int64_t>(2) + bytes(0.) + bytes(0.) +
                          bytes(1.5) + bytes(0.) + bytes(0.) + bytes(-2.) + bytes(0) + bytes(1) + bytes(2) + bytes(1);

/// An array as NumPy writes it, version 1.0.
std::string npy(const std::string& header, const std::string& numbers) {
  return std::string("\x93NUMPY\x01\x00", 8) + bytes(static_cast<std::uint16_t>(header.size())) + header + numbers;
}

}  // namespace

TEST_CASE("a binary graph gives its vertices and segments") {
  const io::Input input = from("in.pslg", graph);
  CHECK(input.vertices == Places{{0, 0}, {1.5, 0}, {0, -2}});
  CHECK(input.constraints == std::vector<Constraint>{{0, 1}, {2, 1}});
  CHECK(from("no.pslg", "PSLGBIN1" + bytes<std::int64_t>(0) + bytes<std::int64_t>(0)).vertices.empty());
}

TEST_CASE("a binary graph that is cut, too long, or names what is not there is refused at its byte") {
  check_prefixes("in.pslg", graph);
  for (std::size_t size = 0; size < graph.size(); ++size)
    CHECK(refused("in.pslg", graph.substr(0, size)) != "accepted");
  CHECK(refused("in.pslg", graph + "x") == ": at byte 24: 3 vertices and 2 segments have 64 bytes, but 65 follow");
  CHECK(refused("in.pslg", "PSLGBIN2" + graph.substr(8)) == ": at byte 8: the word PSLGBIN1 is missing before this");
  const std::string ends = "PSLGBIN1" + bytes<std::int64_t>(1) + bytes<std::int64_t>(1) + bytes(0.) + bytes(0.);
  CHECK(refused("in.pslg", ends + bytes(0) + bytes(1)) == ": at byte 40: segment 0 names vertex 1, but there are 1");
  CHECK(refused("in.pslg", ends + bytes(0) + bytes(-1)) == ": at byte 40: segment 0 names vertex -1, but there are 1");
  CHECK(refused("in.pslg", "PSLGBIN1" + bytes<std::int64_t>(-1) + bytes<std::int64_t>(0)) ==
        ": at byte 16: the number of vertices is negative: -1");
  CHECK(refused("in.pslg", "PSLGBIN1" + bytes(INT64_MAX) + bytes<std::int64_t>(0)) ==
        ": at byte 16: the number of vertices is 9223372036854775807; at most 536870910 are possible");
  CHECK(refused("in.pslg", "PSLGBIN1" + bytes<std::int64_t>(536870910) + bytes<std::int64_t>(2147483647)) ==
        ": at byte 24: 536870910 vertices and 2147483647 segments have 25769803736 bytes, but 0 follow");
}

TEST_CASE("an array gives vertices, whatever its order and its kind of number") {
  const std::string rows = bytes(1.) + bytes(2.) + bytes(3.) + bytes(4.) + bytes(5.) + bytes(6.);
  const Places expected{{1, 2}, {3, 4}, {5, 6}};
  CHECK(from("a.npy", npy("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }\n", rows)).vertices == expected);
  const std::string columns = bytes(1.) + bytes(3.) + bytes(5.) + bytes(2.) + bytes(4.) + bytes(6.);
  CHECK(from("a.npy", npy("{'descr': '<f8', 'fortran_order': True, 'shape': (3, 2), }", columns)).vertices == expected);
  std::string other;
  for (const float c : {1.f, 2.f, 3.f, 4.f, 5.f, 6.f}) other += turned(bytes(c));
  CHECK(from("a.npy", npy("{'descr': '>f4', 'fortran_order': False, 'shape': (3, 2), }", other)).vertices == expected);
  const std::string small("\1\2\3\4\5\6", 6);
  CHECK(from("a.npy", npy("{'descr':'|u1','fortran_order':False,'shape':(3,2)}", small)).vertices == expected);
  const io::Input high = from("a.npy", npy("{'descr': '|i1', 'fortran_order': False, 'shape': (2, 3), }", small));
  CHECK(high.vertices == Places{{1, 2}, {4, 5}});
  CHECK(high.attributes == std::vector<double>{3, 6});
  CHECK(high.heights);
}

TEST_CASE("arrays that are none, cut, of another shape or too large are refused") {
  const auto said = [](const std::string& header, const std::string& numbers) {
    return refused("a.npy", npy(header, numbers));
  };
  check_prefixes("a.npy", npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), }", bytes(1.) + bytes(2.)));
  CHECK(refused("a.npy", "") == ": this is no NumPy array: it does not begin with \\x93NUMPY");
  CHECK(said("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), }", bytes(1.)) ==
        ": 2 numbers of 8 bytes are announced, but 8 bytes follow the header");
  CHECK(said("{'descr': '<f8', 'fortran_order': False, 'shape': (9999999999999, 2), }", "") ==
        ": the array has 9999999999999 rows and 2 columns: too many");
  CHECK(said("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999999, 2), }", "") ==
        ": the shape in the header cannot be read");
  CHECK(said("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1, 2), }", bytes(1.) + bytes(2.)) ==
        ": the array has 3 dimensions; 1 or 2 are read");
  CHECK(said("{'descr': '|O', 'fortran_order': False, 'shape': (1, 2), }", "") ==
        ": the array holds '|O'; numbers such as '<f8', '<f4' or '<i4' are read");
  CHECK(said("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }", bytes(1.) + bytes(2.)) ==
        ": vertices have 2 columns, and more for attributes; these have 1");
  CHECK(said("", "") == ": the array holds no kind of number; numbers such as '<f8', '<f4' or '<i4' are read");
}

TEST_CASE("well-known text gives vertices, lines and directed rings") {
  const io::Input input = from("in.wkt",
                               "POINT (1 2)\nSRID=4326;LINESTRING(0 0, 5 5 ,6 6);\n\nPolygon ((0 0, 0 10, 10 10, 10 0, "
                               "0 0), (1 1, 2 1, 2 2, 1 1)) MULTIPOINT ((7 7), 8 8, EMPTY) POLYGON EMPTY");
  CHECK(
      input.vertices ==
      Places{
          {1, 2}, {0, 0}, {5, 5}, {6, 6}, {0, 0}, {0, 10}, {10, 10}, {10, 0}, {1, 1}, {2, 1}, {2, 2}, {7, 7}, {8, 8}});
  // The outer ring is turned counter-clockwise, the hole clockwise.
  CHECK(input.constraints ==
        std::vector<Constraint>{{1, 2}, {2, 3}, {5, 4}, {6, 5}, {7, 6}, {4, 7}, {9, 8}, {10, 9}, {8, 10}});
}

TEST_CASE("third numbers of well-known text are heights unless they are measures") {
  CHECK(from("in.wkt", "LINESTRING Z (0 0 5, 1 1 6)").attributes == std::vector<double>{5, 6});
  CHECK(from("in.wkt", "LINESTRINGZM (0 0 5 1, 1 1 6 2)").attributes == std::vector<double>{5, 6});
  CHECK(from("in.wkt", "POINTZ (0 0 5)").attributes == std::vector<double>{5});
  CHECK(from("in.wkt", "LINESTRING(0 0 5,1 1 6)").attributes == std::vector<double>{5, 6});
  CHECK(from("in.wkt", "LINESTRING M (0 0 5, 1 1 6)").attributes.empty());
}

TEST_CASE("collections, triangles and surfaces of well-known text are their parts") {
  CHECK(from("in.wkt", "GEOMETRYCOLLECTION(POINT(1 1),GEOMETRYCOLLECTION(LINESTRING(0 0,1 0)))").constraints.size() ==
        1);
  CHECK(from("in.wkt", "TIN(((0 0,1 0,0 1,0 0)),((1 0,1 1,0 1,1 0)))").constraints.size() == 6);
  CHECK(from("in.wkt", "MULTIPOLYGON(((0 0,1 0,0 1)),((5 5,6 5,5 6,5 5)))").constraints.size() == 6);
  CHECK(from("in.wkt", "TRIANGLE((0 0,1 0,0 1,0 0))").constraints.size() == 3);
  CHECK(from("in.wkt", "").vertices.empty());
}

TEST_CASE("malformed well-known text is refused with the line, and with what stands there") {
  check_refused("in.wkt", {{"POINT(1 2)\nPOYLGON((1 1))", ":2: POINT, LINESTRING, POLYGON, their MULTI forms"},
                           {"\n\nPOINT(1)", ":3: a number is due, not \")\""},
                           {"POINT(1 x)", ":1: a number is due, not \"x)\""},
                           {"LINESTRING(0 0,\n1 nan)", ":2: a finite number is due, not \"nan)\""},
                           {"LINESTRING(0 0,1 1e999)", ":1: a finite number is due, not \"1e999)\""},
                           {"LINESTRING(0 0", ":1: a number is due, not the end of the file"},
                           {"POINT(1 2 3 4 5)", ":1: ',' or ')' is due after four numbers, not \"5)\""},
                           {"POLYGON(0 0,1 1)", ":1: '(' is due, not \"0 0,1 1)\""},
                           {"12", ":1: a geometry such as POLYGON is due, not \"12\""},
                           {"SRID=;POINT(1 1)", ":1: a number is due, not \";POINT(1 1)\""}});
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "GEOMETRYCOLLECTION(";
  CHECK(refused("in.wkt", deep).substr(0, 50) == ":1: fewer collections in collections are due, not ");
  check_prefixes("in.wkt", "SRID=4;MULTIPOLYGON Z(((0 0 1,1 0 1,0 1 1)),((5 5 1,6 5 1,5 6 1,5 5 1)));POINT EMPTY");
}

TEST_CASE("well-known binary is read in both orders of bytes, of ISO and of PostGIS, and as digits") {
  const auto word = [](std::uint32_t w) { return bytes(w); };
  const std::string line = '\1' + word(2) + word(2) + bytes(0.) + bytes(1.) + bytes(2.) + bytes(3.);
  CHECK(from("in.wkb", line).vertices == Places{{0, 1}, {2, 3}});
  CHECK(from("in.wkb", line).constraints == std::vector<Constraint>{{0, 1}});
  const std::string big = '\0' + turned(word(2)) + turned(word(2)) + turned(bytes(0.)) + turned(bytes(1.)) +
                          turned(bytes(2.)) + turned(bytes(3.));
  CHECK(from("in.wkb", big + line).vertices == Places{{0, 1}, {2, 3}, {0, 1}, {2, 3}});
  const std::string iso = '\1' + word(1001) + bytes(4.) + bytes(5.) + bytes(6.);
  CHECK(from("in.wkb", iso).attributes == std::vector<double>{6});
  const std::string postgis = '\1' + word(0xA0000001) + word(4326) + bytes(4.) + bytes(5.) + bytes(6.);
  CHECK(from("in.wkb", postgis).vertices == Places{{4, 5}});
  CHECK(from("in.wkb", postgis).attributes == std::vector<double>{6});
  // POINT (1 2), as PostGIS shows it.
  CHECK(from("in.wkb", "0101000000000000000000F03F0000000000000040\n").vertices == Places{{1, 2}});
}

TEST_CASE("well-known binary that is cut, or announces more than there is, is refused at its byte") {
  const auto word = [](std::uint32_t w) { return bytes(w); };
  const std::string ring =
      word(4) + bytes(0.) + bytes(0.) + bytes(1.) + bytes(0.) + bytes(0.) + bytes(1.) + bytes(0.) + bytes(0.);
  const std::string polygon = '\1' + word(3) + word(1) + ring;
  CHECK(from("in.wkb", polygon).constraints == std::vector<Constraint>{{0, 1}, {1, 2}, {2, 0}});
  for (std::size_t size = 1; size < polygon.size(); ++size)
    CHECK(refused("in.wkb", polygon.substr(0, size)).substr(0, 10) == ": at byte ");
  CHECK(refused("in.wkb", '\1' + word(2) + word(0xffffffff)) ==
        ": at byte 9: 4294967295 parts of at least 16 bytes are announced, but 0 bytes follow");
  CHECK(refused("in.wkb", '\1' + word(77)) == ": at byte 5: there is no type 77");
  CHECK(refused("in.wkb", std::string("\7")) ==
        ": at byte 1: a geometry begins with 0 or 1 for the order of bytes, not 7");
  CHECK(refused("in.wkb", '\1' + word(4) + word(1) + '\1' + word(2) + word(0)) ==
        ": at byte 14: a geometry of type 1 is due, not 2");
  CHECK(refused("in.wkb", "010") == ": the number of hexadecimal digits is odd");
  CHECK(refused("in.wkb", "01 0g") == ": at byte 4: no hexadecimal digit");
  std::string deep;
  for (int i = 0; i < 1000; ++i) deep += '\1' + word(7) + word(1);
  CHECK(refused("in.wkb", deep + std::string(8000, '\0')) == ": at byte 585: collections are nested too deeply");
}

TEST_CASE("points come from columns, by name or the first two, and other numbers are attributes") {
  const io::Input plain = from("in.csv", "1,2,7\n3.5,-4e1,8\n\n5,6,9\n");
  CHECK(plain.vertices == Places{{1, 2}, {3.5, -40}, {5, 6}});
  CHECK(plain.attributes == std::vector<double>{7, 8, 9});
  CHECK(plain.vertex_lines.of(2) == 4);
  const io::Input named = from("in.csv", "\xEF\xBB\xBFname;Lat;Lon;z\r\n\"a;b\";50;8;100\r\nc;51;9;120\r\n");
  CHECK(named.vertices == Places{{8, 50}, {9, 51}});
  CHECK(named.attributes == std::vector<double>{100, 120});
  REQUIRE(named.notes.size() == 1);
  CHECK(named.notes[0].substr(0, 8) == "column 1");
  CHECK(from("in.csv", "1\t2\n3\t4\n").vertices == Places{{1, 2}, {3, 4}});
  CHECK(from("in.csv", "  1   2\n3 4  \n").vertices == Places{{1, 2}, {3, 4}});
  CHECK(from("in.csv", "x,y,z\n1,2,3\n").heights);
  CHECK(from("in.csv", "x,y\n").vertices.empty());
  CHECK(from("in.csv", "").vertices.empty());
}

TEST_CASE("lines of points that do not fit are refused") {
  check_refused("in.csv", {{"1,2\n3\n", ":2: 1 columns, but the lines before have 2"},
                           {"x,y\n1,2\n3,a b\n", ":3: column 2 must be a number, not \"a b\""},
                           {"1,2\n\nnan,2\n", ":3: a coordinate is not finite"},
                           {"1,2\n1e999,2\n", ":2: a coordinate is not finite"},
                           {"1\n", ":1: x and y are due, in two columns"},
                           {"1,2,3\n1,2,\n", ":2: column 3 must be a number, not \"\""}});
  CHECK(refused("in.csv", std::string(5000, ',') + "\n") == ":1: more than 1002 columns");
}

TEST_CASE("CDT's text files give vertices and edges") {
  const io::Input input = from("in.txt", "3 2\n0 0\n1.5 0\n0 -2\n0 1\n2 1\n");
  CHECK(input.vertices == Places{{0, 0}, {1.5, 0}, {0, -2}});
  CHECK(input.constraints == std::vector<Constraint>{{0, 1}, {2, 1}});
  CHECK(input.constraint_lines.of(1) == 6);
  check_refused("in.txt", {{"", ":1: the numbers of vertices and edges are missing"},
                           {"2 1\n0 0\n", ":2: the file ends after 1 of 2 vertices"},
                           {"1 1\n0 0\n0 1\n", ":3: there is no vertex 1; there are 1, from 0 on"},
                           {"1 1\n0 0\n0 -1\n", ":3: there is no vertex -1; there are 1, from 0 on"},
                           {"1 0\n0 inf\n", ":2: the y coordinate is not finite: inf"},
                           {"99999999999 0\n", ":1: the number of vertices is 99999999999; at most 536870910"},
                           {"1 0\n0 0\n0 0\n", ":3: more text than the counts announce"}});
}

TEST_CASE("faces and lines of surfaces are constraints, and heights are an attribute") {
  const std::vector<Constraint> around{{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  const io::Input obj = from("in.obj",
                             "# a square\no thing\nv 0 0 5\nv 1 0 6\nv 1 1 7\nv 0 1 8\nvn 0 0 1\nf 1/1/1 2//1 3 4\n"
                             "l -4 -2\n");
  CHECK(obj.vertices == Places{{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  CHECK(obj.constraints == std::vector<Constraint>{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}});
  CHECK(obj.attributes == std::vector<double>{5, 6, 7, 8});
  CHECK(obj.first == 1);
  CHECK(from("in.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n").constraints == around);
  CHECK(from("in.off", "OFF 1 0 0\n# none\n3 4 0\n").attributes.empty());
  // Colours, normals and texture coordinates follow those of the vertices, in their order or not.
  for (const auto& [kind, more] :
       {std::pair("COFF", "255 0 0 255"), std::pair("NOFF", "0 0 1"), std::pair("STOFF", ".5 1"),
        std::pair("CNOFF", "0 0 1 1 0 0 1"), std::pair("STCNOFF", "0 0 1 1 0 0 1 .5 1")}) {
    CAPTURE(kind);
    std::string text = std::string(kind) + "\n4 1 0\n";
    for (const char* place : {"0 0 5 ", "1 0 6 ", "1 1 7 ", "0 1 8 "}) text += std::string(place) + more + '\n';
    const io::Input off = from("in.off", text + "4 0 1 2 3\n");
    CHECK(off.vertices == obj.vertices);
    CHECK(off.constraints == around);
    CHECK(off.attributes == obj.attributes);
  }
  const std::string header =
      "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property uchar red\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  const io::Input ply = from("in.ply", header + "0 0 9 0\n1 0 9 0\n1 1 9 0\n0 1 9 2\n4 0 1 2 3\n1 3\n");
  CHECK(ply.vertices == obj.vertices);
  CHECK(ply.constraints == std::vector<Constraint>{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 3}});
  CHECK(ply.attributes == std::vector<double>{0, 0, 0, 2});
}

TEST_CASE("binary polygon files are read in both orders of bytes") {
  const std::string after =
      " 1.0\nelement vertex 2\nproperty double x\nproperty short y\nelement what 1\n"
      "property list uchar ushort some\nelement edge 1\nproperty int vertex1\nproperty uint vertex2\n"
      "end_header\n";
  const std::string list = std::string(1, '\2');
  const std::string little = bytes(1.5) + bytes(std::int16_t{-2}) + bytes(3.) + bytes(std::int16_t{4}) + list +
                             bytes(std::int16_t{7}) + bytes(std::int16_t{7}) + bytes(1) + bytes(0);
  const auto t = [](auto n) { return turned(bytes(n)); };
  const std::string big = t(1.5) + t(std::int16_t{-2}) + t(3.) + t(std::int16_t{4}) + list + t(std::int16_t{7}) +
                          t(std::int16_t{7}) + t(1) + t(0);
  for (const auto& [order, body] : {std::pair("little", little), std::pair("big", big)}) {
    const std::string whole = std::string("ply\nformat binary_") + order + "_endian" + after + body;
    const io::Input input = from("in.ply", whole);
    CHECK(input.vertices == Places{{1.5, -2}, {3, 4}});
    CHECK(input.constraints == std::vector<Constraint>{{1, 0}});
    for (std::size_t size = 0; size < whole.size(); ++size)
      CHECK(refused("in.ply", whole.substr(0, size)) != "accepted");
  }
}

TEST_CASE("surfaces that name what is not there, or are no surfaces, are refused") {
  check_refused("in.obj", {{"v 0 0 0\nf 1 2 3\n", ":2: there is no vertex 2; there are 1 before this line"},
                           {"v 0 0 0\nf 1 0 1\n", ":2: there is no vertex 0; there are 1 before this line"},
                           {"v 0 0 0\nf 1 -2 1\n", ":2: there is no vertex -2; there are 1 before this line"},
                           {"v 0\n", ":1: y coordinate is missing"},
                           {"v 0 0 0\nf 1 1\n", ":2: a face has at least 3 corners"},
                           {"v 0 0 0\nl 1 x/2\n", ":2: a corner must be a number, not \"x/2\""},
                           {"v nan 0 0\n", ":1: the x coordinate is not finite: nan"}});
  check_refused("in.off", {{"", ":1: the word OFF is missing"},
                           {"PLY\n", ":1: the word OFF is missing"},
                           {"XOFF\n", ":1: the word OFF is due, not XOFF"},
                           {"4OFF\n1 0 0\n0 0 0 1\n", ":1: 4OFF has points of another dimension than 3"},
                           {"STCN4OFF\n", ":1: STCN4OFF has points of another dimension than 3"},
                           {"nOFF\n2\n1 0 0\n0 0\n", ":1: nOFF has points of another dimension than 3"},
                           {"C4nOFF\n", ":1: C4nOFF has points of another dimension than 3"},
                           {"OFF BINARY\n", ":1: the number of vertices must be an integer, not \"BINARY\""},
                           {"OFF\n", ":1: the number of vertices is missing"},
                           {"OFF\n2 0 0\n0 0 0\n", ":3: the file ends after 1 of 2 vertices"},
                           {"OFF\n1 1 0\n0 0 0\n3 0 0 1\n", ":4: the number of corners is 3; at most 1 are possible"},
                           {"OFF\n1 1 0\n0 0 0\n1 1\n", ":4: there is no vertex 1; there are 1, from 0 on"}});
  const std::string begin = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n";
  const std::string face = begin + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0\n";
  CHECK(refused("in.ply", face + "3 0 0 1\n") == ":10: there is no vertex 1; there are 1, from 0 on");
  CHECK(refused("in.ply", face + "3 0 0 0.5\n") == ":10: there is no vertex 0.5; there are 1, from 0 on");
  CHECK(refused("in.ply", face + "3 0 0\n") == ":11: the file ends before its last number");
  CHECK(refused("in.ply", face + "9999999 0 0\n") == ":10: a list of 9999999 numbers");
  CHECK(refused("in.ply", begin + "end_header\n0 x\n") == ":7: a number is due");
  CHECK(refused("in.ply", begin + "end_header\n0 inf\n") == ":7: a coordinate is not finite");
  CHECK(refused("in.ply", "") == ":1: the word ply is missing");
  CHECK(refused("in.ply", begin) == ":6: the header has no end");
  CHECK(refused("in.ply", "ply\nformat ascii 1.0\nelement vertex -1\n") == ":3: an element has a name and a count");
  CHECK(refused("in.ply", "ply\nformat ascii 1.0\nend_header\n") == ":4: there is no element \"vertex\" with x and y");
  CHECK(refused("in.ply",
                "ply\nformat ascii 1.0\nelement vertex 9999999999\nproperty int x\nproperty int y\nend_header\n") ==
        ":7: the number of vertices is 9999999999; at most 536870910 are possible");
}

TEST_CASE("arrays of rings without a word of GeoJSON are polygons") {
  const std::vector<Constraint> one{{0, 1}, {1, 2}, {2, 0}};
  CHECK(from("in.json", "[[0,0],[1,0],[0,1],[0,0]]").constraints == one);
  CHECK(from("in.json", "[[[0,0],[1,0],[0,1]]]").constraints == one);
  CHECK(from("in.json", "[[[[0,0],[1,0],[0,1]]]]").constraints == one);
  // The second ring of a polygon is a hole, and clockwise; the first of a second polygon is not.
  CHECK(from("in.json", "[[[0,0],[9,0],[0,9]],[[1,1],[2,1],[1,2]]]").constraints ==
        std::vector<Constraint>{{0, 1}, {1, 2}, {2, 0}, {4, 3}, {5, 4}, {3, 5}});
  CHECK(from("in.json", "[[[[0,0],[9,0],[0,9]]],[[[1,1],[2,1],[1,2]]]]").constraints ==
        std::vector<Constraint>{{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}});
  CHECK(from("in.json", "[]").vertices.empty());
  check_refused("in.json", {{"[[0,0],\n[1]]", ":2: the file, position 1: a position of two numbers is due, not [1]"},
                            {"[[[[[0,0]]]]]", ":1: the file: arrays are nested deeper than"},
                            {"[1,2]", ":1: the file, ring 0: an array is due, not 1"}});
}

TEST_CASE("folders and missing files of any format are refused") {
  ScratchFolder folder;
  for (const io::InputFormat& format : io::input_formats()) {
    const std::string extension = format.extension;
    CAPTURE(extension);
    if (format.read == io::read_with_gdal) continue;
    const std::string missing = folder / ("no" + extension), directory = folder / ("folder" + extension);
    std::filesystem::create_directory(directory);
    CHECK(failure(missing, Exit::input, [&] { io::read_input(missing); }).find("cannot be opened") !=
          std::string::npos);
    CHECK(failure(directory, Exit::input, [&] { io::read_input(directory); }).find("cannot be read") !=
          std::string::npos);
  }
}

// SPDX-License-Identifier: Apache-2.0
// Input that is made to hurt: every line has limits of time and of memory, and what is invalid ends with status 3.
#include "command_session.hpp"

using namespace gcdt::testing;

namespace {

/// A shell line under limits. Seconds are those of a busy machine; address space is what a parser may take for the
/// files below. The sanitizers' shadow memory needs more than any limit.
std::string limited(const std::string& line, int megabytes = 1024, int seconds = 60) {
#if defined(__SANITIZE_ADDRESS__)
  (void)megabytes;
  const std::string memory;
#else
  const std::string memory = "ulimit -v " + std::to_string(megabytes * 1024) + " && ";
#endif
  return "( " + memory + "timeout " + std::to_string(seconds) + " " + line + " )";
}

/// Runs the command under limits: it must end with status 3 and one line that has `part` in it.
void invalid(const Session& session, const std::string& arguments, const std::string& part,
             const std::string& before = "") {
  CAPTURE(arguments);
  const Outcome outcome =
      session.shell(before + limited("\"$gcdt\" " + arguments) + (before.empty() ? " </dev/null" : ""));
  CAPTURE(outcome.err.substr(0, 400));
  CHECK(outcome.status == 3);
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  CHECK(contains(outcome.err, part));
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

std::string little(std::uint64_t number, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(number >> 8 * i & 255);
  return text;
}

}  // namespace

TEST_CASE("files of no bytes are invalid, or an input without vertices where nothing needs a header") {
  const Session session;
  for (const char* extension : {"poly", "node", "geojson", "json", "pslg", "npz", "npy", "txt", "off", "ply"}) {
    const std::string name = std::string("empty.") + extension;
    session.write(name, "");
    invalid(session, "triangulate " + name, name);
  }
  invalid(session, "triangulate -", "<stdin>");
  for (const char* extension : {"wkt", "wkb", "csv", "obj"}) {
    const std::string name = std::string("empty.") + extension;
    session.write(name, "");
    CHECK(session.shell(limited("\"$gcdt\" triangulate --quiet " + name, 16384)).status == 0);
  }
}

TEST_CASE("gigabytes without a blank are no records: little of them is read") {
  const Session session;
  session.run("truncate -s 5G zeros.poly zeros.csv zeros.obj");
  for (const char* name : {"zeros.poly", "zeros.csv", "zeros.obj"})
    invalid(session, std::string("triangulate ") + name, "a word of more than 1048576 bytes");
  invalid(session, "triangulate -", "<stdin>: a word of more than 1048576 bytes", "yes 7 | tr -d '\\n' | ");
}

TEST_CASE("files larger than memory end with a status, not with the process") {
  const Session session;
  session.run("truncate -s 5G zeros.wkb zeros.json zeros.ply");
  for (const char* name : {"zeros.wkb", "zeros.json", "zeros.ply"}) {
    CAPTURE(name);
#if !defined(__SANITIZE_ADDRESS__)
    const Outcome outcome = session.shell(limited(std::string("\"$gcdt\" triangulate ") + name));
    CHECK(outcome.status == 4);
    CHECK(outcome.err == "gcdt: out of memory\n");
#endif
  }
}

TEST_CASE("nesting a million deep is refused in every format that nests") {
  const Session session;
  constexpr int deep = 1000000;
  const std::string open = repeated("[", deep), close = repeated("]", deep);
  const std::string nested[] = {open + close,
                                open,
                                "{\"type\":" + open + close + "}",
                                "{\"type\":\"Point\",\"coordinates\":[1," + open + close + "]}",
                                "{\"type\":\"Point\",\"properties\":" + open + close + ",\"coordinates\":[1,2]}",
                                repeated("{\"a\":", deep) + "1" + repeated("}", deep),
                                repeated("{\"type\":\"GeometryCollection\",\"geometries\":[", deep)};
  for (const std::string& text : nested) {
    session.write("deep.geojson", text);
    invalid(session, "triangulate deep.geojson", "deep.geojson:1: nested deeper than 1000");
  }
  // Brackets in texts do not count, nor do quotes behind a backslash.
  session.write("quoted.geojson", R"({"type": "Point", "name": "\"\\)" + open + R"(", "coordinates": [1, 2]})");
  CHECK(session.shell(limited("\"$gcdt\" triangulate --quiet quoted.geojson", 16384)).status == 0);
  session.write("deep.geojsonl", nested[2] + "\n");
  CHECK(session.shell(limited("\"$gcdt\" batch --quiet deep.geojsonl", 16384)).status == 3);
  session.write("deep.wkt", repeated("GEOMETRYCOLLECTION(", deep));
  invalid(session, "triangulate deep.wkt", "collections");
  session.write("deep.wkb", repeated(std::string("\x01\x07\0\0\0\x01\0\0\0", 9), deep));
  invalid(session, "triangulate deep.wkb", "nested too deeply");
  session.write("deep.vtu", "<VTKFile><UnstructuredGrid>" + repeated("<a>", deep) + repeated("</a>", deep) +
                                "</UnstructuredGrid></VTKFile>");
  session.write("points.node", "1 2 0 0\n0 0 0\n");
  invalid(session, "locate deep.vtu points.node", "no Piece");
}

TEST_CASE("counts that overflow, or that the file cannot hold, take no memory") {
  const Session session;
  for (const char* count :
       {"536870911", "4294967296", "9223372036854775807", "18446744073709551616", "1e9", "-1", "0x10"}) {
    session.write("counts.poly", std::string(count) + " 2 0 0\n1 0 0\n");
    invalid(session, "triangulate counts.poly", "counts.poly:");
    session.write("segments.poly", std::string("1 2 0 0\n1 0 0\n") + count + " 0\n");
    invalid(session, "triangulate segments.poly", "segments.poly:3");
    session.write("counts.txt", std::string(count) + " 0\n0 0\n");
    invalid(session, "triangulate counts.txt", "counts.txt");
    session.write("counts.off", std::string("OFF\n") + count + " 0 0\n0 0 0\n");
    invalid(session, "triangulate counts.off", "counts.off");
    session.write("counts.ply", std::string("ply\nformat ascii 1.0\nelement vertex ") + count +
                                    "\nproperty float x\nproperty float y\nend_header\n");
    invalid(session, "triangulate counts.ply", "counts.ply");
  }
  session.write("attributes.node", "1 2 4294967295 0\n1 0 0\n");
  invalid(session, "triangulate attributes.node", "attributes.node:1");
  for (const std::uint64_t count :
       {std::uint64_t{1} << 28, std::uint64_t{1} << 60, UINT64_MAX, std::uint64_t{1} << 63}) {
    session.write("counts.pslg", "PSLGBIN1" + little(count, 8) + little(0, 8) + little(0, 16));
    invalid(session, "triangulate counts.pslg", "counts.pslg");
    session.write("counts.npy", "\x93NUMPY" + std::string("\x01\0", 2) + little(80, 2) +
                                    ("{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(count) +
                                     ", 2), }" + std::string(80, ' '))
                                        .substr(0, 80));
    invalid(session, "triangulate counts.npy", "counts.npy");
    session.write("counts.wkb", "\x01" + little(2, 4) + little(count, 4));
    if (count << 32 != 0) invalid(session, "triangulate counts.wkb", "counts.wkb");
  }
}

TEST_CASE("negative and huge vertex numbers are named") {
  const Session session;
  for (const char* number : {"-1", "3", "2147483648", "4294967296", "99999999999999999999", "-99999999999999999999"}) {
    session.write("ends.poly", std::string("3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n1 0\n0 0 ") + number + "\n0\n");
    invalid(session, "triangulate ends.poly", "ends.poly:6: segment 0 names vertex ");
    session.write("ends.off", std::string("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 ") + number + "\n");
    invalid(session, "triangulate ends.off", "ends.off:6");
    session.write("ends.obj", std::string("v 0 0 0\nv 1 0 0\nf 1 2 ") +
                                  (number[0] == '3' ? "3" : std::string(number) + "9") + "\n");
    invalid(session, "triangulate ends.obj", "ends.obj:3");
  }
  session.write("ends.pslg",
                "PSLGBIN1" + little(1, 8) + little(1, 8) + little(0, 16) + little(0, 4) + little(0xFFFFFFFF, 4));
  invalid(session, "triangulate ends.pslg", "ends.pslg");
}

TEST_CASE("numbers that are not finite are refused, whatever their bits; denormals are numbers") {
  const Session session;
  for (const std::uint64_t bits :
       {0x7FF8000000000000u, 0x7FF0000000000001u, 0xFFF8DEADBEEF0001u, 0x7FF0000000000000u}) {
    session.write("nan.pslg",
                  "PSLGBIN1" + little(3, 8) + little(0, 8) + little(0, 24) + little(bits, 8) + little(0, 16));
    invalid(session, "triangulate nan.pslg", "is not finite");
    session.write("nan.wkb", "\x01" + little(1, 4) + little(0, 8) + little(bits, 8));
    invalid(session, "triangulate nan.wkb", "is not finite");
  }
  for (const char* text : {"nan", "-nan", "inf", "-inf", "1e999", "nan(0x1)"}) {
    session.write("nan.poly", std::string("1 2 0 0\n0 0 ") + text + "\n0 0\n0\n");
    invalid(session, "triangulate nan.poly", "nan.poly:2");
  }
  session.write("denormals.poly", "4 2 0 0\n0 0 0\n1 5e-324 0\n2 5e-324 1e-323\n3 0 3e-316\n1 0\n0 0 2\n0\n");
  session.good("triangulate denormals.poly --verify -o o.ele");
  CHECK(contains(session.good("verify denormals.poly o.ele"), "valid: 4 vertices"));
}

TEST_CASE("folders are no files, and links to files are") {
  const Session session;
  session.write("in.poly", square);
  session.run(
      "mkdir d.poly d.npz d.pslg d.wkb && ln -s in.poly link.poly && ln -s nowhere.poly dangling.poly && "
      "ln -s loop.poly loop.poly");
  for (const char* name : {"d.poly", "d.npz", "d.pslg", "d.wkb", "dangling.poly", "loop.poly"})
    invalid(session, std::string("triangulate ") + name, name);
  invalid(session, "verify in.poly d.poly/x.ele", "d.poly/x.ele");
  session.good("triangulate link.poly --verify -o o.ele");
  session.run("ln -s o.ele link.ele && cp o.ele before.ele");
  session.good("triangulate in.poly -o link.ele");
  session.run("test -L link.ele && cmp o.ele before.ele");
  CHECK(session.gcdt("triangulate in.poly -o d.poly").status == 6);
  CHECK(session.gcdt("triangulate link.poly -o in.poly").status == 2);
}

TEST_CASE("a page shows names as text") {
  const Session session;
  session.write("<img src=x onerror=alert(1)>.poly", square);
  session.good("view '<img src=x onerror=alert(1)>.poly' -o page.html");
  CHECK(!contains(session.read("page.html"), "<img"));
  CHECK(contains(session.read("page.html"), "&lt;img src=x onerror=alert(1)&gt;"));
  session.good("view '<img src=x onerror=alert(1)>.poly' --title '</title><script>alert(2)</script>' -o page.html");
  CHECK(!contains(session.read("page.html"), "<script>alert"));
  // Names of arrays, which are those of attributes.
  session.good("triangulate '<img src=x onerror=alert(1)>.poly' -o o.svg");
  CHECK(!contains(session.read("o.svg"), "<img"));
}

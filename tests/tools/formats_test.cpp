// SPDX-License-Identifier: Apache-2.0
// The command's file formats: what is read is what was written, and what is malformed is said with its line.
#include <cmath>
#include <limits>

#include "format_cases.hpp"
#include "io/grid_text.hpp"

using namespace gcdt;
using namespace gcdt::testing;

TEST_CASE("a poly file gives its vertices and segments, numbered from 0 or from 1") {
  const io::Input zero = poly("3 2 0 0\n0 0 0\n1 1.5 0\n2 0 -2e-3\n2 0\n0 0 1\n1 2 1\n0\n");
  CHECK(zero.vertices == std::vector<std::array<double, 2>>{{0, 0}, {1.5, 0}, {0, -0.002}});
  CHECK(zero.constraints == std::vector<Constraint>{{0, 1}, {2, 1}});
  CHECK(zero.first == 0);
  const io::Input one = poly("3 2 0 0\n1 0 0\n2 1.5 0\n3 0 -2e-3\n2 0\n1 1 2\n2 3 2\n0\n");
  CHECK(one.vertices == zero.vertices);
  CHECK(one.constraints == zero.constraints);
  CHECK(one.first == 1);
  CHECK(one.first_constraint == 1);
}

TEST_CASE("comments, blank lines, attributes, markers, Windows line ends and a missing last newline are read over") {
  const io::Input input = poly(
      "\xEF\xBB\xBF# a comment\r\n\r\n  \t\r\n3 2 2 1 # header\r\n 1\t0 +1 7 nan 1\r\n# between\r\n2 1e0 0. 8 8 "
      "1#near\r\n3 .5 1 9 9 1\r\n"
      "1 1\r\n1 1 2 -5\r\n1 # holes\r\n1 0.5 0.5\r\n1\r\n1 0.5 0.5 1 0.1");
  CHECK(input.vertices == std::vector<std::array<double, 2>>{{0, 1}, {1, 0}, {0.5, 1}});
  CHECK(input.constraints == std::vector<Constraint>{{0, 1}});
  CHECK(input.attribute_count == 2);
  CHECK(input.attributes.size() == 6);
  CHECK(input.attributes[2] == 8);
  CHECK(input.vertex_markers == std::vector<std::int32_t>{1, 1, 1});
  CHECK(input.constraint_markers == std::vector<std::int32_t>{-5});
  CHECK(input.holes == std::vector<std::array<double, 2>>{{0.5, 0.5}});
  REQUIRE(input.regions.size() == 1);
  CHECK(input.regions[0].attribute == 1);
  CHECK(input.regions[0].largest_area == 0.1);
  CHECK(input.vertex_lines.of(0) == 5);
  CHECK(input.vertex_lines.of(1) == 7);
  CHECK(input.vertex_lines.of(2) == 8);
  CHECK(input.constraint_lines.of(0) == 10);
  CHECK(input.constraint_lines.of(1) == 0);
}

TEST_CASE("the sections after the segments may be absent, and a header may be a number alone") {
  CHECK(poly("1\n0 5 6\n0").vertices.size() == 1);
  CHECK(poly("0 2 0 0\n0 0\n0\n").vertices.empty());
}

TEST_CASE("a poly file without vertices takes them from the node file beside it") {
  ScratchFolder folder;
  folder.write("in.node", "2 2 0 0\n1 0 0\n2 1 1\n");
  const std::string path = folder.write("in.poly", "0 2 0 0\n1 0\n1 1 2\n0\n");
  const io::Input input = io::read_input(path);
  CHECK(input.vertices.size() == 2);
  CHECK(input.constraints == std::vector<Constraint>{{0, 1}});
  CHECK(input.files == std::vector<std::string>{path, folder / "in.node"});
  const std::string alone = folder.write("alone.poly", "0 2 0 0\n1 0\n1 1 2\n0\n");
  CHECK(failure(alone, Exit::input, [&] { io::read_input(alone); }).find("no file") != std::string::npos);
}

TEST_CASE("malformed poly files are refused with the line and the reason") {
  const Malformed cases[] = {
      {"", "1: the number of vertices is missing"},
      {"# nothing\n\n", "2: the number of vertices is missing"},
      {"three\n", "1: the number of vertices must be an integer, not \"three\""},
      {"3.5 2 0 0\n", "1: the number of vertices must be an integer, not \"3.5\""},
      {"1e18 2 0 0\n", "1: the number of vertices must be an integer, not \"1e18\""},
      {"-1 2 0 0\n", "1: the number of vertices is negative: -1"},
      {"1000000000000000000 2 0 0\n",
       "1: the number of vertices is 1000000000000000000; at most 536870910 are possible"},
      {"99999999999999999999999 2 0 0\n",
       "1: the number of vertices is 99999999999999999999999; at most 536870910 are possible"},
      {"1 3 0 0\n0 0 0 0\n0\n", "1: the dimension must be 2, not 3"},
      {"536870910 2 0 0\n0 0 0\n", "2: the file ends after 1 of 536870910 vertices"},
      {"2 2 0 0\n0 0 0\n\n# end\n", "4: the file ends after 1 of 2 vertices"},
      {"1 2 0 0\n5 0 0\n0\n", "2: the first vertex must have the number 0 or 1, not 5"},
      {"1 2 0 0\n-1 0 0\n0\n", "2: the first vertex must have the number 0 or 1, not -1"},
      {"2 2 0 0\n0 0 0\n0 1 1\n0\n", "3: vertex number 0 where 1 is due"},
      {"2 2 0 0\n1 0 0\n3 1 1\n0\n", "3: vertex number 3 where 2 is due"},
      {"2 2 0 0\n1 0 0\nx 1 1\n0\n", "3: the vertex number must be an integer, not \"x\""},
      {"1 2 0 0\n0 0\n0\n", "2: y coordinate is missing"},
      {"1 2 0 0\n0 nan 0\n0\n", "2: the x coordinate is not finite: nan"},
      {"1 2 0 0\n0 0 -inf\n0\n", "2: the y coordinate is not finite: -inf"},
      {"1 2 0 0\n0 0 1e999\n0\n", "2: the y coordinate is not finite: 1e999"},
      {"1 2 0 0\n0 0 1,5\n0\n", "2: y coordinate must be a number, not \"1,5\""},
      {"1 2 0 0\n0 0 0x10\n0\n", "2: y coordinate must be a number, not \"0x10\""},
      {"1 2 0 0\n0 0 --1\n0\n", "2: y coordinate must be a number, not \"--1\""},
      {"1 2 0 0\n0 0 +-1\n0\n", "2: y coordinate must be a number, not \"+-1\""},
      {"1 2 0 0\n0 0 0 word\n0\n", "2: an attribute or marker must be a number, not \"word\""},
      {"1 2 2 0\n0 0 0 5\n0\n", "2: an attribute or marker is missing"},
      {"1 2 5000 0\n0 0 0\n0\n", "1: the number of attributes is 5000; at most 1000 are possible"},
      {"1 2 0 1\n0 0 0 1.5\n0\n", "2: the vertex marker must be an integer, not \"1.5\""},
      {"1 2 0 1\n0 0 0 4294967296\n0\n", "2: the vertex marker has more than 32 bits: 4294967296"},
      {"1 2 0 0\n0 0 0\n", "2: the number of segments is missing"},
      {"1 2 0 0\n0 0 0\n-2 0\n", "3: the number of segments is negative: -2"},
      {"1 2 0 0\n0 0 0\n4000000000 0\n", "3: the number of segments is 4000000000; at most 2147483647 are possible"},
      {"2 2 0 0\n0 0 0\n1 1 1\n2 0\n0 0 1\n", "5: the file ends after 1 of 2 segments"},
      {"2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0 2\n0\n", "5: segment 0 names vertex 2, but the vertices are 0 to 1"},
      {"2 2 0 0\n1 0 0\n2 1 1\n1 0\n1 0 2\n0\n", "5: segment 1 names vertex 0, but the vertices are 1 to 2"},
      {"2 2 0 0\n1 0 0\n2 1 1\n1 0\n1 1 -9223372036854775809\n0\n",
       "5: segment 1 names vertex -9223372036854775809, but the vertices are 1 to 2"},
      {"2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0\n0\n", "5: the segment's end is missing"},
      {"2 2 0 0\n0 0 0\n1 1 1\n1 0\n0 0 1.0\n0\n", "5: the segment's end must be an integer, not \"1.0\""},
      {"0 2 0 0\n1 0\n0 0 0\n0\n", "2: segments without vertices, and no file "},
      {"1 2 0 0\n0 0 0\n0 0\n1\n", "4: the file ends after 0 of 1 holes"},
      {"1 2 0 0\n0 0 0\n0 0\n1\n1 x 0\n", "5: x coordinate must be a number, not \"x\""},
      {"1 2 0 0\n0 0 0\n0 0\n0\n0\nmore\n", "6: more text than the counts announce"},
      {"1 2 0 0\n0 0 0\n0 0\n9999999999999\n",
       "4: the number of holes is 9999999999999; at most 2147483647 are possible"},
  };
  ScratchFolder folder;
  for (const Malformed& malformed : cases) {
    CAPTURE(malformed.text);
    const std::string path = folder.write("bad.poly", malformed.text);
    CHECK(failure(path, Exit::input, [&] { io::read_input(path); }).substr(0, std::strlen(malformed.expected)) ==
          malformed.expected);
  }
}

TEST_CASE("bytes that are no text are refused, whatever they are") {
  ScratchFolder folder;
  const std::string nul("2 2 0 0\n0 0 0\n1 \0 1\n0\n", 23);
  const std::string path = folder.write("bad.poly", nul);
  CHECK(failure(path, Exit::input, [&] { io::read_input(path); }) == "3: x coordinate must be a number, not \"?\"");
  std::string noise(4096, '\0');
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<char>(i * 2654435761u >> 13);
  folder.write("bad.poly", noise);
  CHECK(!failure(path, Exit::input, [&] { io::read_input(path); }).empty());
}

TEST_CASE("every prefix of a good file is refused with a line, or is a good file") {
  const std::string whole = "3 2 1 1\n1 0 0 5 1\n2 1 0 5 1\n3 0 1 5 1\n2 1\n1 1 2 1\n2 2 3 1\n1\n1 0.1 0.1\n0\n";
  ScratchFolder folder;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string path = folder.write("cut.poly", whole.substr(0, size));
    try {
      const io::Input input = io::read_input(path);
      CHECK(input.vertices.size() == 3);
    } catch (const Failure& failed) {
      CHECK(failed.exit() == Exit::input);
      CHECK(std::string(failed.what()).compare(0, path.size() + 1, path + ":") == 0);
    }
  }
}

TEST_CASE("a text of several blocks is read as a short one, lines and comments across their borders as well") {
  ScratchFolder folder;
  constexpr int count = 500000;
  std::string text = std::to_string(count) + " 2\n";
  for (int i = 0; i < count; ++i) {
    text += std::to_string(i) + std::string(1 + i % 11, ' ') + std::to_string(7 * i) + " " + std::to_string(i % 1000);
    text += i % 5 == 0 ? " # a comment\r\n" : i % 7 == 0 ? "\n\n" : "\n";
  }
  text += "#" + std::string(std::size_t{9} << 20, ' ') + "a long line\n";  // two blocks and more
  REQUIRE(text.size() > (std::size_t{20} << 20));
  const io::Input input = io::read_input(folder.write("in.node", text));
  REQUIRE(input.vertices.size() == count);
  bool right = true;
  for (int i = 0; i < count; ++i)
    right = right && input.vertices[static_cast<std::size_t>(i)] == std::array<double, 2>{7.0 * i, i % 1000 * 1.0};
  CHECK(right);
  const auto lines = static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
  CHECK(input.vertex_lines.of(count - 1) == lines - 1);
  const std::string path = folder.write("more.node", text + "500000 1 x");
  const std::string said = failure(path, Exit::input, [&] { io::read_input(path); });
  CHECK(said.substr(0, said.find(' ')) == std::to_string(lines + 1) + ":");
  CHECK(said.find("more text") != std::string::npos);
}

TEST_CASE("a file that is missing, a folder, and an unknown extension are refused") {
  ScratchFolder folder;
  CHECK(failure(folder / "no.poly", Exit::input, [&] {
          io::read_input(folder / "no.poly");
        }).find("cannot be opened") != std::string::npos);
  std::filesystem::create_directory(folder / "folder.poly");
  CHECK(failure(folder / "folder.poly", Exit::input, [&] {
          io::read_input(folder / "folder.poly");
        }).find("cannot be read") != std::string::npos);
  CHECK(!failure(folder / "a.stl", Exit::usage, [&] { io::read_input(folder / "a.stl"); }).empty());
}

TEST_CASE("more vertices than a node file announces are refused") {
  ScratchFolder folder;
  const std::string path = folder.write("in.node", "1 2 0 0\n0 0 0\n1 1 1\n");
  CHECK(failure(path, Exit::input, [&] { io::read_input(path); }) == "3: more text than the counts announce");
}

TEST_CASE("coordinates written to node and poly files read back to the same bits") {
  using Limits = std::numeric_limits<double>;
  Square square(1);
  square.input.vertices = {{0.1, -0.0},
                           {Limits::max(), Limits::lowest()},
                           {Limits::min(), Limits::denorm_min()},
                           {1.0 / 3, 1e22},
                           {1e23, 123456789012345678.0},
                           {-180.0, 89.999999},
                           {5e-324, 4.35},
                           {0.30000000000000004, 2.2250738585072011e-308}};
  ScratchFolder folder;
  for (const char* name : {"out.node", "out.poly"}) {
    written(folder, name, square);
    const io::Input back = io::read_input(folder / name);
    CHECK(back.first == 1);
    REQUIRE(back.vertices.size() == square.input.vertices.size());
    for (std::size_t v = 0; v < back.vertices.size(); ++v)
      for (int axis = 0; axis < 2; ++axis) CHECK(same_bits(back.vertices[v][axis], square.input.vertices[v][axis]));
  }
  CHECK(io::read_input(folder / "out.poly").constraints == square.mesh.pieces);
}

TEST_CASE("Triangle's formats are written with the input's first number and end with the grid") {
  ScratchFolder folder;
  const std::string grid = "# gcdt grid kind=binary origin=0,0 cell=2^-30 largest_move=0\n";
  CHECK(written(folder, "o.ele", Square(0)) == "2 3 0\n0 0 1 2\n1 0 2 3\n" + grid);
  CHECK(written(folder, "o.ele", Square(1)) == "2 3 0\n1 1 2 3\n2 1 3 4\n" + grid);
  CHECK(written(folder, "o.neigh", Square(0)) == "2 3\n0 -1 1 -1\n1 -1 -1 0\n" + grid);
  CHECK(written(folder, "o.neigh", Square(1)) == "2 3\n1 -1 2 -1\n2 -1 -1 1\n" + grid);
  CHECK(written(folder, "o.edge", Square(1)) == "5 1\n1 2 3 0\n2 3 1 1\n3 1 2 0\n4 3 4 0\n5 4 1 0\n" + grid);
  CHECK(written(folder, "o.node", Square(1)) == "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n" + grid);
  CHECK(written(folder, "o.poly", Square(1)) == "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n1 1\n1 1 3 1\n0\n" + grid);
}

TEST_CASE("attributes, markers, holes and regions go through to the outputs") {
  Square square(1);
  square.input.attribute_count = 2;
  square.input.attributes = {0.5, 1, 2, 3, 4, 5, 6, 1e300};
  square.input.vertex_markers = {7, -8, 9, 0};
  square.input.constraint_markers = {0, 42};
  square.input.holes = {{0.25, 0.5}};
  square.input.regions = {{{0.5, 0.25}, 3.5, 0.125}};
  square.mesh.source_offsets = {0, 2};
  square.mesh.sources = {0, 1};
  square.mesh.region_seed = {0, -1};
  ScratchFolder folder;
  CHECK(written(folder, "o.poly", square).find("\n1 1 3 42\n1\n1 0.25 0.5\n1\n1 0.5 0.25 3.5 0.125\n") !=
        std::string::npos);
  CHECK(written(folder, "o.edge", square).find("\n2 3 1 42\n") != std::string::npos);
  CHECK(written(folder, "o.ele", square).find("2 3 1\n1 1 2 3 3.5\n2 1 3 4 0\n") == 0);
  for (const char* name : {"o.poly", "o.node"}) {
    written(folder, name, square);
    const io::Input back = io::read_input(folder / name);
    CHECK(back.attributes == square.input.attributes);
    CHECK(back.vertex_markers == square.input.vertex_markers);
  }
  // Without a marker that is not 0, and without markers at all, a constrained edge has 1.
  square.mesh.sources = {0, 0};
  CHECK(written(folder, "o.edge", square).find("\n2 3 1 1\n") != std::string::npos);
  square.input.constraint_markers.clear();
  CHECK(written(folder, "o.edge", square).find("\n2 3 1 1\n") != std::string::npos);
}

TEST_CASE("meshes read back from ele, neigh and vtu files are the meshes written") {
  ScratchFolder folder;
  for (std::uint32_t first : {0u, 1u}) {
    const Square square(first);
    for (const char* name : {"o.ele", "o.neigh", "o.vtu"}) {
      CAPTURE(name);
      written(folder, name, square);
      const bool vtu = std::string(name) == "o.vtu";
      const io::MeshFile back = vtu ? io::read_vtu(folder / name) : io::read_mesh(folder / name, 4, first);
      CHECK(back.triangles == square.mesh.triangles);
      if (std::string(name) != "o.ele") CHECK(back.neighbours == square.mesh.neighbours);
      if (vtu) CHECK(back.constrained == square.mesh.constrained);
      if (vtu) CHECK(back.vertices == square.input.vertices);
      REQUIRE(back.grid);
      CHECK(io::to_text(*back.grid) == io::to_text(square.mesh.statistics.grid));
    }
  }
}

TEST_CASE("triangles of an ele file may come in any order, and neigh follows their numbers") {
  ScratchFolder folder;
  folder.write("o.ele", "2 3 0\n2 1 3 4\n1 1 2 3\n");
  folder.write("o.neigh", "2 3\n1 -1 2 -1\n2 -1 -1 1\n");
  const io::MeshFile mesh = io::read_mesh(folder / "o.neigh", 4, 1);
  CHECK(mesh.triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 2, 3}, {0, 1, 2}});
  CHECK(mesh.neighbours == std::vector<std::array<std::int32_t, 3>>{{-1, -1, 1}, {-1, 0, -1}});
}

TEST_CASE("a number that does not exist in an ele or neigh file is a failed check, and a malformed file is not") {
  ScratchFolder folder;
  struct Case {
    const char *ele, *neigh, *expected;
    Exit exit;
  };
  const Case cases[] = {
      {"1 3 0\n1 1 2 5\n", nullptr, "2: a triangle names vertex 5, which does not exist", Exit::check},
      {"1 3 0\n1 0 1 2\n", nullptr, "2: a triangle names vertex 0, which does not exist", Exit::check},
      {"1 3 0\n1 -1 1 2\n", nullptr, "2: a triangle names vertex -1, which does not exist", Exit::check},
      {"1 3 0\n1 1 2 99999999999999999999\n", nullptr,
       "2: a triangle names vertex 99999999999999999999, which does not exist", Exit::check},
      {"1 6 0\n1 1 2 3 4 5 6\n", nullptr, "1: triangles have 3 corners, not 6", Exit::input},
      {"2 3 0\n1 1 2 3\n", nullptr, "2: the file ends after 1 of 2 triangles", Exit::input},
      {"4000000000 3 0\n", nullptr, "1: the number of triangles is 4000000000; at most 1073741820 are possible",
       Exit::input},
      {"1 3 0\n1 1 2\n", nullptr, "2: a corner is missing", Exit::input},
      {"1 3 0\n1 1 2 3\n# gcdt grid kind=odd origin=0,0 cell=2^0\n", nullptr,
       "3: the grid cannot be read from this comment", Exit::input},
      {"1 3 0\n1 1 2 3\n", "1 3\n1 -1 -1 2\n", "2: neighbour 2 does not exist", Exit::check},
      {"1 3 0\n1 1 2 3\n", "1 3\n1 -1 -1 -2\n", "2: neighbour -2 does not exist", Exit::check},
      {"2 3 0\n9223372036854775807 1 2 3\n-9223372036854775808 1 3 4\n", "2 3\n1 -1 -1 -1\n2 -1 -1 -1\n",
       "2: triangle 1 does not exist in the .ele beside", Exit::check},
      {"1 3 0\n1 1 2 3\n", "1 3\n7 -1 -1 -1\n", "2: triangle 7 does not exist in the .ele beside", Exit::check},
      {"1 3 0\n1 1 2 3\n", "2 3\n1 -1 -1 -1\n2 -1 -1 -1\n", "1: 2 triangles here, but 1 in the .ele beside",
       Exit::check},
  };
  for (const Case& test : cases) {
    CAPTURE(test.expected);
    std::string path = folder.write("o.ele", test.ele);
    if (test.neigh) path = folder.write("o.neigh", test.neigh);
    CHECK(failure(path, test.exit, [&] { io::read_mesh(path, 4, 1); }) == test.expected);
  }
}

TEST_CASE("a grid is read back exactly from its text") {
  Grid grid;
  for (auto kind : {Grid::Kind::binary, Grid::Kind::decimal, Grid::Kind::rounded, Grid::Kind::fixed})
    for (double origin : {0.0, -180.0, 0.1, -1e-300, 1.7976931348623157e308})
      for (std::uint64_t units : {0ull, 1ull, 25ull, 18446744073709551615ull})
        for (int exponent : {-1074, -22, 0, 3, 1023}) {
          grid.kind = kind;
          grid.origin = {origin, -origin / 3};
          grid.cell_units = units;
          (units > 0 ? grid.cell_decimals : grid.cell_exponent) = exponent;
          (units > 0 ? grid.cell_exponent : grid.cell_decimals) = 0;
          grid.largest_move = std::abs(origin) / 7;
          const auto back = io::grid_from_text(io::to_text(grid));
          REQUIRE(back);
          CHECK(back->kind == grid.kind);
          CHECK(back->origin == grid.origin);
          CHECK(back->cell_units == grid.cell_units);
          CHECK(back->cell_decimals == grid.cell_decimals);
          CHECK(back->cell_exponent == grid.cell_exponent);
          CHECK(back->largest_move == grid.largest_move);
        }
}

TEST_CASE("text that is no grid is refused") {
  for (const char* text :
       {"", "kind", "kind=decimal", "kind=decimal origin=0 cell=1e-6", "kind=decimal origin=0,nan cell=1e-6",
        "kind=decimal origin=0,0 cell=0e0", "kind=decimal origin=0,0 cell=1e-6x", "kind=decimal origin=0,0 cell=2^",
        "kind=decimal origin=0,0 cell=2^99999", "kind=decimal origin=0,0 cell=-1e2",
        "kind=other origin=0,0 cell=1e2"}) {
    CAPTURE(text);
    CHECK(!io::grid_from_text(text));
  }
}

// SPDX-License-Identifier: Apache-2.0
// What the command makes of meshes: locate, raster, pictures; and of files of other programs.
#include <map>

#include "command_session.hpp"

using namespace gcdt::testing;

TEST_CASE("locate says triangle, weights and attributes of each point") {
  Session session;
  session.write("in.poly", "4 2 1 0\n1 0 0 10\n2 4 0 20\n3 4 4 40\n4 0 4 30\n1 0\n1 1 3\n0\n");
  session.write("points.node", "4 2 0 0\n1 3 1\n2 1 3\n3 2 2\n4 9 9\n");
  session.good("triangulate in.poly -o o.ele");
  CHECK(contains(session.read("o.ele"), "2 3 0\n1 1 2 3\n2 1 3 4\n"));
  const std::string places = "1 1 0.25 0.5 0.25 22.5\n2 2 0.25 0.25 0.5 27.5\n3 1 0.5 0 0.5 25\n4 -1 0 0 0 nan\n";
  CHECK(data_lines(session.good("locate in.poly points.node")) == places);
  CHECK(session.good("locate in.poly points.node -o places.txt") == "");
  CHECK(data_lines(session.read("places.txt")) == places);
  CHECK(contains(data_lines(session.good("locate in.poly points.node --domain outer")), "\n4 -1 "));
  session.bad(2, "locate in.poly points.node -o points.node");
  session.bad(3, "locate in.poly missing.node");
}

TEST_CASE("locate and raster take a mesh as it is: of gcdt, or of any other program") {
  Session session;
  session.write("in.poly", "4 2 1 0\n1 0 0 10\n2 4 0 20\n3 4 4 40\n4 0 4 30\n1 0\n1 1 3\n0\n");
  session.write("points.node", "4 2 0 0\n1 3 1\n2 1 3\n3 2 2\n4 9 9\n");
  session.good("triangulate in.poly -o o.ele -o o.node -o o.vtu -o whole.vtu");
  CHECK(session.good("locate o.ele points.node") == session.good("locate in.poly points.node"));
  // .vtu counts from 0.
  CHECK(data_lines(session.good("locate o.vtu points.node")) ==
        "1 0 0.25 0.5 0.25 22.5\n2 1 0.25 0.25 0.5 27.5\n3 0 0.5 0 0.5 25\n4 -1 0 0 0 nan\n");
  for (const char* mesh : {"in.poly", "o.ele", "o.vtu"}) {
    session.good(std::string("raster ") + mesh + " --cell 1 -o r.asc");
    CHECK(contains(session.read("r.asc"), "\n28.75 "));  // at (0.5, 3.5): 10, 40, 30 at (0, 0), (4, 4), (0, 4)
  }
  // By hand: not Delaunay, in any order, with a gap where the third triangle of the hull would be; no grid, markers.
  session.write("t.1.node", "5 2 1 1\n1 0 0 0 1\n2 9 0 9 1\n3 9 1 9 1\n4 0 9 0 1\n5 1 1 1 0\n");
  session.write("t.1.ele", "# made by hand\n2 3 1\n1 5 2 3 7\n2 2 5 1 7\n");
  session.write("t.node", "3 2 0 0\n0 8 0.5\n1 5 0.5\n2 0.5 4\n");
  CHECK(data_lines(session.good("locate t.1.ele t.node")) ==
        "0 1 0.125 0.5 0.375 8\n1 1 0.5 0.5 0 5\n2 -1 0 0 0 nan\n");
  // On a grid that was given: points between its lines are rounded to them.
  session.good("triangulate in.poly --grid 0,0,2 -o g.ele -o g.node");
  session.write("between.node", "1 2 0 0\n0 3.5 0.5\n");
  CHECK(contains(session.good("locate g.ele between.node"), "\n0 1 0 1 0 20\n"));
  CHECK(contains(session.good("locate g.ele between.node --grid 0,0,1"), "\n0 1 0 1 0 20\n"));
  CHECK(contains(session.good("locate g.ele between.node --grid 0,0,0.5"), "\n0 1 0.125 0.75 0.125 21.25\n"));

  // Heights that are coordinates, as other programs have them.
  session.write("hill.vtu",
                "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"3\" NumberOfCells=\"1\">"
                "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 10 4 0 20 0 4 30"
                "</DataArray></Points><PointData><DataArray type=\"Float64\" Name=\"t\" format=\"ascii\">1 2 3"
                "</DataArray></PointData><Cells>"
                "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
                "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray>"
                "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5</DataArray></Cells>"
                "</Piece></UnstructuredGrid></VTKFile>\n");
  session.write("one.node", "1 2 0 0\n0 1 2\n");
  CHECK(data_lines(session.good("locate hill.vtu one.node")) == "0 0 0.25 0.25 0.5 22.5 2.25\n");

  session.bad(2, "locate o.ele points.node --crossing split");
  session.bad(2, "raster o.vtu --domain outer -o r.asc");
  session.bad(2, "raster o.vtu -o o.vtu");
  session.bad(2, "locate o.ele points.node -o o.node");
  session.write("lone.ele", session.read("o.ele"));
  CHECK(contains(session.bad(3, "locate lone.ele points.node"), "lone.node"));
  session.write("bad.node", session.read("o.node"));
  session.write("bad.ele", "1 3 0\n1 1 2 9\n");
  CHECK(contains(session.bad(3, "locate bad.ele points.node"), "bad.ele:2: a triangle names vertex 9"));
  session.write("bad.ele", "2 3 0\n1 1 2 3\n2 1 4 3\n");
  CHECK(contains(session.bad(5, "locate bad.ele points.node"),
                 "bad.ele: triangle 1 of the mesh is not counter-clockwise on the grid (numbers count from 0)"));
  session.write("bad.ele", "2 3 0\n1 1 2 3\n2 1 2 4\n");
  CHECK(contains(session.bad(5, "raster bad.ele -o r.png"), "bad.ele: edges 0-2 and 1-3 of the mesh cross"));
}

TEST_CASE("raster writes the value in the middle of each cell, from the north down, with its place") {
  Session session;
  session.write("in.node", "4 2 2 0\n0 10 20 0 5\n1 14 20 4 5\n2 14 22 4 5\n3 10 22 0 5\n");
  session.good("raster in.node --cell 1 -o o.asc -o o.flt -o o.png");
  const std::string header = "ncols 4\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 1\nNODATA_value -9999\n";
  CHECK(session.read("o.asc") == header + "0.5 1.5 2.5 3.5\n0.5 1.5 2.5 3.5\n");
  CHECK(session.read("o.hdr") == header + "byteorder LSBFIRST\n");
  for (const char* world : {"o.acw", "o.ftw", "o.pgw"}) CHECK(session.read(world) == "1\n0\n0\n-1\n10.5\n21.5\n");
  const std::string floats = session.read("o.flt");
  REQUIRE(floats.size() == 4 * 8);
  CHECK(floats.substr(4, 4) == std::string("\0\0\xc0\x3f", 4));  // 1.5
  CHECK(session.read("o.png").substr(1, 3) == "PNG");
  // A triangle: outside of it there is no value.
  session.write("t.node", "3 2 2 0\n0 0 0 0 1\n1 4 0 0 2\n2 0 2 0 3\n");
  session.good("raster t.node --cell 1 --attribute 2 --no-data -1 -o t.asc");
  CHECK(contains(session.read("t.asc"), "NODATA_value -1\n2.625 -1 -1 -1\n1.625 1.875 2.125 -1\n"));
  session.bad(2, "raster t.node --attribute 3 -o t.asc");
  session.bad(2, "raster t.node --cell 0 -o t.asc");
  session.bad(2, "raster t.node --cell 1e-9 -o t.asc");
  session.bad(2, "raster t.node --cell nan -o t.asc");
  session.bad(2, "raster t.node --cell inf -o t.asc");
  session.bad(2, "raster t.node --no-data 0.1 -o t.asc");
  session.bad(2, "raster t.node --no-data 1e300 -o t.asc");
  session.good("raster t.node --no-data nan --cell 1 -o nan.asc");
  CHECK(contains(session.read("nan.asc"), "NODATA_value nan\n0 nan nan nan\n0 0 0 nan\n"));
  session.write("wide.node", "3 2 1 0\n0 -1e308 0 0\n1 1e308 0 0\n2 0 1e308 0\n");
  CHECK(contains(session.bad(3, "raster wide.node -o t.asc"), "the extent is no finite double"));
  session.write("high.node", "3 2 1 0\n0 0 0 1e300\n1 4 0 0\n2 0 4 0\n");
  CHECK(contains(session.bad(3, "raster high.node -o t.asc"), "too large for float32"));
  session.bad(2, "raster t.node -o t.tif");
  session.bad(2, "raster t.node -o t.flt -o t.hdr");
  session.bad(2, "raster t.node -o t.asc -o ./t.asc");
}

TEST_CASE("regions are filled in pictures: each colour has the area of its triangles, and neighbours differ") {
  Session session;
  // A square in a square, and one that touches it along an edge: 10 x 10 units are the canvas.
  session.write("in.poly",
                "10 2 0 0\n0 0 0\n1 10 0\n2 10 10\n3 0 10\n4 2 2\n5 6 2\n6 6 6\n7 2 6\n8 8 2\n9 8 6\n"
                "12 0\n0 0 1\n1 1 2\n2 2 3\n3 3 0\n4 4 5\n5 5 6\n6 6 7\n7 7 4\n8 5 8\n9 8 9\n10 9 6\n11 6 5\n0\n");
  auto filled = [&](const std::string& options) {
    session.good("triangulate in.poly -o o.svg " + options);
    const std::string svg = session.read("o.svg");
    std::map<std::string, double> areas;  // by colour, in the input's units
    for (std::size_t at = 0; (at = svg.find("<path fill=\"", at)) != std::string::npos;) {
      const std::string colour = svg.substr(at + 12, 7);
      double area = 0, first_x = 0, first_y = 0, x = 0, y = 0;
      const char* text = svg.c_str() + svg.find(" d=\"", at) + 4;
      for (; *text != '"';) {
        char* end = nullptr;
        if (*text == 'M') {
          x = first_x = std::strtod(text + 1, &end);
          y = first_y = std::strtod(end, &end);
          CHECK(*end == 'l');
          text = end + 1;
        } else if (*text == 'z') {
          area -= x * first_y - first_x * y;  // y goes down
          text += 2;
        } else {
          const double to_x = x + std::strtod(text, &end), to_y = y + std::strtod(end, &end);
          area -= x * to_y - to_x * y;
          x = to_x, y = to_y;
          text = end;
        }
      }
      areas[colour] += area / 2 / 1e8;
      ++at;
    }
    std::vector<double> sorted;
    for (const auto& [colour, area] : areas) sorted.push_back(area);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  CHECK(filled("") == std::vector<double>{});
  CHECK(filled("--domain nonzero") == std::vector<double>{8, 16, 76});
  CHECK(filled("--regions") == std::vector<double>{8, 16, 76});
  CHECK(filled("--domain even-odd --quiet") == std::vector<double>{76});
}

// SPDX-License-Identifier: Apache-2.0
// What inputs of the command can be and ask for: GeoJSON, grids, decimals, holes, regions, domains.
#include "command_session.hpp"

using namespace gcdt::testing;

TEST_CASE("--assess says what the mesh is worth at the coordinates as they are given") {
  Session session;
  session.write("in.poly", square);
  session.good("triangulate in.poly --assess --stats s.json");
  CHECK(nlohmann::json::parse(session.read("s.json"))["given"]["valid"] == true);
  // A cell of 4: the middle two vertices change sides.
  session.write("in.node", "4 2 0 0\n0 0 0\n1 4 0\n2 3 2.1\n3 1 1.9\n");
  CHECK(session.gcdt("triangulate in.node --grid 0,0,4 --assess --stats s.json").status == 0);
  const auto given = nlohmann::json::parse(session.read("s.json"))["given"];
  CHECK(given["valid"] == false);
  CHECK(given["vertices_lost"] == 1);
  session.good("triangulate in.node --stats s.json");
  CHECK(!nlohmann::json::parse(session.read("s.json")).contains("given"));
}

TEST_CASE("GeoJSON is read: polygons with holes, lines and points of any collection; what is wrong is named") {
  Session session;
  session.write("in.geojson", R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [
      [[0, 0], [0, 8], [8, 8], [8, 0], [0, 0]], [[2, 2, 7.5], [4, 2], [4, 4], [2, 2]]]}},
    {"type": "Feature", "properties": {}, "geometry": null},
    {"type": "Feature", "properties": {}, "geometry": {"type": "GeometryCollection", "geometries": [
      {"type": "MultiLineString", "coordinates": [[[5, 5], [7, 5], [7, 7]], [[1, 7], [2, 7]]]},
      {"type": "MultiPolygon", "coordinates": [[[[20, 0], [24, 0], [24, 4], [20, 0]]]]},
      {"type": "MultiPoint", "coordinates": [[12, 3]]}, {"type": "Point", "coordinates": [1, 1]}]}}]})");
  const Outcome made = session.gcdt("triangulate in.geojson --verify -o o.poly -o o.ele --stats s.json");
  CHECK(made.status == 0);
  CHECK(contains(made.err, "1 of 17 positions have a third number, and not all: they are not used"));
  const auto json = nlohmann::json::parse(session.read("s.json"));
  CHECK(json["n"] == 4 + 3 + 5 + 3 + 2);
  CHECK(json["m"] == 4 + 3 + 3 + 3);
  session.good("verify in.geojson o.ele");
  // Heights, of a ring closed by its first position, are an attribute.
  session.write("hill.geojson", R"({"type": "Polygon", "coordinates": [
    [[0, 0, 10], [4, 0, 10], [4, 4, 20], [0, 4, 20], [0, 0, 10]], [[1, 1, 12.5], [3, 1, 12.5], [1, 3, 17.5]]]})");
  session.good("triangulate hill.geojson -o hill.node");
  CHECK(contains(session.read("hill.node"), "7 2 1 0\n0 0 0 10\n1 4 0 10\n2 4 4 20\n3 0 4 20\n4 1 1 12.5\n"));
  session.good("raster hill.geojson --cell 1 --domain even-odd -o hill.asc");
  CHECK(contains(session.read("hill.asc"), "\n18.75 18.75 18.75 18.75\n"));
  const char* broken[][2] = {
      {"{", "bad.json:1: no JSON that can be read, at column 2: "},
      {"", "bad.json:1: no JSON that can be read, at column 1: "},
      {"{\"type\": \"Point\",\n \"coordinates\": [1,\n  ]}",
       "bad.json:3: no JSON that can be read, at column 3: syntax error while parsing value - unexpected ']'"},
      {"{\"type\": \"Po\nint\"}", "bad.json:1: no JSON that can be read, at column 13: "},
      {"[]\n\n }", "bad.json:3: no JSON that can be read, at column 2: "},
      {"\n\n77", "bad.json:3: the file: an object is due, not 77"},
      {"{\"type\": \"FeatureCollection\",\n \"features\": [{\"a\": [1, {\"type\": 2}],\n \"type\": \"Feature\",\n"
       " \"geometry\": {\"type\": \"Point\",\n \"coordinates\":\n [1, 2]}},\n \"se\\\"ven\"]}",
       "bad.json:7: the file, feature 1: an object is due, not \"se\\\"ven\""},
      {"{\"type\": \"Polygon\",\n \"coordinates\": [[[0, 0], [1, 1]],\n 5]}",
       "bad.json:3: the file, ring 1: an array is due, not 5"},
      {R"({"type": "Polygon"})", "\"coordinates\" is missing"},
      {R"({"type": "Circle", "coordinates": []})", "there is no type \"Circle\""},
      {R"({"type": "Topology", "objects": {}, "arcs": []})", "there is no type \"Topology\""},
      {R"({"type": "Polygon", "coordinates": [[[0, 0], [1]]]})",
       "ring 0, position 1: a position of two numbers is due, not [1]"},
      {R"({"type": "LineString", "coordinates": [[0, "x"]]})", "position 0: a position of two numbers"},
      {"{\"type\": \"Point\",\n \"coordinates\": [1e999, 0]}",
       "bad.json:2: no JSON that can be read, at column 22: number overflow parsing '1e999'"}};
  for (const auto& [text, part] : broken) {
    CAPTURE(std::string(text));
    session.write("bad.json", text);
    const Outcome outcome = session.gcdt("triangulate bad.json");
    CHECK(outcome.status == 3);
    CHECK(contains(outcome.err, part));
  }
  // Crossings are named without lines, which JSON has none of.
  session.write("cross.json", R"({"type": "MultiLineString", "coordinates": [[[0, 0], [2, 2]], [[0, 2], [2, 0]]]})");
  CHECK(contains(session.gcdt("triangulate cross.json").err, "segment 0 (vertices 0 1) and segment 1 (vertices 2 3)"));
}

TEST_CASE("a grid can be fixed, is kept in the outputs, and refuses what lies outside") {
  Session session;
  session.write("in.poly", square);
  session.good("triangulate in.poly --grid -1,-0.5,0.25 -o o.ele -o o.vtu --verify");
  CHECK(contains(session.read("o.ele"), "# gcdt grid kind=fixed origin=-1,-0.5 cell="));
  CHECK(contains(session.good("verify in.poly o.ele"), "fixed grid with cell 0.25"));
  CHECK(contains(session.good("verify in.poly o.vtu"), "fixed grid with cell 0.25"));
  session.write("bare.ele", data_lines(session.read("o.ele")));
  CHECK(contains(session.good("verify in.poly bare.ele --grid -1,-0.5,0.25"), "fixed grid with cell 0.25"));
  CHECK(!contains(session.good("verify in.poly bare.ele"), "fixed"));
  CHECK(contains(session.bad(3, "triangulate in.poly --grid 0.5,0,0.25"), "in.poly:2: "));
  CHECK(contains(session.bad(3, "triangulate in.poly --grid 0,0,0.0000000001"), "in.poly:3: "));
}

TEST_CASE("inputs without an area have no triangles, status 0 and a note") {
  Session session;
  session.write("empty.node", "0 2 0 0\n");
  session.write("one.node", "1 2 0 0\n1 3 4\n");
  session.write("same.node", "3 2 0 0\n1 3 4\n2 3 4\n3 3 4\n");
  session.write("line.poly", "3 2 0 0\n0 0 0\n1 1 1\n2 3 3\n1 0\n0 0 2\n0\n");
  for (const char* name : {"empty.node", "one.node", "same.node", "line.poly"}) {
    CAPTURE(name);
    const Outcome outcome = session.gcdt(std::string("triangulate ") + name +
                                         " --verify -o o.ele -o o.neigh -o o.edge -o o.vtu -o o.svg -o o.poly");
    CHECK(outcome.status == 0);
    CHECK(contains(outcome.err, "gcdt: note: "));
    CHECK(session.gcdt(std::string("triangulate ") + name + " --quiet").err == "");
    CHECK(data_lines(session.read("o.ele")) == "0 3 0\n");
    CHECK(contains(session.read("o.svg"), "</svg>"));
    session.good(std::string("verify ") + name + " o.ele");
    session.good(std::string("verify ") + name + " o.vtu");
  }
  CHECK(contains(session.read("o.poly"), "\n2 1\n"));
}

TEST_CASE("holes and regions of the input are said to be unused") {
  Session session;
  session.write("in.poly", "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n0 0\n1\n0 0.1 0.1\n");
  const Outcome outcome = session.gcdt("triangulate in.poly -o o.ele");
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.err, "holes"));
  CHECK(session.good("triangulate in.poly -o o.ele --quiet") == "");
}

TEST_CASE("domains: the seeds of the file, what is removed, and its verification") {
  Session session;
  // A square with a square hole in it, both drawn counter-clockwise, and a vertex far to the right; one region.
  session.write(
      "in.poly",
      "9 2 0 0\n0 0 0\n1 9 0\n2 9 9\n3 0 9\n4 3 3\n5 6 3\n6 6 6\n7 3 6\n8 20 4\n8 0\n0 0 1\n1 1 2\n2 2 3\n3 3 "
      "0\n4 4 5\n5 5 6\n6 6 7\n7 7 4\n1\n0 4 5\n1\n0 1 1 2.5 -1\n");
  struct Expected {
    const char* domain;
    int triangles;  // the ring has 8, the hole 2, the part outside 1 or, with its vertex, 3
  };
  for (const Expected& e :
       {Expected{"hull", 11}, {"even-odd", 8}, {"nonzero", 10}, {"holes", 9}, {"outer", 10}, {"outer-holes", 8}}) {
    CAPTURE(e.domain);
    const std::string domain = std::string(" --domain ") + e.domain;
    session.good("triangulate in.poly -o o.ele -o o.neigh -o o.vtu --stats s.json --verify --quiet --regions" + domain);
    CHECK(nlohmann::json::parse(session.read("s.json"))["triangles"] == e.triangles);
    for (const char* output : {"o.ele", "o.neigh", "o.vtu"})
      CHECK(contains(session.good("verify in.poly " + std::string(output) + domain), "valid"));
    const std::string other = std::string(e.domain) == "hull" ? "outer" : "hull";
    session.bad(5, "verify in.poly o.ele --domain " + other);
    std::istringstream rows(data_lines(session.read("o.ele")));
    int number, count, corner, with_attribute = 0;
    double attribute;
    rows >> count >> number >> number;
    CHECK(number == 1);
    while (rows >> number >> corner >> corner >> corner >> attribute) with_attribute += attribute == 2.5;
    CHECK(with_attribute == 8);
  }
  for (const char* name : {"region", "depth", "winding", "region_attribute"})
    CHECK(contains(session.read("o.vtu"), std::string("Name=\"") + name + "\""));
}

namespace {

/// 770 vertices with six decimals, but for two numbers.
std::string mixed_decimals() {
  std::ostringstream text;
  text << "770 2 0 0\n";
  for (int i = 1; i <= 768; ++i) text << i << " " << i % 32 * 10 << ".123456 " << i / 32 * 5 << ".654321\n";
  text << "769 320.12345612 5.654321\n770 10.1234560012 5.654321\n0 0\n0\n";
  return text.str();
}

}  // namespace

TEST_CASE(
    "vertices that rounding makes one are warned of by number, with what helps, and are an error with --distinct") {
  Session session;
  session.write("in.poly", mixed_decimals());
  const Outcome run = session.gcdt("triangulate in.poly --stats s.json -o o.ele");
  CHECK(run.status == 0);
  CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  for (const char* part : {"gcdt: note: 1 vertex differs", "vertices 33 (10.123456, 5.654321) and 770 (10.1234560012",
                           "--grid", "--assess", "--distinct"})
    CHECK(contains(run.err, part));
  const auto json = nlohmann::json::parse(session.read("s.json"));
  CHECK(json.at("vertices_rounded_together") == 1);
  CHECK(json.at("rounded_pair") == nlohmann::json({32, 769}));
  CHECK(json.at("vertices_merged") == 1);
  CHECK(json.at("notes").size() == 1);
  const std::string refused = session.bad(3, "triangulate in.poly --distinct -o p.ele");
  CHECK(contains(refused, "in.poly:771: vertices 33 ("));
  CHECK(contains(refused, "--grid"));
  const Outcome batch = session.gcdt("batch in.poly -o out --stats b.json");
  CHECK(batch.status == 0);
  CHECK(contains(batch.err, "gcdt: note: in.poly: 1 vertex differs"));
  CHECK(nlohmann::json::parse(session.read("b.json")).at("vertices_rounded_together") == 1);
  CHECK(session.read("out/in.ele") == session.read("o.ele"));
  CHECK(session.gcdt("batch in.poly --distinct -o out").status == 3);
  // Nothing is said where nothing is made one.
  session.write("square.poly", square);
  session.good("triangulate square.poly --distinct -o q.ele");
}

TEST_CASE("an outline that is open to the hull leaves no triangles of outer-holes, and a note says why") {
  Session session;
  session.write("open.poly", "4 2 0 0\n0 0 0\n1 9 0\n2 9 9\n3 0 9\n3 0\n0 0 1\n1 1 2\n2 2 3\n0\n");
  for (const char* domain : {"outer", "outer-holes"}) {
    const Outcome open = session.gcdt(std::string("triangulate open.poly -o o.ele --domain ") + domain);
    CHECK(open.status == 0);
    CHECK(data_lines(session.read("o.ele")) == "0 3 0\n");
    CHECK(contains(open.err, "all of the hull is open to the outside"));
    CHECK(contains(open.err, "-c"));
  }
  // What closed borders and hole points leave nothing of is not open.
  session.write("framed.poly", framed());
  const Outcome holes = session.gcdt("triangulate framed.poly --domain even-odd -o o.ele");
  CHECK(!contains(holes.err, "open to the outside"));
}

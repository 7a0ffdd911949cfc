// SPDX-License-Identifier: Apache-2.0
// The command gcdt as its user sees it: arguments in; status, files and text out.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "scratch_folder.hpp"

using gcdt::testing::ScratchFolder;

namespace {

struct Outcome {
  int status;
  std::string out, err;
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A folder in which the command is run, so that its arguments are short names.
class Session : public ScratchFolder {
 public:
  /// Runs a shell line in which $gcdt is the command. Who does not care how it ends calls `run`, which does.
  [[nodiscard]] Outcome shell(const std::string& line) const {
    ScratchFolder streams;
    const std::string whole = "cd '" + *this / "" + "' && gcdt='" GCDT_COMMAND "' && { " + line + "\n} >'" +
                              streams / "out" + "' 2>'" + streams / "err" + "'";
    const int status = std::system(whole.c_str());
    REQUIRE(WIFEXITED(status));
    return {WEXITSTATUS(status), streams.read("out"), streams.read("err")};
  }
  /// Runs a shell line that prepares or compares something: it must succeed.
  void run(const std::string& line) const {
    const Outcome outcome = shell(line);
    INFO(line << ": " << outcome.out << outcome.err);
    REQUIRE(outcome.status == 0);
  }
  [[nodiscard]] Outcome gcdt(const std::string& arguments) const {
    return shell("\"$gcdt\" " + arguments + " </dev/null");
  }
  /// Runs the command, which must succeed without a word on standard error; its standard output.
  std::string good(const std::string& arguments) const {
    CAPTURE(arguments);
    const Outcome outcome = gcdt(arguments);
    CHECK(outcome.err == "");
    CHECK(outcome.status == 0);
    return outcome.out;
  }
  /// Runs the command, which must fail with `status` and one line on standard error; that line.
  std::string bad(int status, const std::string& arguments) const {
    CAPTURE(arguments);
    const Outcome outcome = gcdt(arguments);
    CAPTURE(outcome.err);
    CHECK(outcome.status == status);
    CHECK(outcome.out == "");
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(outcome.err.compare(0, 6, "gcdt: ") == 0);
    return outcome.err;
  }
};

constexpr const char* square = "4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n1 0\n0 1 3\n0\n";
constexpr const char* square_from_1 = "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n1 0\n1 2 4\n0\n";
/// Two diagonals of a square: segments 0 (line 7) and 1 (line 8) cross.
constexpr const char* crossed = "4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n2 0\n0 1 3\n1 0 2\n0\n";

/// The lines of a text that are no comments.
std::string data_lines(const std::string& text) {
  std::istringstream in(text);
  std::string lines;
  for (std::string line; std::getline(in, line);)
    if (line.empty() || line[0] != '#') lines += line + "\n";
  return lines;
}

/// A closed star-shaped polygon around many scattered vertices, with decimal coordinates.
std::string random_poly(int n, int first) {
  std::mt19937 random(7);
  std::ostringstream text;
  text << n << " 2 0 0\n";
  const int ring = n / 4;
  for (int i = 0; i < n; ++i) {
    const double angle = 6.283185307179586 * i / ring, radius = 500 + static_cast<double>(random() % 400);
    const long x =
        std::lround(i < ring ? radius * std::cos(angle) * 1000 : static_cast<double>(random() % 2000000) - 1000000);
    const long y =
        std::lround(i < ring ? radius * std::sin(angle) * 1000 : static_cast<double>(random() % 2000000) - 1000000);
    text << i + first << ' ' << x << "e-3 " << y << "e-3\n";
  }
  text << ring << " 0\n";
  for (int i = 0; i < ring; ++i) text << i + first << ' ' << i + first << ' ' << (i + 1) % ring + first << '\n';
  text << "0\n";
  return text.str();
}

}  // namespace

TEST_CASE("help and version are no errors") {
  Session session;
  CHECK(contains(session.good("--help"), "triangulate"));
  CHECK(session.good("--version").compare(0, 5, "gcdt ") == 0);
  for (const char* option :
       {"--crossing", "--grid", "--device", "--verify", "--stats", "--trace", "--quiet", ".vtu", "Status:"})
    CHECK(contains(session.good("triangulate --help"), option));
  CHECK(contains(session.good("verify --help"), "OUTPUT"));
  CHECK(contains(session.good("batch --help"), "folder"));
  CHECK(!session.good("devices --help").empty());
}

TEST_CASE("wrong usage is status 2 and one line, and nothing is written") {
  Session session;
  session.write("in.poly", square);
  session.write("in.obj", square);
  for (const char* arguments : {"",
                                "frobnicate",
                                "triangulate",
                                "verify in.poly",
                                "triangulate in.poly --no-such-option",
                                "triangulate in.poly --tiles 2",
                                "triangulate in.poly --domain inside",
                                "triangulate in.poly --domain even-odd --assess",
                                "triangulate in.poly --crossing merge",
                                "triangulate in.poly -o",
                                "triangulate in.poly -o out.xyz",
                                "triangulate in.poly -o out.ele -o out",
                                "triangulate in.poly -o in.poly",
                                "triangulate in.poly -o ./in.poly",
                                "triangulate in.poly -o out.ele -o ./out.ele",
                                "triangulate in.poly -o out.ele --stats out.ele",
                                "triangulate in.poly --stats in.poly",
                                "triangulate in.poly --trace in.poly",
                                "triangulate in.poly --stats t.json --trace t.json",
                                "triangulate in.poly in.poly",
                                "triangulate in.obj",
                                "triangulate in.poly --grid 1",
                                "triangulate in.poly --grid 0,0",
                                "triangulate in.poly --grid 0,0,zero",
                                "triangulate in.poly --grid 0,0,0",
                                "triangulate in.poly --grid nan,0,1",
                                "triangulate in.poly --grid 0,0,-1",
                                "verify in.poly in.poly",
                                "devices 1"})
    session.bad(2, arguments);
  CHECK(session.names() == std::vector<std::string>{"in.obj", "in.poly"});
  CHECK(session.read("in.poly") == square);
}

TEST_CASE("a node file that is read beside a poly file cannot be an output") {
  Session session;
  session.write("in.node", "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n");
  session.write("in.poly", "0 2 0 0\n1 0\n0 0 1\n0\n");
  session.bad(2, "triangulate in.poly -o in.node");
  session.good("triangulate in.poly -o in.ele");
  CHECK(data_lines(session.read("in.ele")) == "1 3 0\n0 0 1 2\n");
}

TEST_CASE("input that cannot be read or is invalid is status 3 with its file and line") {
  Session session;
  CHECK(contains(session.bad(3, "triangulate none.poly"), "none.poly"));
  session.write("bad.poly", "2 2 0 0\n0 0 0\n1 nan 0\n0\n");
  CHECK(contains(session.bad(3, "triangulate bad.poly -o out.ele"), "bad.poly:3: "));
  session.write("bad.poly", "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n1 0\n0 0 3\n");
  CHECK(contains(session.bad(3, "triangulate bad.poly"), "bad.poly:6: "));
  session.write("bad.node", "1000000000000000000 2 0 0\n0 0 0\n");
  CHECK(contains(session.bad(3, "triangulate bad.node"), "bad.node:1: "));
  session.write("cut.node", "536870910 2 0 0\n0 0 0\n");
#ifdef __SANITIZE_ADDRESS__
  const std::string limit;  // the sanitizer itself takes more
#else
  const std::string limit = "ulimit -v 4000000; ";
#endif
  const Outcome cut = session.shell(limit + "\"$gcdt\" triangulate cut.node");
  CHECK(cut.status == 3);
  CHECK(contains(cut.err, "cut.node:2: "));
  const Outcome piped = session.shell("printf '1 2 0 0\\n0 0\\n' | \"$gcdt\" triangulate -");
  CHECK(piped.status == 3);
  CHECK(contains(piped.err, "<stdin>:2: "));
}

TEST_CASE("devices are listed with what matters") {
  const std::string table = Session().good("devices");
  for (const char* column :
       {"name", "platform", "vendor", "driver", "memory", "largest buffer", "64-bit atomics", "fp64"})
    CHECK(contains(table, column));
  CHECK(contains(table, "\n0 "));
}

TEST_CASE("without a device the status is 4 and the message says what to install") {
  Session session;
  session.write("in.poly", square);
  for (const char* arguments : {"devices", "triangulate in.poly -o out.ele"}) {
    const Outcome outcome =
        session.shell(std::string("env -u OCL_ICD_FILENAMES OCL_ICD_VENDORS=/no-such-folder \"$gcdt\" ") + arguments);
    CHECK(outcome.status == 4);
    CHECK(contains(outcome.err, "pocl-opencl-icd"));
  }
  CHECK(session.gcdt("triangulate in.poly --device no-such-device -o out.ele").status == 4);
  CHECK(session.gcdt("triangulate in.poly --device 999").status == 4);
  CHECK(session.shell("GCDT_DEVICE=no-such-device \"$gcdt\" triangulate in.poly").status == 4);
  session.good("triangulate in.poly --device 0 -o out.ele");
}

TEST_CASE("a mesh is written in canonical order and in the input's numbers") {
  Session session;
  session.write("zero.poly", square);
  session.write("one.poly", square_from_1);
  session.good("triangulate zero.poly -o zero.ele -o zero.neigh -o zero.edge");
  CHECK(data_lines(session.read("zero.ele")) == "2 3 0\n0 0 1 3\n1 1 2 3\n");
  CHECK(data_lines(session.read("zero.neigh")) == "2 3\n0 1 -1 -1\n1 -1 0 -1\n");
  CHECK(data_lines(session.read("zero.edge")) == "5 1\n0 1 3 1\n1 3 0 0\n2 0 1 0\n3 2 3 0\n4 1 2 0\n");
  session.good("triangulate one.poly -o one.ele -o one.neigh -o one.poly.poly");
  CHECK(data_lines(session.read("one.ele")) == "2 3 0\n1 1 2 4\n2 2 3 4\n");
  CHECK(data_lines(session.read("one.neigh")) == "2 3\n1 2 -1 -1\n2 -1 1 -1\n");
  CHECK(data_lines(session.read("one.poly.poly")) == "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n1 1\n1 2 4 1\n0\n");
}

TEST_CASE("all formats at once: verified, the same bytes in every run, and free of paths, devices and dates") {
  for (int first : {0, 1}) {
    Session session;
    session.write("in.poly", random_poly(400, first));
    const std::string outputs = "-o o.ele -o o.node -o o.neigh -o o.edge -o o.poly -o o.vtu -o o.svg";
    session.good("triangulate in.poly --verify " + outputs);
    const std::vector<std::string> names{"in.poly", "o.edge", "o.ele", "o.neigh", "o.node", "o.poly", "o.svg", "o.vtu"};
    CHECK(session.names() == names);
    for (const char* output : {"o.ele", "o.neigh", "o.vtu"})
      CHECK(session.good(std::string("verify in.poly ") + output).compare(0, 6, "valid:") == 0);
    CHECK(session.good("verify --quiet in.poly o.ele") == "");
    // The cleaned graph has the same triangulation, and so has the same input from a pipe.
    session.good("triangulate o.poly -o again.ele");
    CHECK(session.read("again.ele") == session.read("o.ele"));
    session.run("\"$gcdt\" triangulate - -o piped.ele <in.poly");
    CHECK(session.read("piped.ele") == session.read("o.ele"));
    Session second;
    second.write("in.poly", random_poly(400, first));
    second.good("triangulate in.poly " + outputs);
    const auto device = nlohmann::json::parse((second.good("triangulate in.poly -o s.ele --stats s.json"),
                                               second.read("s.json")))["device"]
                            .get<std::string>();
    for (std::size_t i = 1; i < names.size(); ++i) {
      CAPTURE(names[i]);
      const std::string bytes = session.read(names[i]);
      CHECK(bytes == second.read(names[i]));
      CHECK(!contains(bytes, device));
      CHECK(!contains(bytes, "gcdt-test-"));
    }
  }
}

TEST_CASE("statistics have the names of docs/statistics.md") {
  Session session;
  session.write("in.poly", square);
  session.good("triangulate in.poly -o o.ele --stats s.json");
  const auto json = nlohmann::json::parse(session.read("s.json"));
  for (const char* name :
       {"n", "m", "vertices_merged", "constraints_zero", "constraints_pieces", "constraints_overlapping", "crossings",
        "constraints_dropped", "vertices_added", "triangles", "flips", "history_depth", "location_steps", "launches",
        "read_backs", "crossed_pairs", "peak_device_bytes"}) {
    CAPTURE(name);
    CHECK(json.at(name).is_number_unsigned());
  }
  for (const char* name :
       {"read", "call", "core", "full", "write", "build", "order", "insert", "constrain", "flip", "check", "output"})
    CHECK(json.at("ms").at(name).is_number());
  for (const char* name : {"insert", "flip"}) CHECK(json.at("rounds").at(name).is_number_unsigned());
  for (const char* name : {"device", "driver", "platform", "version"}) CHECK(!json.at(name).get<std::string>().empty());
  for (const char* name : {"kind", "origin", "cell", "largest_move"}) CHECK(json.at("grid").contains(name));
  for (const char* name : {"edge_splits", "constraint_hits", "existing_edges", "pieces_walked", "chain_vertices",
                           "holes", "symbolic_chain_vertices"})
    CHECK(json.at("cases").at(name).is_number_unsigned());
  for (const char* name : {"least_angle", "largest_angle", "least_area", "largest_area", "area"})
    CHECK(json.at("quality").at(name).is_number_float());
  CHECK(json["quality"]["area"] == 1);
  CHECK(json["quality"]["least_angle"] == 45);
  CHECK(contains(json.at("plan").get<std::string>(), "order by "));
  CHECK(json["n"] == 4);
  CHECK(json["m"] == 1);
  CHECK(json["triangles"] == 2);
  CHECK(json["ms"]["read"] > 0);
  CHECK(json["ms"]["write"] > 0);
}

TEST_CASE("without an output the statistics are printed, and not if quiet") {
  Session session;
  session.write("in.poly", square);
  const std::string table = session.good("triangulate in.poly");
  for (const char* row : {"vertices ", "constraints ", "triangles ", "grid ", "device "}) CHECK(contains(table, row));
  CHECK(session.good("triangulate in.poly --quiet") == "");
  CHECK(session.good("triangulate in.poly -o o.ele") == "");
}

TEST_CASE("constraints that cross are listed with their numbers, ends and lines, or dropped") {
  Session session;
  session.write("in.poly", crossed);
  session.write("o.ele", "before");
  const Outcome rejected = session.gcdt("triangulate in.poly -o o.ele");
  CHECK(rejected.status == 3);
  for (const char* part :
       {"in.poly", "1 pair", "segment 0 (vertices 1 3, line 7)", "segment 1 (vertices 0 2, line 8)", "--crossing drop"})
    CHECK(contains(rejected.err, part));
  CHECK(session.read("o.ele") == "before");
  session.good("triangulate in.poly --crossing drop --verify -o o.ele -o o.poly --stats s.json");
  CHECK(data_lines(session.read("o.ele")) == "2 3 0\n0 0 1 3\n1 1 2 3\n");
  CHECK(contains(session.read("o.poly"), "\n1 1\n0 1 3 1\n0\n"));
  CHECK(nlohmann::json::parse(session.read("s.json"))["constraints_dropped"] == 1);
  session.good("verify in.poly o.ele --crossing drop");
  session.bad(5, "verify in.poly o.ele");
}

TEST_CASE("constraints that cross are split, and files with added vertices are verified") {
  Session session;
  session.write("in.poly", crossed);
  session.good("triangulate in.poly --crossing split --verify -o o.ele -o o.poly -o o.vtu --stats s.json");
  const auto json = nlohmann::json::parse(session.read("s.json"));
  CHECK(json["vertices_added"] == 1);
  CHECK(json["constraints_split"] == 2);
  CHECK(json["constraint_move"] == 0.0);
  CHECK(contains(session.read("o.node"), "5 2 0 0\n"));
  session.good("verify in.poly o.ele --crossing split");
  session.good("verify in.poly o.vtu --crossing split");
  session.bad(5, "verify in.poly o.vtu --crossing drop");
  session.bad(5, "verify in.poly o.ele");
  // The split graph is an input without crossings, of the same triangles.
  session.good("triangulate o.poly --verify -o again.ele");
  CHECK(data_lines(session.read("again.ele")) == data_lines(session.read("o.ele")));
  // A .node that lacks the vertex, or has it elsewhere.
  std::string node = session.read("o.node");
  session.write("o.node", "4 2 0 0\n" + node.substr(node.find('\n') + 1, node.find("\n4 ") - node.find('\n')));
  session.bad(5, "verify in.poly o.ele --crossing split");
  // No file of the input is overwritten.
  session.write("points.node", session.read("o.node"));
  session.write("points.poly", "0 2 0 0\n2 0\n0 0 2\n1 1 3\n0\n");
  session.bad(2, "triangulate points.poly --crossing split -o points.ele");
}

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
      {"{", "no JSON"},
      {"\n\n[]", "bad.json:3: the file: an object is due, not []"},
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
      {R"({"type": "Point", "coordinates": [1e999, 0]})", "no JSON"}};
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

TEST_CASE("verify catches every kind of wrong mesh with status 5") {
  Session session;
  session.write("in.poly", random_poly(60, 0));
  session.good("triangulate in.poly -o o.ele -o o.neigh -o o.vtu");
  std::vector<std::string> rows;
  std::istringstream in(data_lines(session.read("o.ele")));
  std::string header;
  std::getline(in, header);
  for (std::string row; std::getline(in, row);) rows.push_back(row.substr(row.find(' ') + 1));
  auto write = [&](const std::vector<std::string>& triangles) {
    std::string text = std::to_string(triangles.size()) + " 3 0\n";
    for (std::size_t t = 0; t < triangles.size(); ++t) text += std::to_string(t) + " " + triangles[t] + "\n";
    session.write("m.ele", text);
  };
  auto mutant = [&](auto&& change) {
    std::vector<std::string> triangles = rows;
    change(triangles);
    write(triangles);
    CHECK(contains(session.bad(5, "verify in.poly m.ele"), "m.ele"));
  };
  write(rows);
  session.good("verify in.poly m.ele");
  write({rows.rbegin(), rows.rend()});
  session.good("verify in.poly m.ele");
  mutant([](auto& t) { t.pop_back(); });
  mutant([](auto& t) { t.push_back(t.front()); });
  mutant([](auto& t) { t.back() = t.front(); });
  mutant([](auto& t) {
    std::istringstream corners(t.front());
    std::string a, b, c;
    corners >> a >> b >> c;
    t.front() = a + " " + c + " " + b;
  });
  mutant([](auto& t) { t.front() = "0 1 60"; });
  mutant([](auto& t) { t.front() = "0 1 -1"; });
  mutant([](auto& t) { t.clear(); });

  std::string neigh = session.read("o.neigh");
  session.write("o.neigh",
                neigh.replace(neigh.find("\n1 ") + 1, neigh.find("\n2 ") - neigh.find("\n1 ") - 1, "1 -1 -1 -1"));
  session.bad(5, "verify in.poly o.neigh");
  session.write("other.poly", random_poly(61, 0));
  session.bad(5, "verify other.poly o.vtu");
  session.bad(5, "verify other.poly o.ele");
}

namespace {

using Corners = std::array<int, 3>;

/// Twice the area of a triangle of points whose coordinates are whole numbers.
long long turn(const std::vector<std::array<long long, 2>>& points, int a, int b, int c) {
  const auto &p = points[a], &q = points[b], &r = points[c];
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

}  // namespace

TEST_CASE("verify notices each single flip undone, and each constraint replaced by the other diagonal") {
  Session session;
  session.write("in.poly", random_poly(120, 0));
  session.good("triangulate in.poly -o o.ele -o o.edge -o o.node");
  std::vector<std::array<long long, 2>> points;
  std::istringstream nodes(session.read("o.node"));
  std::size_t count = 0;
  for (nodes >> count, nodes.ignore(100, '\n'); points.size() < count;) {
    double number, x, y;
    nodes >> number >> x >> y;
    points.push_back({std::llround(x * 1000), std::llround(y * 1000)});
  }
  std::istringstream rows(session.read("o.ele"));
  std::vector<Corners> triangles;
  for (rows >> count, rows.ignore(100, '\n'); triangles.size() < count;) {
    int number;
    Corners t;
    rows >> number >> t[0] >> t[1] >> t[2];
    triangles.push_back(t);
  }
  std::map<std::array<int, 2>, std::array<std::size_t, 2>> sides;  // directed edge: triangle, corner across
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) sides[{triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]}] = {t, k};
  std::istringstream edges(session.read("o.edge"));
  int flipped = 0, broken = 0;
  for (edges >> count, edges.ignore(100, '\n'); count > 0; --count) {
    int number, a, b, marker;
    edges >> number >> a >> b >> marker;
    if (sides.count({a, b}) == 0 || sides.count({b, a}) == 0) continue;
    const auto [t, k] = sides[{a, b}];
    const auto [u, j] = sides[{b, a}];
    const int c = triangles[t][k], d = triangles[u][j];
    if (turn(points, c, a, d) <= 0 || turn(points, d, b, c) <= 0) continue;  // cannot be flipped
    std::vector<Corners> mutant = triangles;
    mutant[t] = {c, a, d};
    mutant[u] = {d, b, c};
    std::string text = std::to_string(mutant.size()) + " 3 0\n";
    for (std::size_t i = 0; i < mutant.size(); ++i)
      text += std::to_string(i) + " " + std::to_string(mutant[i][0]) + " " + std::to_string(mutant[i][1]) + " " +
              std::to_string(mutant[i][2]) + "\n";
    session.write("m.ele", text);
    const std::string said = session.bad(5, "verify in.poly m.ele");
    CAPTURE(said);
    CHECK(contains(said, marker != 0 ? "constraint" : "Delaunay"));
    ++(marker != 0 ? broken : flipped);
  }
  CHECK(flipped > 100);
  CHECK(broken > 5);
}

TEST_CASE("verify cannot read an output that is missing or malformed: status 3") {
  Session session;
  session.write("in.poly", square);
  session.bad(3, "verify in.poly none.ele");
  session.write("bad.ele", "2 3 0\n0 0 1 3\n");
  CHECK(contains(session.bad(3, "verify in.poly bad.ele"), "bad.ele:2: "));
  session.write("bad.vtu", "<VTKFile>\n<");
  CHECK(contains(session.bad(3, "verify in.poly bad.vtu"), "bad.vtu:2: "));
}

TEST_CASE("an output that cannot be written is status 6, and all files stay as they were") {
  Session session;
  session.write("in.poly", square);
  session.write("o.ele", "before");
  std::filesystem::create_directory(session / "folder.svg");
  session.bad(6, "triangulate in.poly -o o.ele -o no-such-folder/o.svg");
  session.bad(6, "triangulate in.poly -o o.ele -o folder.svg");
  session.bad(6, "triangulate in.poly -o o.ele --stats no-such-folder/s.json");
  CHECK(session.read("o.ele") == "before");
  CHECK(session.names() == std::vector<std::string>{"folder.svg", "in.poly", "o.ele"});
  CHECK(session.shell("\"$gcdt\" triangulate in.poly 2>err.txt >/dev/full").status == 6);
}

TEST_CASE("an interrupt ends the command with status 130 and leaves nothing") {
  Session session;
  session.write("big.poly", random_poly(20000, 0));
  session.write("o.ele", "before");
  const Outcome waiting = session.shell(
      "mkfifo pipe; sleep 20 >pipe & \"$gcdt\" triangulate - -o o.ele <pipe & p=$!; sleep 0.5; kill -TERM $p; wait $p");
  CHECK(waiting.status == 130);
  CHECK(waiting.err == "gcdt: interrupted\n");
  std::filesystem::remove(session / "pipe");
  for (const char* delay : {"0.05", "0.15", "0.4"}) {
    const Outcome working = session.shell(std::string("\"$gcdt\" triangulate big.poly -o o.ele & p=$!; sleep ") +
                                          delay + "; kill -TERM $p; wait $p");
    CHECK((working.status == 130 || working.status == 0 || working.status == 143));  // 143: before it was ready for it
    if (working.status != 0) CHECK(session.read("o.ele") == "before");
    session.write("o.ele", "before");
    CHECK(session.names() == std::vector<std::string>{"big.poly", "o.ele"});
  }
}

TEST_CASE("progress is shown on a terminal, cleared at the end, and not if quiet") {
  Session session;
  session.write("in.poly", random_poly(400, 0));
  auto on_terminal = [&](const std::string& arguments) {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
    REQUIRE(terminal >= 0);
    REQUIRE(grantpt(terminal) == 0);
    REQUIRE(unlockpt(terminal) == 0);
    const std::string name = ptsname(terminal);
    const int held = open(name.c_str(), O_RDWR | O_NOCTTY);
    std::string seen;
    std::thread reader([&] {
      char part[4096];
      for (ssize_t got; (got = read(terminal, part, sizeof part)) > 0;)
        seen.append(part, static_cast<std::size_t>(got));
    });
    CHECK(session.shell("\"$gcdt\" " + arguments + " 2>" + name).status == 0);
    close(held);
    reader.join();
    close(terminal);
    return seen;
  };
  const std::string seen = on_terminal("triangulate in.poly -o o.ele");
  CHECK(contains(seen, "%"));
  REQUIRE(seen.size() >= 4);
  CHECK(seen.substr(seen.size() - 4) == "\r\x1b[K");
  CHECK(on_terminal("triangulate in.poly -o o.ele --quiet") == "");
}

TEST_CASE("the trace is JSON in Chrome's format: every launch lies within a phase of its row") {
  Session session;
  session.write("in.poly", random_poly(400, 0));
  session.good("triangulate in.poly --quiet --trace t.json --stats s.json");
  const auto trace = nlohmann::json::parse(session.read("t.json"));
  const auto statistics = nlohmann::json::parse(session.read("s.json"));
  std::size_t launches = 0;
  for (const auto& event : trace.at("traceEvents")) {
    if (event.at("ph") == "M") {
      CHECK(event.at("args").at("name").is_string());
      continue;
    }
    CHECK(event.at("ph") == "X");
    CHECK(event.at("ts").get<double>() >= 0);
    if (event.at("cat") != "launch") continue;
    ++launches;
    bool held = false;
    for (const auto& phase : trace.at("traceEvents"))
      held = held || (phase.at("ph") == "X" && phase.at("cat") == "phase" && phase.at("tid") == event.at("tid") &&
                      phase.at("ts").get<double>() <= event.at("ts").get<double>() &&
                      phase.at("ts").get<double>() + phase.at("dur").get<double>() >=
                          event.at("ts").get<double>() + event.at("dur").get<double>() - 1e-3);
    CHECK(held);
  }
  CHECK(launches == statistics.at("launches").get<std::size_t>());
}

TEST_CASE("every row of a trace is named after the phase whose spans it holds") {
  Session session;
  session.write("in.poly", random_poly(400, 0));
  const std::pair<std::string, std::set<std::string>> runs[] = {
      {"triangulate in.poly --domain outer", {"order", "plan", "insert", "flip", "check", "domain", "output"}},
      {"batch in.poly", {"order", "insert", "check", "output", "copy"}}};
  for (const auto& [command, expected] : runs) {
    CAPTURE(command);
    session.good(command + " --quiet --trace t.json");
    const auto trace = nlohmann::json::parse(session.read("t.json"));
    std::map<std::size_t, std::string> names;
    for (const auto& event : trace.at("traceEvents"))
      if (event.at("name") == "thread_name") names[event.at("tid")] = event.at("args").at("name");
    std::set<std::string> found;
    for (const auto& event : trace.at("traceEvents"))
      if (event.at("ph") == "X") {
        REQUIRE(names.count(event.at("tid")) == 1);
        found.insert(names[event.at("tid")]);
      }
    for (const std::string& phase : expected) CHECK(found.count(phase) == 1);
  }
}

TEST_CASE("a batch writes what triangulate writes, and inputs that fail spoil no other") {
  Session session;
  session.run("mkdir many");
  session.write("many/a.poly", random_poly(300, 0));
  session.write("many/b.poly", square_from_1);
  session.write("many/c.node", "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n");
  session.write("many/d.node", "0 2 0 0\n");
  session.write("many/empty.poly", "0 2 0 0\n0 0\n0\n");
  session.write("more.poly", square);
  session.good("batch many more.poly -o out --format ele --format .neigh --format vtu --verify --stats s.json");
  const auto statistics = nlohmann::json::parse(session.read("s.json"));
  CHECK(statistics.at("inputs") == 6);
  CHECK(statistics.at("failed") == 0);
  for (const auto& device : statistics.at("devices"))
    CHECK(contains(device.at("plan").get<std::string>(), "worker; jobs of weight "));
  for (const char* input :
       {"many/a.poly", "many/b.poly", "many/c.node", "many/d.node", "many/empty.poly", "more.poly"}) {
    session.good(std::string("triangulate ") + input + " -o one.ele -o one.neigh -o one.vtu --quiet");
    session.run(std::string("name=$(basename ") + input +
                "); for e in ele neigh vtu; do cmp one.$e out/${name%.*}.$e || exit 1; done");
  }
  session.write("many/bad.poly", "nonsense\n");
  session.write("many/crossed.poly", crossed);
  session.run("rm -r out");
  const Outcome mixed = session.gcdt("batch many -o out");
  CHECK(mixed.status == 3);
  CHECK(contains(mixed.err, "many/bad.poly:1"));
  CHECK(contains(mixed.err, "many/crossed.poly: 1 pair of constraints crosses"));
  CHECK(contains(mixed.err, "2 of 7 inputs failed"));
  CHECK(session.shell("ls out").out == "a.ele\nb.ele\nc.ele\nd.ele\nempty.ele\n");
  CHECK(contains(session.gcdt("batch many/a.poly many/b.poly").out, "inputs        2 (0 failed)"));
}

TEST_CASE("a batch splits crossings, with the files and attributes that triangulate writes") {
  Session session;
  session.run("mkdir many");
  session.write("many/crossed.poly",
                "4 2 1 1\n0 0 0 10 5\n1 4 4 30 5\n2 0 4 100 6\n3 4 0 140 6\n2 1\n0 0 1 7\n1 2 3 8\n0\n");
  session.write("many/plain.poly", square);
  session.write("many/rounded.poly", "4 2 0 0\n1 0 0\n2 1e9 1\n3 0 1\n4 1e9 0\n2 0\n1 1 2\n2 3 4\n0\n");
  session.write("many/wrong.poly", "1 2 0 0\n0 0 0\n1 0\n0 0 7\n0\n");
  const Outcome run = session.gcdt(
      "batch many -o out --crossing split --format ele --format poly --format edge --format vtu --format jsonl "
      "--verify "
      "--stats s.json");
  CHECK(run.status == 3);
  CHECK(contains(run.err, "many/wrong.poly"));
  CHECK(contains(run.err, "1 of 4 inputs failed"));
  for (const std::string name : {"crossed", "plain", "rounded"}) {
    CAPTURE(name);
    session.good("triangulate many/" + name + ".poly --crossing split -o " + name + ".ele -o " + name + ".poly -o " +
                 name + ".edge -o " + name + ".vtu --quiet");
    session.run("for f in " + name + ".*; do cmp $f out/$f || exit 1; done");
  }
  // The .node has the added vertex: numbers 20 and 120 are those of the two constraints in their middles.
  CHECK(contains(session.read("out/crossed.node"), "\n4 2 2 70 "));
  CHECK(session.shell("ls out/plain.node").status != 0);
  session.good("verify many/crossed.poly out/crossed.ele --crossing split");
  const auto statistics = nlohmann::json::parse(session.read("s.json"));
  CHECK(statistics.at("crossings") == 2);
  CHECK(statistics.at("vertices_added") == 2);
  CHECK(statistics.at("constraints_split") == 4);
  const auto line = nlohmann::json::parse(session.read("out/crossed.jsonl"));
  CHECK(line.at("added") == nlohmann::json{{2.0, 2.0}});
  CHECK(contains(session.gcdt("batch many/crossed.poly --crossing split").out,
                 "crossings     1 (1 vertices added, 2 constraints split, moved by 0 at most)"));
  // Where the .ele needs a .node that is the input's, that input fails alone.
  session.write("p.node", "4 2 0 0\n0 0 0\n1 4 4\n2 0 4\n3 4 0\n");
  session.write("p.poly", "0 2 0 0\n2 0\n0 0 1\n1 2 3\n0\n");
  session.write("q.poly", square);
  const Outcome clash = session.gcdt("batch p.poly q.poly -o . --crossing split");
  CHECK(clash.status == 2);
  CHECK(contains(clash.err, "p.node"));
  CHECK(contains(clash.err, "1 of 2 inputs failed"));
  session.run("ls q.ele && ! ls p.ele");
}

TEST_CASE("a file with a GeoJSON text in each line is a batch, and jsonl has all results in one file") {
  Session session;
  // Lines 1, 3 and 5 are problems; 4 is none, and 6 has constraints that cross.
  const std::string ring =
      R"({"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[1,2],[2,1],[1,1]]]})";
  const std::string line = R"({"type":"LineString","coordinates":[[0,0],[1,2],[3,1]]})";
  const std::string cross = R"({"type":"MultiLineString","coordinates":[[[0,0],[2,2]],[[0,2],[2,0]]]})";
  const std::string feature = R"({"type":"Feature","properties":null,"geometry":)" + ring + "}";
  session.write("many.geojsonl", ring + "\n\n\x1e" + line + "\r\n{\"type\": 5}\n" + feature + "\n" + cross);
  session.write("one.geojson", ring);
  const Outcome run =
      session.gcdt("batch many.geojsonl one.geojson -o out --format ele --format jsonl --domain even-odd --verify");
  CHECK(run.status == 3);
  CHECK(contains(run.err, "many.geojsonl:4: "));
  CHECK(contains(run.err, "many.geojsonl:6: 1 pair of constraints crosses"));
  CHECK(contains(run.err, "2 of 6 inputs failed"));
  CHECK(session.shell("ls out").out == "many-1.ele\nmany-3.ele\nmany-5.ele\nmany.jsonl\none.ele\none.jsonl\n");
  session.good("triangulate one.geojson --domain even-odd -o alone.ele");
  session.run("cmp alone.ele out/one.ele && cmp alone.ele out/many-1.ele && cmp alone.ele out/many-5.ele");

  std::vector<nlohmann::json> lines;
  std::istringstream text(session.read("out/many.jsonl"));
  for (std::string each; std::getline(text, each);) lines.push_back(nlohmann::json::parse(each));
  REQUIRE(lines.size() == 5);
  CHECK(lines[0].at("line") == 1);
  // A square with a hole: 7 vertices, 7 edges on the borders, so 7 triangles.
  CHECK(lines[0].at("triangles").size() == 7);
  CHECK(lines[3].at("triangles") == lines[0].at("triangles"));
  CHECK(lines[1].at("triangles").empty());  // a line bounds nothing
  CHECK(lines[1].at("line") == 3);
  CHECK(contains(lines[2].at("error").get<std::string>(), "many.geojsonl:4"));
  CHECK(contains(lines[4].at("error").get<std::string>(), "crosses"));
  session.bad(2, "batch many.geojsonl many.geojsonl -o out");
  session.bad(3, "batch none.geojsonl -o out");
}

TEST_CASE("a batch has more output files than a process can have open") {
  Session session;
  session.write("in.poly", square);
  session.run(
      "mkdir many && for i in 1 2 3 4 5 6 7 8 9; do for j in 1 2 3 4 5 6 7 8 9; do cp in.poly many/$i$j.poly; "
      "done; done");
  const Outcome run =
      session.shell("ulimit -n 60; \"$gcdt\" batch many -o out --format jsonl --quiet && ls out | wc -l");
  CHECK(run.status == 0);
  CHECK(run.out == "81\n");
  CHECK(nlohmann::json::parse(session.read("out/99.jsonl")).at("triangles").size() == 2);
}

TEST_CASE("what a batch cannot do is status 2 or 3 and one line") {
  Session session;
  session.write("in.poly", square);
  session.run("mkdir empty other && cp in.poly other/");
  for (const char* arguments :
       {"batch", "batch in.poly --format xyz -o out", "batch in.poly other -o out", "batch in.poly -o . --format poly",
        "batch in.poly --grid 0,0 -o out", "batch in.poly --no-such-option", "batch in.poly --stats in.poly",
        "batch in.poly --trace ./in.poly", "batch in.poly -o out --stats out/in.ele",
        "batch in.poly --stats same.json --trace ./same.json"})
    session.bad(2, arguments);
  CHECK(session.read("in.poly") == square);
  session.bad(3, "batch empty -o out");
  CHECK(session.gcdt("batch in.poly --device cpu,99 -o out").status == 4);
  CHECK(session.names() == std::vector<std::string>{"empty", "in.poly", "other"});
  session.good("batch in.poly -o out --device all --trace t.json");
  CHECK(nlohmann::json::parse(session.read("t.json")).at("traceEvents").size() > 10);
}

/// 770 vertices with six decimals, but for two numbers.
std::string mixed_decimals() {
  std::ostringstream text;
  text << "770 2 0 0\n";
  for (int i = 1; i <= 768; ++i) text << i << " " << i % 32 * 10 << ".123456 " << i / 32 * 5 << ".654321\n";
  text << "769 320.12345612 5.654321\n770 10.1234560012 5.654321\n0 0\n0\n";
  return text.str();
}

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

/// A square in a square, each with a point for a region, the inner one with a hole.
std::string framed() {
  return "8 2 0 0\n0 0 0\n1 9 0\n2 9 9\n3 0 9\n4 3 3\n5 6 3\n6 6 6\n7 3 6\n8 0\n0 4 5\n1 5 6\n2 6 7\n3 7 4\n4 0 1\n"
         "5 1 2\n6 2 3\n7 3 0\n1\n0 4 4\n2\n0 1 1 17.5 -1\n1 4 5 4 -1\n";
}

TEST_CASE("batch uses the hole and region points of each input, or says that it does not, as triangulate does") {
  Session session;
  session.write("framed.poly", framed());
  session.write("square.poly", square);
  for (const std::string options : {"", "--regions", "--domain holes", "--domain outer-holes", "--domain even-odd",
                                    "--domain outer --verify", "--domain holes --verify"}) {
    CAPTURE(options);
    const Outcome one = session.gcdt("triangulate framed.poly -o one.ele -o one.vtu -o one.neigh " + options);
    const Outcome many =
        session.gcdt("batch framed.poly square.poly -o out --format ele --format vtu --format neigh " + options);
    CHECK(one.status == 0);
    CHECK(many.status == 0);
    for (const std::string format : {".ele", ".vtu", ".neigh"})
      CHECK(session.read("out/framed" + format) == session.read("one" + format));
    std::istringstream notes(one.err);
    for (std::string line; std::getline(notes, line);)
      CHECK(contains(many.err, "gcdt: note: framed.poly: " + line.substr(12)));
  }
  CHECK(contains(session.read("out/framed.ele"), " 3 1\n"));
  const Outcome said = session.gcdt("batch framed.poly -o out --stats s.json --domain holes");
  CHECK(nlohmann::json::parse(session.read("s.json")).at("n") == 8);
  CHECK(said.err == "");
}

TEST_CASE("the time of inputs that batch triangulates alone is in its call, not in its writing") {
  Session session;
  session.write("framed.poly", framed());
  session.good("batch framed.poly --quiet --stats s.json --domain holes");  // nothing to write
  const auto ms = nlohmann::json::parse(session.read("s.json")).at("ms");
  CHECK(ms.at("call").get<double>() > ms.at("write").get<double>());
  CHECK(ms.at("write").get<double>() >= 0);
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

// SPDX-License-Identifier: Apache-2.0
// The command gcdt as its user sees it: its arguments, its statuses, and the files that it writes.
#include "command_session.hpp"

using namespace gcdt::testing;

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
  session.write("in.stl", square);
  for (const char* arguments : {"",
                                "frobnicate",
                                "triangulate",
                                "verify in.poly",
                                "triangulate in.poly --no-such-option",
                                "triangulate in.poly --stripes 2",
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
                                "triangulate in.poly --stats -",
                                "triangulate in.poly --trace -",
                                "batch in.poly --stats -",
                                "triangulate in.poly --memory -5",
                                "triangulate in.poly --memory ''",
                                "triangulate in.poly --memory GB",
                                "triangulate in.poly in.poly",
                                "triangulate in.stl",
                                "triangulate in.poly --grid 1",
                                "triangulate in.poly --grid 0,0",
                                "triangulate in.poly --grid 0,0,zero",
                                "triangulate in.poly --grid 0,0,0",
                                "triangulate in.poly --grid nan,0,1",
                                "triangulate in.poly --grid 0,0,-1",
                                "verify in.poly in.poly",
                                "devices 1"})
    session.bad(2, arguments);
  CHECK(contains(session.bad(2, "frobnicate"), "frobnicate is no subcommand"));
  CHECK(session.names() == std::vector<std::string>{"in.poly", "in.stl"});
  CHECK(session.read("in.poly") == square);
}

TEST_CASE("a directory to spill to that is none is status 6 before any work, whether there is room or not") {
  Session session;
  session.write("in.poly", square);
  CHECK(contains(session.bad(6, "triangulate in.poly --spill none -o out.ele"), "--spill none: is no directory"));
  CHECK(contains(session.bad(6, "triangulate in.poly --tiles 2 --spill in.poly"), "--spill in.poly: is no directory"));
  session.good("triangulate in.poly --tiles 2 --spill . -o out.ele");
  CHECK(session.names() == std::vector<std::string>{"in.poly", "out.ele"});
}

TEST_CASE("no name and no text of a file makes a terminal do anything") {
  Session session;
  session.write("in.geojson", R"({"type": "\u001b[31m\u007f"})");
  CHECK(contains(session.bad(3, "triangulate in.geojson"), "\"?[31m?\""));
  CHECK(contains(session.bad(3, "triangulate '\x1b[31m.poly'"), "?[31m.poly: cannot be opened"));
  CHECK(contains(session.bad(2, "'\a'"), "gcdt: ? is no subcommand"));
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

// SPDX-License-Identifier: Apache-2.0
// The command's batches: many inputs in one call.
#include "command_session.hpp"

using namespace gcdt::testing;

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
    CHECK(contains(device.at("plan").get<std::string>(), "jobs of weight "));
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
  // Mesa writes to standard error of what it compiles, once: then it has it in its cache.
  CHECK(session.gcdt("batch in.poly -o before --device all").status == 0);
  session.good("batch in.poly -o out --device all --trace t.json");
  CHECK(nlohmann::json::parse(session.read("t.json")).at("traceEvents").size() > 10);
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
  // Writing nothing takes microseconds, whatever the call takes beside the inputs that are triangulated alone.
  CHECK(ms.at("call").get<double>() > 10 * ms.at("write").get<double>());
  CHECK(ms.at("write").get<double>() >= 0);
}

// SPDX-License-Identifier: Apache-2.0
// gcdt triangulate --refine as its user sees it: options and what is refused, the files, the statistics.
#include <random>

#include "command_session.hpp"

using namespace gcdt::testing;

namespace {

/// An L with markers of vertices and segments, and wanted lengths as attributes.
constexpr const char* ell =
    "6 2 1 1\n1 0 0 0.5 7\n2 4 0 0.5 7\n3 4 1 0.05 7\n4 1 1 0.05 7\n5 1 3 0.5 7\n6 0 3 0.5 7\n"
    "6 1\n1 1 2 11\n2 2 3 12\n3 3 4 13\n4 4 5 14\n5 5 6 15\n6 6 1 16\n0\n2\n1 0.5 2 1 0.01\n2 3 0.5 2 -1\n";

nlohmann::json statistics(const Session& session, const std::string& arguments) {
  const Outcome outcome = session.gcdt("triangulate " + arguments + " --stats s.json");
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  return nlohmann::json::parse(session.read("s.json"));
}

/// The numbers of each line that is no comment, but the first `skipped`.
std::vector<std::vector<double>> rows(const std::string& text, std::size_t skipped) {
  std::istringstream lines(data_lines(text));
  std::vector<std::vector<double>> all;
  for (std::string line; std::getline(lines, line);) {
    if (skipped > 0 && skipped--) continue;
    std::istringstream numbers(line);
    std::vector<double>& row = all.emplace_back();
    for (double number; numbers >> number;) row.push_back(number);
  }
  return all;
}

}  // namespace

TEST_CASE("values that make no sense are status 2, and inputs that lack what is asked for status 3") {
  Session session;
  session.write("in.poly", ell);
  session.write("square.poly", square);
  for (const char* options : {"--refine 40",
                              "--refine 0.5",
                              "--refine -1",
                              "--refine nan",
                              "--refine",
                              "--refine x",
                              "--max-area 1",
                              "--conforming",
                              "--refine 20 --max-area 0",
                              "--refine 20 --max-area -1",
                              "--refine 20 --max-area nan",
                              "--refine 20 --min-length 0",
                              "--refine 20 --min-length inf",
                              "--refine 20 --max-vertices -1",
                              "--refine 20 --size 0",
                              "--refine 20 --no-split --no-border-split",
                              "--refine 20 --assess",
                              "--refine 20 --verify --crossing split",
                              "--refine 20 --tiles 2",
                              "--refine 20 --memory 1GB"})
    session.bad(2, std::string("triangulate in.poly -o out.ele ") + options);
  CHECK(contains(session.bad(3, "triangulate in.poly --refine 20 --size 2"), "the vertices have 1 attributes"));
  CHECK(contains(session.bad(3, "triangulate square.poly --refine 20 --region-areas"), "no region has an area"));
  session.write("zero.node", "3 2 1 0\n0 0 0 1\n1 1 0 0\n2 0 1 1\n");
  CHECK(contains(session.bad(3, "triangulate zero.node --refine 20 --size 1"), "attribute 1 of vertex 1 is 0"));
  CHECK(session.names() == std::vector<std::string>{"in.poly", "square.poly", "zero.node"});
}

TEST_CASE(
    "files have the input's vertices first, then the added ones with attributes and markers, and all subsegments") {
  Session session;
  session.write("in.poly", ell);
  session.run(
      "\"$gcdt\" triangulate in.poly --domain outer --refine 25 --size 1 -o o.node -o o.poly -o o.ele -o o.svg"
      " -o o.vtu 2>/dev/null");
  const auto given = rows(ell, 1), nodes = rows(session.read("o.node"), 1);
  REQUIRE(nodes.size() > 100);
  for (std::size_t v = 0; v < 6; ++v) CHECK(nodes[v] == given[v]);
  std::size_t on_border = 0;
  for (std::size_t v = 6; v < nodes.size(); ++v) {
    const double x = nodes[v][1], y = nodes[v][2], marker = nodes[v][4];
    CHECK(nodes[v][0] == double(v + 1));
    CHECK(nodes[v][3] >= 0.05);
    CHECK(nodes[v][3] <= 0.5);
    const double side = y == 0            ? 11
                        : x == 4          ? 12
                        : y == 1 && x > 1 ? 13
                        : x == 1 && y > 1 ? 14
                        : y == 3          ? 15
                        : x == 0          ? 16
                                          : 0;
    CHECK(marker == side);
    on_border += side != 0;
    // On the lower side the lengths are those of its ends, on the left one, too.
    if (side == 11 || side == 16) CHECK(nodes[v][3] == doctest::Approx(0.5));
  }
  const auto poly = rows(session.read("o.poly"), nodes.size() + 1);
  CHECK(poly[0] == std::vector<double>{double(6 + on_border), 1});
  for (std::size_t i = 1; i <= 6 + on_border; ++i) CHECK(poly[i][3] >= 11);
  const auto s = statistics(session, "in.poly --domain outer --refine 25 --size 1 --quiet");
  CHECK(s["refine"]["complete"] == true);
  CHECK(s["refine"]["added"] == nodes.size() - 6);
  CHECK(s["refine"]["on_subsegments"] == on_border);
  CHECK(s["quality"]["least_angle"] >= 25);
  CHECK(s["quality"]["area"] == doctest::Approx(6));
  CHECK(contains(session.read("o.svg"), "<svg"));
  // What was written can be read again, and needs nothing more.
  session.run("\"$gcdt\" triangulate o.poly --domain outer --refine 25 --quiet -o again.node");
  CHECK(rows(session.read("again.node"), 1).size() == nodes.size());
}

TEST_CASE("areas, of all and of regions; lengths, splits, and a limit") {
  Session session;
  session.write("in.poly", ell);
  const auto with = [&](const std::string& options) {
    return statistics(session, "in.poly --domain outer --quiet --refine " + options);
  };
  CHECK(with("20 --max-area 0.02")["quality"]["largest_area"] <= 0.02);
  CHECK(with("0 --max-area 0.02")["quality"]["largest_area"] <= 0.02);
  CHECK(with("20 --region-areas")["quality"]["largest_area"] <= 0.01);
  CHECK(with("20 --max-area 0.02 --no-split")["refine"]["on_subsegments"] == 0);
  CHECK(with("20 --max-area 0.02 --no-border-split")["refine"]["on_subsegments"] == 0);
  CHECK(with("20 --max-area 0.001 --min-length 0.2")["refine"]["left_grid"] > 0);
  CHECK(with("20 --max-area 0.02 --conforming")["refine"]["encroached"] == 0);
  CHECK(with("20 --max-area 0.001 --max-vertices 50")["refine"]["complete"] == false);
  const Outcome limited =
      session.gcdt("triangulate in.poly --domain outer --refine 20 --max-area 0.001 --max-vertices 50");
  CHECK(limited.status == 0);
  CHECK(contains(limited.err, "gcdt: note: the limit of added vertices ended the refinement"));
  CHECK(contains(limited.out, "50 vertices added"));
  CHECK(contains(limited.out, "by the limit of vertices"));
}

TEST_CASE("a grid that is too coarse is said once, whatever comes of it") {
  Session session;
  session.write("in.poly", ell);
  const Outcome outcome = session.gcdt("triangulate in.poly --grid 0,0,0.125 --refine 20 --max-area 0.01");
  CHECK(outcome.status == 0);
  const std::string said = "too coarse for triangles with sides of about 0.151967";
  CHECK(contains(outcome.err, said));
  CHECK(outcome.err.find(said) == outcome.err.rfind(said));
  CHECK(contains(outcome.out, "by the grid or the least length"));
}

TEST_CASE("refined meshes are verified from the files, and triangles that are excused are named") {
  Session session;
  session.write("in.poly", ell);
  const std::string how = " --domain outer --refine 25 --max-area 0.1";
  session.run("\"$gcdt\" triangulate in.poly --verify --quiet -o o.ele -o o.vtu" + how);
  for (const char* file : {"o.ele", "o.vtu"})
    CHECK(contains(session.good("verify in.poly " + std::string(file) + how), "0 triangles are excused"));
  CHECK(contains(session.bad(5, "verify in.poly o.vtu --domain outer --refine 25 --max-area 0.02"), "largest area"));
  CHECK(contains(session.bad(5, "verify in.poly o.ele --domain outer --refine 34"), "angle below the least one"));
  session.bad(5, "verify in.poly o.vtu --domain hull --refine 25 --max-area 0.1");
  session.bad(2, "verify in.poly o.ele --refine 99");
  session.bad(2, "verify in.poly o.ele --refine 20 --crossing split");
  // A needle: its tip stays sharp.
  session.write("needle.poly", "3 2 0 0\n1 0 0\n2 10 0\n3 10 1\n3 0\n1 1 2\n2 2 3\n3 3 1\n0\n");
  session.run("\"$gcdt\" triangulate needle.poly --quiet -o n.ele --refine 20");
  const std::string found = session.good("verify needle.poly n.ele --refine 20");
  CHECK(contains(found, "1 triangles are excused"));
  CHECK(contains(found, "in an angle between constraints"));
}

TEST_CASE("triangles at a bent hull that could not be split are proved to be those, from the files") {
  Session session;
  std::uint64_t refused = 0;
  for (std::uint64_t seed = 1; seed < 10 && refused < 2; ++seed) {
    std::mt19937_64 random(seed);
    const auto number = [&] { return std::ldexp(static_cast<double>(random() >> 11), -53); };  // they fill the grid
    std::ostringstream points;
    points.precision(17);
    points << "3000 2 0 0\n";
    for (int i = 1; i <= 3000; ++i) points << i << ' ' << number() << ' ' << number() << '\n';
    session.write("in.node", points.str());
    refused = statistics(session, "in.node --refine 20 --verify -o o.ele")["refine"]["left_refused"];
  }
  REQUIRE(refused > 1);
  const std::string found = session.good("verify in.node o.ele --refine 20");
  CHECK(contains(found, std::to_string(refused) + " triangles are excused"));
  CHECK(contains(found, "a constraint that has no place to be split at"));
}

TEST_CASE("Triangle's switches") {
  Session session;
  session.write("in.poly", ell);
  session.write("in.node", "4 2 0 0\n0 0 0\n1 1 0\n2 0 1\n3 1 1\n");
  session.good("triangulate in.poly --triangle pq25a0.05enQ");
  for (const char* name : {"in.1.node", "in.1.ele", "in.1.poly", "in.1.edge", "in.1.neigh"})
    CHECK(!session.read(name).empty());
  session.run(
      "\"$gcdt\" triangulate in.poly --domain outer-holes --crossing split --refine 25 --max-area 0.05 --quiet"
      " -o other.ele -o other.node");
  CHECK(session.read("in.1.ele") == session.read("other.ele"));
  CHECK(session.read("in.1.node") == session.read("other.node"));
  session.good("triangulate in.1.poly --triangle pq25a0.05Q");
  CHECK(data_lines(session.read("in.2.node")) == data_lines(session.read("in.1.node")));
  session.good("triangulate in.node --triangle qa0.1zQNP");
  CHECK(rows(session.read("in.1.ele"), 1).size() > 10);
  const auto with = [&](const std::string& switches) {
    return statistics(session, "in.poly -o t.ele --triangle " + switches);
  };
  CHECK(with("pqaQ")["quality"]["largest_area"] <= 0.01);
  CHECK(with("pqYYa0.05Q")["refine"]["on_subsegments"] == 0);
  CHECK(with("pqS7a0.001Q")["refine"]["added"] == 7);
  CHECK(with("pDQ")["refine"]["encroached"] == 0);
  CHECK(with("-pcQ")["triangles"] == 5);
  CHECK(with("pQ")["triangles"] == 4);
  CHECK(with("pAq20Q")["regions"] > 0);
  for (const char* arguments :
       {"in.poly --triangle q", "in.node --triangle p", "in.poly --triangle pr", "in.poly --triangle pq40",
        "in.poly --triangle po2", "in.poly --triangle p --domain hull", "in.poly --triangle p --refine 20"})
    session.bad(2, std::string("triangulate ") + arguments);
}

TEST_CASE("Triangle's switch j leaves out what no triangle has") {
  Session session;
  // A square with a hole that has a vertex inside, and a vertex given twice; the first vertex is far outside.
  session.write("in.poly",
                "11 2 1 1\n0 9 9 3 4\n1 0 0 1 0\n2 6 0 1 0\n3 6 6 1 0\n4 0 6 1 0\n5 2 2 2 0\n6 4 2 2 0\n7 4 4 2 0\n"
                "8 2 4 2 0\n9 3 3 5 0\n10 6 6 1 0\n8 1\n0 1 2 1\n1 2 3 1\n2 3 4 1\n3 4 1 1\n4 5 6 2\n5 6 7 2\n"
                "6 7 8 2\n7 8 5 2\n1\n0 3 3\n");
  session.good("triangulate in.poly --triangle pjQ");
  const auto nodes = rows(session.read("in.1.node"), 1);
  REQUIRE(nodes.size() == 8);
  CHECK(nodes[0] == std::vector<double>{0, 0, 0, 1, 0});
  CHECK(nodes[7] == std::vector<double>{7, 2, 4, 2, 0});
  for (const auto& triangle : rows(session.read("in.1.ele"), 1))
    for (std::size_t k = 1; k < 4; ++k) CHECK(triangle[k] < 8);
  CHECK(rows(session.read("in.1.poly"), 9)[0] == std::vector<double>{8, 1});
  session.good("triangulate in.1.poly --triangle pQ");
  CHECK(rows(session.read("in.2.ele"), 1) == rows(session.read("in.1.ele"), 1));
}

TEST_CASE("a batch refines each input to the files that triangulate writes, by its own lengths and areas") {
  Session session;
  session.run("mkdir many");
  session.write("many/ell.poly", ell);
  session.write("many/square.poly", square);
  session.write("many/wrong.poly", "1 2 0 0\n0 0 0\n1 0\n0 0 7\n0\n");
  const auto same = [&](const std::string& options) {
    CAPTURE(options);
    for (const std::string name : {"ell", "square"}) {
      session.good("triangulate many/" + name + ".poly " + options + " -o " + name + ".ele -o " + name +
                   ".poly --quiet");
      session.run("for f in " + name + ".*; do cmp $f out/$f || exit 1; done; rm " + name + ".*");
    }
    session.run("rm -r out");
  };
  const std::string formats = " --format ele --format poly --stats s.json -o out ";
  for (const std::string options : {"--refine 25 --max-area 0.1 --domain outer", "--refine 20 --crossing split",
                                    "--refine 30 --no-border-split --conforming --max-vertices 50"}) {
    const Outcome run = session.gcdt("batch many " + options + formats);
    CHECK(run.status == 3);  // of the wrong one
    CHECK(contains(run.err, "1 of 3 inputs failed"));
    same(options);
  }
  session.run("rm many/wrong.poly");
  // Lengths are attributes of the L; the square has none, and fails alone.
  const Outcome by_length = session.gcdt("batch many --refine 20 --size 1 --verify" + formats);
  CHECK(by_length.status == 3);
  CHECK(contains(by_length.err, "--size 1: the vertices have 0 attributes"));
  session.good("triangulate many/ell.poly --refine 20 --size 1 -o ell.ele --quiet");
  session.run("cmp ell.ele out/ell.ele && cmp ell.node out/ell.node && rm -r out ell.*");
  const auto said = nlohmann::json::parse(session.read("s.json"));
  CHECK(said.at("refine_added") == said.at("vertices_added"));
  CHECK(said.at("refine_added") > 20);
  CHECK(said.at("refine_incomplete") == 0);
  // Areas of regions are the L's.
  session.good("batch many/ell.poly --refine 20 --region-areas --domain outer --verify" + formats);
  session.good("triangulate many/ell.poly --refine 20 --region-areas --domain outer -o ell.ele --quiet");
  session.run("cmp ell.ele out/ell.ele && rm -r out");
  const Outcome limited =
      session.gcdt("batch many --refine 20 --max-area 0.01 --max-vertices 10 --stats s.json -o out");
  CHECK(limited.status == 0);
  CHECK(contains(limited.err, "many/ell.poly: the limit of added vertices ended the refinement"));
  CHECK(nlohmann::json::parse(session.read("s.json")).at("refine_incomplete") == 2);
  CHECK(contains(session.gcdt("batch many --refine 20 --max-area 0.01 --max-vertices 10").out,
                 "refined       20 vertices added (2 inputs ended by the limit)"));
  for (const char* options : {"--refine 40", "--max-area 1", "--refine 20 --verify --crossing split"})
    session.bad(2, std::string("batch many -o out ") + options);
}

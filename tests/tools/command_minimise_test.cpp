// SPDX-License-Identifier: Apache-2.0
// gcdt minimise: what is written is small, and fails as the input did.
#include "command_session.hpp"

using namespace gcdt::testing;

TEST_CASE("of two hundred vertices the four of the one crossing are left, at small integers") {
  const Session session;
  std::string text = "204 2 0 0\n";
  for (int i = 0; i < 200; ++i)
    text += std::to_string(i) + " " + std::to_string(i * 37 % 211) + ".5 " + std::to_string(i * 53 % 199 + 300) + "\n";
  text += "200 0 0\n201 70.25 70\n202 0 70\n203 70 0\n41 0\n";
  for (int i = 0; i < 39; ++i) text += std::to_string(i) + " " + std::to_string(i) + " " + std::to_string(i) + "\n";
  session.write("big.poly", text + "39 200 201\n40 202 203\n1\n0 1 1\n");
  const std::string said = session.good("minimise big.poly -o small.poly");
  CHECK(contains(said, "4 of 204 vertices, 2 of 41 constraints; the check fails as before (status 3)"));
  CHECK(session.gcdt("triangulate small.poly").status == 3);
  // Nothing but 0 and 1 is needed for a crossing, and no hole.
  const std::string small = session.read("small.poly");
  CHECK(small.size() < 80);
  CHECK(contains(small, "4 2 0 0\n"));
  CHECK(!contains(small, ".5"));
  CHECK(contains(session.shell("\"$gcdt\" triangulate small.poly").err, "1 pair of constraints crosses"));
  CHECK(small.substr(small.size() - 2) == "0\n");
}

TEST_CASE("the check is any command: where {} stands, or last; it is quoted") {
  const Session session;
  session.write("a b.poly",
                "5 2 1 1\n1 9 9 5 1\n2 0 0 5 1\n3 100 0 5 1\n4 777 3 5 1\n5 1 1 5 1\n2 1\n1 1 2 4\n2 2 3 4\n0\n");
  // The candidate has this number somewhere.
  for (const char* check : {"! grep -q 777 {}", "! grep -q 777", "! cat {} | grep -q 777"}) {
    CAPTURE(check);
    session.good(std::string("minimise --quiet 'a b.poly' -o o.poly --check '") + check + "'");
    CHECK(session.read("o.poly") == "1 2 0 0\n0 777 0\n0 0\n0\n");
  }
  // Attributes and markers stay where the check wants them.
  session.good("minimise --quiet 'a b.poly' -o o.poly --check '! grep -q \" 5 1$\" {}'");
  CHECK(session.read("o.poly") == "1 2 1 1\n0 0 0 5 1\n0 0\n0\n");
}

TEST_CASE("a failure does not turn into another one") {
  const Session session;
  session.write("in.poly", square);
  // 7 with all four vertices, another status with fewer.
  const std::string check = "--check 'test $(head -c 1 {}) = 4 && exit 7; test $(head -c 1 {}) = 3 && exit 8; exit 0'";
  CHECK(contains(session.good("minimise in.poly -o o.poly " + check), "4 of 4 vertices, 0 of 1 constraints"));
}

TEST_CASE("checks that take too long fail in their own way, and what they started ends with them") {
  const Session session;
  session.write("in.poly", square);
  const std::string said =
      session.good("minimise in.poly -o o.poly --seconds 0.5 --check 'grep -q \"1 0$\" {} && sleep 98765; true'");
  CHECK(contains(said, "it takes too long"));
  CHECK(contains(session.read("o.poly"), "1 0\n"));
  CHECK(session.shell("pgrep -f '^sleep 98765$'").status == 1);
}

TEST_CASE("what is no failure, no input, or no place for the output is said") {
  const Session session;
  session.write("in.poly", square);
  CHECK(contains(session.bad(3, "minimise in.poly -o o.poly"), "in.poly: the check does not fail"));
  CHECK(contains(session.bad(3, "minimise none.poly -o o.poly"), "none.poly: cannot be opened"));
  CHECK(contains(session.bad(2, "minimise in.poly -o o.ele"), "is written as .poly"));
  CHECK(contains(session.bad(2, "minimise in.poly -o in.poly"), "is an input"));
  CHECK(contains(session.bad(2, "minimise in.poly -o o.poly --check false --crossing drop"), "excludes"));
  CHECK(contains(session.bad(2, "minimise in.poly -o o.poly --seconds nan"), "--seconds must be above 0"));
  CHECK(contains(session.bad(2, "minimise in.poly -o o.poly --checks -1"), "--checks"));
  CHECK(session.names() == std::vector<std::string>{"in.poly"});
  // Few checks: what was found by then.
  CHECK(contains(session.good("minimise in.poly -o o.poly --checks 2 --check false"),
                 "which are all that --checks allows"));
}

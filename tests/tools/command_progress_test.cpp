// SPDX-License-Identifier: Apache-2.0
// The command while it runs: interrupts, progress, traces.
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <map>
#include <set>
#include <thread>

#include "command_session.hpp"

using namespace gcdt::testing;

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

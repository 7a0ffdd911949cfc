// SPDX-License-Identifier: Apache-2.0
// What shells and man are told of the command, and how devices are measured.
#include "command_session.hpp"

using namespace gcdt::testing;

namespace {

const std::vector<std::string> commands = {"triangulate", "batch",   "verify", "locate",   "raster",
                                           "view",        "devices", "bench",  "minimise", "completion"};

/// What bash offers for the last of these words.
std::string offered(const Session& session, const std::string& words, int number) {
  // Outside of a completion there is no compopt.
  session.write("ask.sh", "compopt() { :; }\neval \"$(\"$1\" completion bash)\"\nCOMP_WORDS=(" + words +
                              ")\nCOMP_CWORD=" + std::to_string(number) + "\n_gcdt\necho \"${COMPREPLY[*]}\"\n");
  const Outcome outcome = session.shell("bash ask.sh \"$gcdt\"");
  CHECK(outcome.err == "");
  return outcome.out;
}

/// The long options that --help shows.
std::vector<std::string> options_of(const Session& session, const std::string& command) {
  const std::string help = session.good(command + " --help");
  std::vector<std::string> options;
  for (std::size_t at = help.find("--"); at != std::string::npos; at = help.find("--", at + 2)) {
    const std::size_t end = help.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at);
    if (at > 0 && (help[at - 1] == ' ' || help[at - 1] == ',')) options.push_back(help.substr(at, end - at));
  }
  return options;
}

std::string without(std::string text, char drop) {
  text.erase(std::remove(text.begin(), text.end(), drop), text.end());
  return text;
}

}  // namespace

TEST_CASE("bash completes commands, options, and values that are known") {
  Session session;
  CHECK(offered(session, "gcdt tri", 1) == "triangulate\n");
  CHECK(offered(session, "gcdt triangulate --cro", 2) == "--crossing\n");
  CHECK(offered(session, "gcdt triangulate --crossing ''", 3) == "reject drop split\n");
  CHECK(offered(session, "gcdt triangulate in.poly --domain outer", 4) == "outer outer-holes\n");
  CHECK(offered(session, "gcdt raster --no", 2) == "--no-data\n");
  CHECK(offered(session, "gcdt triangulate --device ''", 3) == "auto cpu gpu all\n");
  CHECK(offered(session, "gcdt locate --device ''", 3) == "auto cpu gpu\n");
  CHECK(offered(session, "gcdt completion f", 2) == "fish\n");
  // Files are offered where files are due, and nothing where a number is.
  session.write("map.poly", "");
  CHECK(offered(session, "gcdt triangulate ma", 2) == "map.poly\n");
  CHECK(offered(session, "gcdt triangulate -o ma", 3) == "map.poly\n");
  CHECK(offered(session, "gcdt triangulate --spill ''", 3) == "ask.sh map.poly\n");
  CHECK(offered(session, "gcdt triangulate --max-area ''", 3) == "\n");
  CHECK(offered(session, "gcdt bench ''", 2) == "-h --help --device --seconds --vertices\n");
}

TEST_CASE("every shell and the man page know all commands and all their options") {
  Session session;
  const std::string fish = session.good("completion fish"), zsh = session.good("completion zsh");
  const std::string bash = session.good("completion bash"), man = without(session.good("completion man"), '\\');
  for (const std::string& command : commands) {
    CAPTURE(command);
    CHECK(contains(fish, "-f -a " + command + " "));
    CHECK(contains(zsh, "    '" + command + ":"));
    CHECK(contains(bash, "\n    " + command + ")\n      words="));
    CHECK(contains(man, "\n.SH " + command + "\n"));
    for (const std::string& option : options_of(session, command)) {
      CAPTURE(option);
      CHECK(contains(fish, " -l " + option.substr(2) + " "));
      CHECK(contains(zsh, "'*" + option + "["));
      CHECK(contains(bash, option));
      CHECK(contains(man, option));
    }
  }
  // Texts end whole, and are quoted as each shell does.
  CHECK(contains(zsh, "'*--regions[Find region, depth and winding number of each triangle]'"));
  CHECK(contains(zsh, "[The largest areas are those of the input'\\''s regions, where they have one]'"));
  CHECK(contains(fish, "'The largest areas are those of the input\\'s regions, where they have one'"));
  session.bad(2, "completion tcsh");
}

TEST_CASE("devices are measured, and the one that auto is is named") {
  Session session;
  const std::string all = session.good("bench --seconds 0 --vertices 200");
  CHECK(contains(all, "200 vertices in a square, 100 short constraints"));
  CHECK(contains(all, "device 0: "));
  CHECK(contains(all, "auto picks device "));
  CHECK(contains(session.good("bench --seconds 0 --vertices 200 --device 0"), "of 3 calls"));
  session.bad(2, "bench --vertices 0");
  session.bad(2, "bench --seconds nan");
  CHECK(session.gcdt("bench --device no-such-device").status == 4);
}

// SPDX-License-Identifier: Apache-2.0
// Each call by which the command changes files fails, the disk is full from there on, or the command is killed there
// (file_faults.c): no output is half written, what stood there before is kept, nothing else is left, and the error
// names a file. GCDT_FILE_STEP says which calls: 1, each in each way, as `scripts/slow.sh files` does; N, every N-th,
// in one of the ways by turns.
#include <map>

#include "command_session.hpp"

using namespace gcdt::testing;
namespace fs = std::filesystem;

namespace {

using Files = std::map<std::string, std::string>;  ///< bytes by path

/// Hidden ones are what a process that was killed leaves, and are counted elsewhere.
Files files_in(const Session& session, bool hidden) {
  Files files;
  const fs::path folder = session / "";
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    const bool is_hidden = entry.path().filename().string()[0] == '.';
    if (entry.is_regular_file() && (hidden || !is_hidden)) files[name] = session.read(name);
  }
  return files;
}

void restore(const Session& session, const Files& files) {
  for (const std::string& name : session.names()) fs::remove_all(session / name);
  for (const auto& [name, bytes] : files) {
    fs::create_directories(fs::path(session / name).parent_path());
    session.write(name, bytes);
  }
}

struct Call {
  const char* arguments;
  std::vector<const char*> targets;  ///< some of them, which are there before
  bool each_alone = false;           ///< a file may be new where another one could not be written
};

struct Campaign {
  Session session;
  Call call;
  Files before, after;
  int tried = 0, failed = 0;

  explicit Campaign(Call of) : call(std::move(of)) {
    session.write("in.poly", framed());
    session.write("other.poly", square);
    session.write("heights.poly", "4 2 1 0\n0 0 0 1\n1 3 0 2\n2 3 3 4\n3 0 3 8\n0 0\n0\n");
    session.write("points.csv", "1,1\n4.5,4.5\n");
    for (const char* target : call.targets) session.write(target, "what was there");
    before = files_in(session, true);
    session.run("\"$gcdt\" " + std::string(call.arguments) + " >/dev/null");
    after = files_in(session, true);
    for (const char* target : call.targets) CHECK(after[target] != "what was there");
  }

  /// False if the call number k is not reached.
  bool try_call(int k, const std::string& fault) {
    CAPTURE(std::string(call.arguments));
    CAPTURE(k);
    CAPTURE(fault);
    restore(session, before);
    const ScratchFolder marks;
    const std::string folder = fs::canonical(session / "").string();
    const Outcome outcome = session.shell(
        "GCDT_FILES='" + folder + "' GCDT_FILE_CALL=" + std::to_string(k) + " GCDT_FILE_FAULT=" + fault +
        " GCDT_FILE_MARK='" + marks / "reached" +
        "' ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD='" GCDT_FILE_FAULTS "' \"$gcdt\" " + call.arguments);
    CAPTURE(outcome.err);
    if (marks.names().empty()) {
      CHECK(outcome.status == 0);
      return false;
    }
    ++tried;
    if (fault == "kill")
      judge_killed(outcome);
    else
      judge_failed(outcome);
    return true;
  }

  void judge_failed(const Outcome& outcome) {
    const Files now = files_in(session, true);
    if (outcome.status == 0) {  // it was worked around
      CHECK(now == after);
      return;
    }
    ++failed;
    CHECK(outcome.status == 6);
    CHECK(outcome.err.compare(0, 6, "gcdt: ") == 0);
    CHECK(std::any_of(after.begin(), after.end(), [&](const auto& file) {  // or its folder
      return contains(outcome.err, file.first.substr(0, file.first.find('/')));
    }));
    if (!call.each_alone) CHECK(now == before);
    each_is_whole(now);
  }
  void judge_killed(const Outcome& outcome) {
    CHECK(outcome.status == 128 + SIGKILL);
    each_is_whole(files_in(session, false));
    session.run("\"$gcdt\" " + std::string(call.arguments) + " >/dev/null");
    CHECK(files_in(session, false) == after);
  }
  void each_is_whole(const Files& now) {
    for (const auto& [name, bytes] : now) {
      CAPTURE(name);
      const auto was = before.find(name), is = after.find(name);
      CHECK(((was != before.end() && bytes == was->second) || (is != after.end() && bytes == is->second)));
    }
    for (const auto& [name, bytes] : before) CHECK(now.count(name) == 1);
  }
};

}  // namespace

TEST_CASE("what the command writes is whole or not there, whatever call fails and wherever it is killed") {
  const std::vector<Call> calls = {
      {"triangulate in.poly -o o.ele -o o.vtu -o o.geojson --quiet", {"o.ele", "o.geojson"}},
      {"triangulate in.poly -o o.ele -o o.npz --refine 20 --quiet", {"o.ele"}},
      {"raster heights.poly -o o.asc -o o.png --cell 1 --quiet", {"o.asc"}},
      {"locate in.poly points.csv -o found.csv --quiet", {"found.csv"}},
      {"view in.poly -o page.html --quiet", {"page.html"}},
      {"batch in.poly other.poly -o out --format npz --quiet", {}, true},
  };
  const char* given = std::getenv("GCDT_FILE_STEP");
  const int step = given ? std::atoi(given) : 11;
  const std::vector<std::string> faults = {"fail", "full", "kill"};
  int tried = 0, failed = 0;
  for (const Call& call : calls) {
    Campaign campaign(call);
    if (step == 1) {
      for (const std::string& fault : faults)
        for (int k = 1; campaign.try_call(k, fault);) ++k;
    } else {
      for (int k = 1 + tried % step; campaign.try_call(k, faults[static_cast<std::size_t>(k) % 3]);) k += step;
    }
    tried += campaign.tried, failed += campaign.failed;
  }
  MESSAGE(tried << " calls broken, " << failed << " errors");
  CHECK(failed > 0);
}

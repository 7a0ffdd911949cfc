// SPDX-License-Identifier: Apache-2.0
// gcdt minimise: a smaller graph for which a check still fails. Parts are left out by delta debugging (Zeller and
// Hildebrandt, "Simplifying and isolating failure-inducing input", 2002): halves of a list first, then ever smaller
// chunks, so that a few parts out of n take some log n checks each. Every change is kept only if the check then fails
// as it did at first, so what is written fails, whatever the order of the attempts.
#include "minimise.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

#include "graph_file.hpp"
#include "io/paths.hpp"
#include "progress.hpp"

extern char** environ;

namespace gcdt::command {

namespace {

namespace fs = std::filesystem;
using io::Exit;
using io::Failure;

/// A folder for candidates; gone with the object.
class Folder {
 public:
  Folder() {
    std::string name = fs::temp_directory_path() / "gcdt-minimise-XXXXXX";
    if (!mkdtemp(name.data())) throw Failure(Exit::output, fmt::format("{}: {}", name, std::strerror(errno)));
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

/// In quotes, as one word of a shell.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// The command that is the check: the user's, or this very program.
std::string command_of(const MinimiseArguments& arguments, const std::string& candidate) {
  if (arguments.check.empty()) {
    std::error_code unknown;
    const fs::path self = fs::read_symlink("/proc/self/exe", unknown);
    std::string text = quoted(unknown ? "gcdt" : self.string()) + " triangulate --verify --quiet --crossing " +
                       arguments.crossing + " --domain " + arguments.domain;
    if (!arguments.grid.empty()) text += " --grid " + quoted(arguments.grid);
    if (!arguments.device.empty()) text += " --device " + quoted(arguments.device);
    return text + " " + quoted(candidate);
  }
  std::string text = arguments.check;
  const std::string mark = "{}", word = quoted(candidate);
  std::size_t at = text.find(mark);
  if (at == std::string::npos) return text + " " + word;
  for (; at != std::string::npos; at = text.find(mark, at + word.size())) text.replace(at, mark.size(), word);
  return text;
}

/// How a check ended: its status as a shell tells it (128 and the signal for a crash), or that it took too long.
constexpr int passed = 0, too_long = -1;

std::string described(int outcome) {
  return outcome == too_long ? "it takes too long"
         : outcome > 128     ? fmt::format("status {} (signal {})", outcome, outcome - 128)
                             : fmt::format("status {}", outcome);
}

/// Waits for a process, no longer than until `end`; then it and those that it started are killed.
int wait_for(pid_t process, std::chrono::steady_clock::time_point end) {
  auto nap = std::chrono::microseconds(200);
  for (int status = 0;;) {
    const pid_t done = waitpid(process, &status, WNOHANG);
    if (done == process) return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    const bool lost = done < 0 && errno != EINTR;
    if (lost || interrupted() || std::chrono::steady_clock::now() > end) {
      kill(-process, SIGKILL);
      waitpid(process, &status, 0);
      stop_if_interrupted();
      return too_long;
    }
    std::this_thread::sleep_for(nap);
    nap = std::min(2 * nap, std::chrono::microseconds(20000));
  }
}

/// Runs a shell in a process group of its own, so that all of it can be killed, with nothing to read and silent.
int run(const std::string& command, double seconds) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::string shell = "sh", option = "-c", text = command;
  char* words[] = {shell.data(), option.data(), text.data(), nullptr};
  pid_t process = 0;
  const int error = posix_spawn(&process, "/bin/sh", &actions, &attributes, words, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw Failure(Exit::usage, fmt::format("/bin/sh does not run: {}", std::strerror(error)));
  const auto limit =
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
  return wait_for(process, std::chrono::steady_clock::now() + limit);
}

class Minimiser {
 public:
  Minimiser(const MinimiseArguments& arguments, GraphFile graph)
      : arguments_(arguments), best_(std::move(graph)), line_(!arguments.quiet) {
    wanted_ = outcome_of(best_);
    if (wanted_ == passed) throw Failure(Exit::input, fmt::format("{}: the check does not fail", arguments.input));
  }

  /// Until nothing can be left out or made smaller, or the checks are used up.
  void minimise() {
    leave_out_extras();
    for (bool smaller = true; smaller && left();) {
      smaller = leave_out(best_.constraints.size(),
                          [](GraphFile& g, std::size_t i, std::size_t j) { g.erase_constraints(i, j); });
      smaller |= leave_out(best_.vertices.size(), [](GraphFile& g, std::size_t i, std::size_t j) { g.erase(i, j); });
      smaller |=
          leave_out(best_.holes.size(), [](GraphFile& g, std::size_t i, std::size_t j) { erase_from(g.holes, i, j); });
      smaller |= leave_out(best_.regions.size(),
                           [](GraphFile& g, std::size_t i, std::size_t j) { erase_from(g.regions, i, j); });
      smaller |= all_coordinates();
      smaller |= each_coordinate();
    }
    line_.clear();
  }

  const GraphFile& best() const { return best_; }
  int wanted() const { return wanted_; }
  std::uint64_t checks() const { return checks_; }
  bool left() const { return checks_ < arguments_.most_checks; }

 private:
  int outcome_of(const GraphFile& graph) {
    stop_if_interrupted();
    const std::string path = folder_ / "candidate.poly";
    write_graph(path, graph);
    ++checks_;
    return run(command_of(arguments_, path), arguments_.seconds);
  }

  /// Takes the candidate if it fails as the input did.
  bool take(GraphFile candidate) {
    if (!left()) return false;
    line_.show(
        fmt::format("{} vertices, {} constraints, {} checks;", best_.vertices.size(), best_.constraints.size(), checks_)
            .c_str(),
        static_cast<double>(checks_) / static_cast<double>(arguments_.most_checks));
    if (outcome_of(candidate) != wanted_) return false;
    best_ = std::move(candidate);
    return true;
  }

  /// What a check seldom looks at: attributes, markers.
  void leave_out_extras() {
    GraphFile plain = best_;
    plain.attribute_count = 0;
    plain.attributes.clear(), plain.vertex_markers.clear(), plain.constraint_markers.clear();
    take(std::move(plain));
  }

  /// Leaves out chunks of `count` parts, halves first. Each round of a size ends at the end of the list, sizes end at
  /// 1, and a round of size 1 is repeated only if it made the list shorter.
  template <class Erase>
  bool leave_out(std::size_t count, Erase&& erase) {
    bool any = false;
    for (std::size_t size = std::max<std::size_t>(1, (count + 1) / 2); count > 0 && left();) {
      bool shorter = false;
      for (std::size_t i = 0; i < count && left();) {
        const std::size_t j = std::min(i + size, count);
        GraphFile candidate = best_;
        erase(candidate, i, j);
        if (take(std::move(candidate)))
          count -= j - i, shorter = any = true;
        else
          i = j;
      }
      if (size == 1 && !shorter) break;
      size = std::min(std::max<std::size_t>(1, size / 2), std::max<std::size_t>(1, count));
    }
    return any;
  }

  template <class Change>
  GraphFile changed(Change&& change) const {
    GraphFile candidate = best_;
    for (auto& vertex : candidate.vertices)
      for (std::size_t axis = 0; axis < 2; ++axis) vertex[axis] = change(vertex[axis], axis);
    return candidate;
  }

  bool take_if_other(GraphFile candidate) { return candidate.vertices != best_.vertices && take(std::move(candidate)); }

  /// All at once: places replaced by their ranks, moved to 0, rounded to integers, halved.
  bool all_coordinates() {
    bool any = false;
    std::array<std::vector<double>, 2> sorted;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      for (const auto& vertex : best_.vertices) sorted[axis].push_back(vertex[axis]);
      std::sort(sorted[axis].begin(), sorted[axis].end());
      sorted[axis].erase(std::unique(sorted[axis].begin(), sorted[axis].end()), sorted[axis].end());
    }
    any |= take_if_other(changed([&](double c, std::size_t axis) {
      return static_cast<double>(std::lower_bound(sorted[axis].begin(), sorted[axis].end(), c) - sorted[axis].begin());
    }));
    if (any || best_.vertices.empty()) return any;
    any |= take_if_other(changed([&](double c, std::size_t axis) { return c - sorted[axis][0]; }));
    any |= take_if_other(changed([](double c, std::size_t) { return std::trunc(c); }));
    while (left() && take_if_other(changed([](double c, std::size_t) { return std::trunc(c / 2); }))) any = true;
    return any;
  }

  /// One by one: 0, the integer, half, one less. Each is of lesser magnitude or has fewer digits, so this ends.
  bool each_coordinate() {
    bool any = false;
    for (std::size_t v = 0; v < best_.vertices.size(); ++v)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const double c = best_.vertices[v][axis];
        for (const double lesser : {0.0, std::trunc(c), std::trunc(c / 2), c - std::copysign(1.0, c)}) {
          if (lesser == c || !(std::abs(lesser) <= std::abs(c)) || !left()) continue;
          GraphFile candidate = best_;
          candidate.vertices[v][axis] = lesser;
          if (!take(std::move(candidate))) continue;
          any = true;
          break;
        }
      }
    return any;
  }

  const MinimiseArguments& arguments_;
  const Folder folder_;
  GraphFile best_;
  int wanted_ = passed;
  std::uint64_t checks_ = 0;
  ProgressLine line_;
};

}  // namespace

void minimise(const MinimiseArguments& arguments) {
  if (io::lower_extension(arguments.output) != ".poly")
    throw Failure(Exit::usage, fmt::format("{}: what is left is written as .poly", arguments.output));
  if (!(arguments.seconds > 0)) throw Failure(Exit::usage, "--seconds must be above 0");
  if (arguments.input != "-" && io::same_file(arguments.input, arguments.output))
    throw Failure(Exit::usage, fmt::format("{}: is an input, and cannot be an output", arguments.output));
  const io::Input input = io::read_input(arguments.input);
  Minimiser minimiser(arguments, graph_of(input));
  minimiser.minimise();
  const GraphFile& best = minimiser.best();
  write_graph(arguments.output, best);
  if (arguments.quiet) return;
  print(fmt::format("{} of {} vertices, {} of {} constraints; the check fails as before ({}); {} checks{}\n",
                    best.vertices.size(), input.vertices.size(), best.constraints.size(), input.constraints.size(),
                    described(minimiser.wanted()), minimiser.checks(),
                    minimiser.left() ? "" : ", which are all that --checks allows: there may be a smaller one"));
}

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
// Runs code in a child process in which a call that changes files fails, or is the last (file_faults.c, which is linked
// into the test). A test that uses OpenCL does so in children alone: what was started before is not there in a child.
#pragma once

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>

#include "scratch_folder.hpp"

namespace gcdt::testing {

/// How a child ended.
struct Ended {
  bool killed = false, reached = false;  ///< reached: the call that was to fail was made
  std::string error;                     ///< of what it threw; empty: it did not
};

/// A child process under way.
class Child {
 public:
  explicit Child(const std::function<void()>& use) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    number_ = fork();
    REQUIRE(number_ >= 0);
    if (number_ == 0) {
      close(ends[0]);
      run(use, ends[1]);
    }
    close(ends[1]);
    said_ = ends[0];
  }
  Child(const Child&) = delete;
  ~Child() {
    if (number_ > 0) kill(), wait();
  }
  void kill() const { ::kill(number_, SIGKILL); }
  Ended wait() {
    Ended ended;
    char part[512];
    for (ssize_t count; (count = read(said_, part, sizeof part)) > 0;)
      ended.error.append(part, static_cast<std::size_t>(count));
    close(said_);
    int status = 0;
    REQUIRE(waitpid(number_, &status, 0) == number_);
    number_ = 0;
    ended.killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    if (!ended.killed && (!WIFEXITED(status) || WEXITSTATUS(status) != 0)) ended.error += " (the child crashed)";
    return ended;
  }

 private:
  [[noreturn]] static void run(const std::function<void()>& use, int said) {
    alarm(240);  // one that hangs has crashed
    std::string error;
    try {
      use();
    } catch (const std::exception& thrown) {
      error = thrown.what();
    }
    const bool written = ::write(said, error.data(), error.size()) == static_cast<ssize_t>(error.size());
    _exit(written ? 0 : 1);  // destructors of statics are the parent's
  }
  pid_t number_ = 0;
  int said_ = -1;
};

/// Runs `use` while call number `call` of those that change files in `folder` ends as `fault` says.
inline Ended with_fault(const ScratchFolder& folder, const std::string& fault, unsigned call,
                        const std::function<void()>& use) {
  const ScratchFolder marks;
  Child child([&] {
    setenv("GCDT_FILES", std::filesystem::canonical(folder / "").parent_path().c_str(), 1);
    setenv("GCDT_FILE_CALL", std::to_string(call).c_str(), 1);
    setenv("GCDT_FILE_FAULT", fault.c_str(), 1);
    setenv("GCDT_FILE_MARK", (marks / "reached").c_str(), 1);
    use();
  });
  Ended ended = child.wait();
  ended.reached = !marks.names().empty();
  return ended;
}

/// Goes through all calls of `use`; `prepare` comes before each, `judge` after. Returns how many there are.
inline unsigned for_each_call(const ScratchFolder& folder, const std::string& fault,
                              const std::function<void()>& prepare, const std::function<void()>& use,
                              const std::function<void(const Ended&)>& judge) {
  for (unsigned call = 1;; ++call) {
    CAPTURE(fault);
    CAPTURE(call);
    prepare();
    const Ended ended = with_fault(folder, fault, call, use);
    CAPTURE(ended.error);
    if (!ended.reached) {
      CHECK(!ended.killed);
      CHECK(ended.error == "");
      return call - 1;
    }
    CHECK(ended.killed == (fault == "kill"));
    judge(ended);
    REQUIRE(call < 1000);
  }
}

}  // namespace gcdt::testing

// SPDX-License-Identifier: Apache-2.0
// Goes through the OpenCL calls of a run and makes each fail: the call is an Error that says so, or was worked around;
// nothing leaks; and the same object gives the right bytes afterwards, or says that it is of no use and another does.
//   GCDT_FAULT_STEP=1     each call with each of its errors; N: every N-th with one of them, another each time
//   GCDT_FAULT_FIRST=K    from which call on
//   GCDT_FAULT_SHARD=I/N  of these faults one in N, others for each I from 0 to N - 1: processes share the work
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include <gcdt/types.hpp>

#include "call_layer.hpp"

namespace gcdt::test {

/// The state of the layer in the file GCDT_CALL_LAYER, which has been loaded.
Calls& calls();

inline std::uint64_t from_environment(const char* variable, std::uint64_t usual) {
  const char* given = std::getenv(variable);
  return given ? std::strtoull(given, nullptr, 10) : usual;
}

/// Whether the fault is one of this process's: by its name, so that processes agree whose it is though their calls
/// differ.
inline bool of_this_process(const Fault& fault) {
  const char* given = std::getenv("GCDT_FAULT_SHARD");
  if (!given) return true;
  char* slash = nullptr;
  const std::uint64_t own = std::strtoull(given, &slash, 10);
  const std::uint64_t all = *slash == '/' ? std::strtoull(slash + 1, nullptr, 10) : 0;
  if (own >= all) throw std::runtime_error("GCDT_FAULT_SHARD is not I/N with I below N");
  std::uint64_t digest = 0xcbf29ce484222325;
  for (const char c : fault.function + "/" + std::to_string(fault.occurrence) + "/" + std::to_string(fault.error))
    digest = (digest ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  digest = (digest ^ digest >> 33) * 0xff51afd7ed558ccd;  // so that any number of bits at its end is spread evenly
  return (digest ^ digest >> 33) % all == own;
}

/// Calls an object, and returns a hash of all that came out. The object lives as long.
using Run = std::function<std::uint64_t()>;
struct Opened {
  Run run;
  std::function<bool()> has_lost = [] { return false; };  ///< devices
};
/// Makes an object.
using Open = std::function<Opened()>;

/// What an entry point may do when a call fails.
struct Rules {
  /// Functions; "all": other devices do the work. A launch whose time is not told costs a phase its time, nowhere the
  /// call its result.
  std::set<std::string> worked_around;
  bool threads = false;  ///< calls are not the same each time
  bool lost = false;     ///< the object may be of no use afterwards, and says so
};

/// How a run went while calls failed.
struct Went {
  std::optional<std::uint64_t> hash;
  std::optional<Error> error;
};

inline Went go(const Run& run) {
  try {
    return {run(), {}};
  } catch (const Error& error) {
    return {{}, error};
  }
}

inline bool is_clear(const Error& error) {
  const bool status = error.status() == Status::device_failed || error.status() == Status::out_of_memory ||
                      error.status() == Status::no_device;
  return status && std::string(error.what()).size() > 20;
}

/// Goes through the calls of one entry point.
class Campaign {
 public:
  Campaign(Open open, Rules rules) : open_(std::move(open)), rules_(std::move(rules)), before_(calls().held()) {
    object_ = open_();
    expected_ = object_.run();
    REQUIRE(object_.run() == expected_);
    note_calls();
    held_ = calls().held();
    REQUIRE(all_.size() > 0);
  }

  void run(std::uint64_t step) {
    std::map<std::string, std::uint64_t> occurred;
    const std::uint64_t first = from_environment("GCDT_FAULT_FIRST", 1);
    std::uint32_t turn = 0;
    for (std::uint64_t k = 1; k <= all_.size(); ++k) {
      const auto [function, errors] = all_[k - 1];
      Fault fault{function, ++occurred[function], 0, false};
      if (k < first || (k - first) % step != 0) continue;
      for (std::uint32_t e = 0; e < (step == 1 ? errors : 1); ++e, ++turn) {
        fault.error = step == 1 ? e : turn % errors;
        fault.lasting = (step == 1 ? fault.occurrence + e : turn) % 5 == 4;
        if (of_this_process(fault)) fail(fault);
      }
    }
    object_ = {};
    CHECK_MESSAGE(calls().held() == before_, calls().held().text());
    MESSAGE(all_.size() << " calls, " << documented() << " errors of them, " << errors_ + around_ << " made to fail, "
                        << errors_ << " errors, " << around_ << " worked around, " << missed_ << " not made again");
    CHECK((errors_ + around_ > 0 || std::getenv("GCDT_FAULT_SHARD")));
  }

 private:
  // Of threads two may do the same job: the shortest of some runs has what all of them have.
  void note_calls() {
    for (int i = 0; i < (rules_.threads ? 10 : 1); ++i) {
      if (i % 2 == 1) open_again();
      calls().begin();
      REQUIRE(object_.run() == expected_);
      const std::vector<Called> run = without_asking_again(calls().end());
      if (i == 0 || run.size() < all_.size()) all_ = run;
    }
  }

  // Whoever shares a context asks until an event is there, and then waits for it: as often as that it asks first.
  static std::vector<Called> without_asking_again(std::vector<Called> run) {
    const auto is = [](const char* name) {
      return [=](const Called& call) { return call.function == std::string(name); };
    };
    const auto waits = std::count_if(run.begin(), run.end(), is("clWaitForEvents"));
    std::int64_t asked = 0;
    const auto again = [&](const Called& call) { return is("clGetEventInfo")(call) && ++asked > waits; };
    run.erase(std::remove_if(run.begin(), run.end(), again), run.end());
    return run;
  }

  std::uint64_t documented() const {
    std::uint64_t errors = 0;
    for (const Called& call : all_) errors += call.errors;
    return errors;
  }

  void fail(const Fault& fault) {
    const Went went = go_with(fault);
    const auto [function, code] = calls().failed();
    CAPTURE(fault.function);
    CAPTURE(fault.occurrence);
    CAPTURE(code);
    CAPTURE(fault.lasting);
    CAPTURE(std::string(went.error ? went.error->what() : ""));
    if (!rules_.threads) CHECK(function != nullptr);
    if (!function) ++missed_;
    if (went.hash) {
      around_ += function != nullptr;
      CHECK(*went.hash == expected_);
      const auto& may = rules_.worked_around;
      const bool time = function && std::string(function) == "clGetEventProfilingInfo";
      CHECK((!function || time || may.count("all") > 0 || may.count(function) > 0));
    } else {
      ++errors_;
      CHECK(function != nullptr);
      CHECK(is_clear(*went.error));
    }
    use_again();
  }

  // Threads may have no need of the call this time.
  Went go_with(const Fault& fault) {
    for (int left = rules_.threads ? 3 : 0;; --left) {
      calls().begin(fault);
      const Went went = go(object_.run);
      calls().end();
      if (calls().failed().first || left == 0) return went;
      CHECK(went.hash == expected_);
    }
  }

  void use_again() {
    const Went again = go(object_.run);
    if (again.hash) check_after(*again.hash);
    if (again.hash && !object_.has_lost()) return;
    CAPTURE(std::string(again.error ? again.error->what() : ""));
    CHECK(rules_.lost);
    open_again();
  }

  void open_again() {
    object_ = {};
    CHECK_MESSAGE(calls().held() == before_, calls().held().text());
    object_ = open_();
    CHECK(object_.run() == expected_);
  }

  /// Buffers are kept by size, and what a call did not reach it does not keep: they are counted when all is gone. So
  /// is what pools have, each of whose workers makes what its jobs need, which become smaller where memory is short.
  void check_after(std::uint64_t hash) {
    CHECK(hash == expected_);
    const Held held = calls().held();
    if (rules_.lost) return;
    for (const Kind kind : {Kind::context, Kind::queue, Kind::program, Kind::kernel, Kind::event})
      CHECK_MESSAGE(held.of(kind) <= held_.of(kind), std::string(kind_names[static_cast<std::size_t>(kind)]));
    CHECK(held.of(Kind::memory) <= held_.of(Kind::memory) + 8);
  }

  Open open_;
  Rules rules_;
  Held before_, held_;
  Opened object_;
  std::uint64_t expected_ = 0, errors_ = 0, around_ = 0, missed_ = 0;
  std::vector<Called> all_;
};

inline void campaign(std::uint64_t usual_step, const Open& open, Rules rules = {}) {
  for (const char* release : {"clReleaseContext", "clReleaseCommandQueue", "clReleaseMemObject", "clReleaseProgram",
                              "clReleaseKernel", "clReleaseEvent"})
    rules.worked_around.insert(release);
  Campaign(open, rules).run(from_environment("GCDT_FAULT_STEP", usual_step));
}

}  // namespace gcdt::test

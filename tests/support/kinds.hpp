// SPDX-License-Identifier: Apache-2.0
// Devices as what they are and as GPUs, for tests of phases that have a way of their own for each (docs/testing.md).
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "device_list.hpp"

namespace gcdt::test {

inline runtime::CallHook treated_as(DeviceKind kind) {
  runtime::CallHook hook;
  hook.tuning.kind = kind;
  return hook;
}

/// A device, treated as something.
struct Treated {
  std::string name;  ///< such as "rusticl as gpu"
  std::unique_ptr<runtime::Runtime> runtime;
};

/// PoCL and Mesa's llvmpipe, both as they are and as GPUs, and the machine's other devices. Fails without the two,
/// unless GCDT_TEST_DEVICE is set: whoever names a device, such as a GPU, takes what else the machine has.
inline std::vector<Treated>& devices_as_all_kinds() {
  static std::vector<Treated> all = [] {
    std::vector<Treated> made;
    bool threads = false, lanes = false;
    for (const cl::Device& device : every_device()) {
      auto usual = std::make_unique<runtime::Runtime>(device);
      const std::string platform = usual->info().platform;
      threads |= usual->kind() == DeviceKind::threads;
      lanes |= usual->kind() == DeviceKind::lanes;
      const bool gpu = usual->kind() == DeviceKind::gpu;
      made.push_back({platform + " as it is", std::move(usual)});
      if (!gpu)
        made.push_back({platform + " as gpu", std::make_unique<runtime::Runtime>(device, treated_as(DeviceKind::gpu))});
    }
    if (std::getenv("GCDT_TEST_DEVICE")) return made;
    REQUIRE_MESSAGE(threads, "no CPU whose work-items are loops of threads: install pocl-opencl-icd");
    REQUIRE_MESSAGE(lanes, "no CPU whose work-items are lanes of vectors: install mesa-opencl-icd");
    return made;
  }();
  return all;
}

/// Levels, groups, lists and patches of a few; stamps that run out; sweeps from the start; isolated vertices
/// everywhere.
inline Tuning small_thresholds() {
  Tuning tuning;
  tuning.coarsest_level = 8;
  tuning.isolation_margin = -4;
  tuning.times_evenly = tuning.least_row = 0;
  tuning.one_group_vertices = 16;
  tuning.one_group_edges = 32;
  tuning.least_sweep = 100;
  tuning.least_patched = 300;
  tuning.patch_vertices = 16;
  tuning.most_stamps = 3;
  tuning.rounds_of_group = 2;
  tuning.rows_read = 3, tuning.rows_folded = 4;
  tuning.most_ranked_by_count = tuning.most_by_teams = 16;
  tuning.curve_crossings = tuning.crossings_ahead = 0;
  tuning.least_existing = 0;
  return tuning;
}

/// Other choices of a runtime for its life.
class Tuned {
 public:
  Tuned(runtime::Runtime& runtime, const Tuning& tuning) : tuning_(runtime.tuning()), before_(tuning_) {
    tuning_ = tuning;
  }
  ~Tuned() { tuning_ = before_; }
  Tuned(const Tuned&) = delete;
  Tuned& operator=(const Tuned&) = delete;

 private:
  Tuning& tuning_;
  Tuning before_;
};

}  // namespace gcdt::test

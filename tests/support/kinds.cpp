// SPDX-License-Identifier: Apache-2.0
#include "kinds.hpp"

#include <cstdlib>

namespace gcdt::test {

runtime::CallHook treated_as(DeviceKind kind) {
  runtime::CallHook hook;
  hook.tuning.kind = kind;
  hook.tuning.states_one_group = kind == DeviceKind::gpu;  // as on NVIDIA's
  return hook;
}

std::vector<Treated>& devices_as_all_kinds() {
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

Tuning small_thresholds() {
  Tuning tuning;
  tuning.coarsest_level = 8;
  tuning.isolation_margin = -4;
  tuning.times_evenly = tuning.least_row = 0;
  tuning.one_group_vertices = 16;
  tuning.one_group_edges = 32;
  tuning.least_sweep = 100;
  tuning.least_patched = 300;
  tuning.patch_vertices = 16;
  tuning.least_divided = 1000;
  tuning.district_vertices = 24;
  tuning.most_stamps = 3;
  tuning.rounds_of_group = 2;
  tuning.rows_read = 3, tuning.rows_folded = 4;
  tuning.most_ranked_by_count = tuning.most_by_teams = 16;
  tuning.curve_crossings = tuning.crossings_ahead = tuning.crossings_gated = 0;
  tuning.least_existing = tuning.crossings_ordered = 0;
  tuning.least_grouped = 0, tuning.grouped_crossings = UINT32_MAX;
  return tuning;
}

}  // namespace gcdt::test

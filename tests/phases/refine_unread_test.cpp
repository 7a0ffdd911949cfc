// SPDX-License-Identifier: Apache-2.0
// Small rounds of refinement on GPUs: the host reads once a round, and what the last round did after the next one has
// looked for candidates. Where flips have left edges nothing may have been judged.
#include <doctest/doctest.h>

#include "kinds.hpp"
#include "refine_options.hpp"
#include "refine_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

std::vector<RefineCase> cases() {
  std::vector<RefineCase> all = {{"points", random_pslg(400, 1 << 20, 0, 11), refining_on_grid(28)},
                                 {"a grid of few cells", random_pslg(300, 1 << 11, 0, 5), refining_on_grid(20)},
                                 {"a dense border", on_integers(workload("dense_border", 400)), refining_on_grid()},
                                 {"inner constraints", random_pslg(120, 1 << 20, 60, 4), refining_on_grid(28)}};
  for (RefineCase& c : all) c.options.refine->most_added = 4000;
  return all;
}

/// The call's reads of device memory, and what it gives.
struct Counted {
  RefinedResult result;
  std::uint64_t reads = 0;
};

Counted refined(runtime::Runtime& runtime, const RefineCase& c) {
  const std::uint64_t before = runtime.read_backs();
  Counted counted;
  counted.result = result_of(runtime, c.work, c.options);
  counted.reads = runtime.read_backs() - before;
  return counted;
}

}  // namespace

TEST_CASE("the host reads once a round, and edges that flips have left are flipped before anything is judged") {
  std::size_t devices = 0, more = 0;
  for (Treated& device : devices_as_all_kinds()) {
    if (device.runtime->kind() != DeviceKind::gpu) continue;
    ++devices;
    for (const RefineCase& c : cases()) {
      CAPTURE(device.name);
      CAPTURE(c.name);
      const Counted usual = refined(*device.runtime, c);
      CHECK(mesh_fault(usual.result) == "");
      RefineCase plain = c;
      plain.options.refine->most_added = 0;  // the same reads but for rounds
      const std::uint64_t others = refined(*device.runtime, plain).reads;
      // A round that inserts, or finds nothing; and those whose flips one work-group has not ended.
      CHECK(usual.reads <= others + usual.result.refined.searches + 8);
      Tuning tuning = device.runtime->tuning();
      tuning.rounds_of_group = 1;
      const Tuned tuned(*device.runtime, tuning);
      const Counted once = refined(*device.runtime, c);
      more += once.reads > usual.reads + 4;
      CHECK(once.result.refined.rounds == usual.result.refined.rounds);
      CHECK(once.result.refined.searches == usual.result.refined.searches);
      CHECK(same(once.result, usual.result));
    }
  }
  CHECK(devices > 0);
  CHECK(more > 0);
}

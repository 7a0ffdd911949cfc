// SPDX-License-Identifier: Apache-2.0
// Rounds of refinement where a work-item is a thread: small ones by one work-item, and faces judged by the stars of new
// vertices (kernels/refine/tail.cl). Elsewhere each round is by launches, and all faces are gone through; both do the
// same, round by round.
#include <doctest/doctest.h>

#include "kinds.hpp"
#include "refine_options.hpp"
#include "refine_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// Points, outlines, and constraints with triangles on both sides, which vertices beside them bend.
std::vector<RefineCase> cases() {
  std::vector<RefineCase> all = {{"points", random_pslg(600, 1 << 20, 0, 7), refining_on_grid(25)},
                                 {"letters", on_integers(letters(400)), refining_on_grid()},
                                 {"inner constraints", random_pslg(120, 1 << 20, 60, 3), refining_on_grid(28)}};
  Options within = refining_on_grid();
  within.domain = Domain::even_odd;
  all.push_back({"letters within", on_integers(letters(400)), within});
  for (RefineCase& c : all) c.options.refine->most_added = 5000;
  Options limited = refining_on_grid(30);
  limited.refine->most_added = 37;
  all.push_back({"a limit", random_pslg(300, 1 << 20, 0, 9), limited});
  return all;
}

runtime::Runtime& of_kind(DeviceKind kind) {
  for (Treated& device : devices_as_all_kinds())
    if (device.runtime->kind() == kind) return *device.runtime;
  throw Error(Status::no_device, "no device of this kind");
}

/// Rounds of so many aims and so many a launch by one work-item, and stamps that run out.
Tuning small_rounds(std::uint32_t aims, std::uint32_t rounds, std::uint32_t stamps) {
  Tuning tuning;
  tuning.most_tail_aims = aims;
  tuning.rounds_of_tail = rounds;
  tuning.most_stamps = stamps;
  return tuning;
}

}  // namespace

TEST_CASE("rounds are the same by one work-item and by launches, wherever it stops") {
  runtime::Runtime& threads = of_kind(DeviceKind::threads);
  for (const RefineCase& c : cases()) {
    CAPTURE(c.name);
    const RefinedResult expected = result_of(of_kind(DeviceKind::gpu), c.work, c.options);
    CHECK(mesh_fault(expected) == "");
    CHECK(expected.refined.added >= 37);
    for (const std::uint32_t aims : {0u, 7u, 256u})
      for (const std::uint32_t rounds : {1u, 2u, 16u})
        for (const std::uint32_t stamps : {3u, 0xFFFFFFFFu}) {
          CAPTURE(aims);
          CAPTURE(rounds);
          CAPTURE(stamps);
          const Tuned tuned(threads, small_rounds(aims, rounds, stamps));
          const RefinedResult r = result_of(threads, c.work, c.options);
          CHECK(r.refined.rounds == expected.refined.rounds);
          CHECK(r.refined.searches == expected.refined.searches);
          CHECK(r.refined.aims == expected.refined.aims);
          CHECK(r.refined.candidates == expected.refined.candidates);
          CHECK(r.refined.complete == expected.refined.complete);
          CHECK(same(r, expected));
        }
  }
}

TEST_CASE("all faces are gone through once, and only where a change is not found by the new vertices again") {
  runtime::Runtime& threads = of_kind(DeviceKind::threads);
  for (const std::uint32_t aims : {0u, 256u}) {
    CAPTURE(aims);
    const Tuned tuned(threads, small_rounds(aims, 16, 0xFFFFFFFFu));
    const RefinedResult points = result_of(threads, random_pslg(2000, 1 << 22, 0, 5), refining_on_grid(25));
    CHECK(points.refined.rounds > 15);
    CHECK(points.refined.sweeps == 1);
    std::uint32_t more = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Options options = refining_on_grid(28);
      options.refine->most_added = 3000;
      const RefinedResult bent = result_of(threads, random_pslg(60, 1000, 60, seed), options);
      more += bent.refined.sweeps > 1;
      CHECK(bent.refined.sweeps <= bent.refined.rounds + 1);
    }
    CHECK(more > 0);
  }
}

TEST_CASE("a tour is the same where the queue is too small, and a cavity has more faces than its list") {
  runtime::CallHook hook;
  hook.options = "-DGCDT_TOUR_SIDES=4u -DGCDT_TOUR_FACES=3u";
  runtime::Runtime small(of_kind(DeviceKind::threads).device(), hook);
  for (const RefineCase& c : cases()) {
    CAPTURE(c.name);
    const RefinedResult expected = result_of(of_kind(DeviceKind::gpu), c.work, c.options);
    const RefinedResult r = result_of(small, c.work, c.options);
    CHECK(mesh_fault(r) == "");
    CHECK(r.refined.rounds == expected.refined.rounds);
    CHECK(r.refined.candidates == expected.refined.candidates);
    CHECK(same(r, expected));
  }
}

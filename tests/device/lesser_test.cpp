// SPDX-License-Identifier: Apache-2.0
// Devices that have less, pretended by a layer (tests/support/lesser_layer.cpp): without extensions, with small
// buffers, little local memory, and work-groups of 64 or of one. Bytes are the same; a problem too large for a buffer
// is an error.
#include <doctest/doctest.h>

#include <cstdlib>

#include "api/state.hpp"
#include "device_list.hpp"
#include "kinds.hpp"
#include "pool_cases.hpp"
#include "tuned_solver.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

const std::vector<const char*> pretensions = {"extensions", "buffer",  "local",
                                              "group=64",   "group=1", "extensions buffer local group=1"};

class Lesser {
 public:
  explicit Lesser(const char* words) { setenv("GCDT_LESSER", words, 1); }
  ~Lesser() { unsetenv("GCDT_LESSER"); }
  Lesser(const Lesser&) = delete;
  Lesser& operator=(const Lesser&) = delete;
};

Solver pocl_as(DeviceKind kind) {
  Tuning tuning = treated_as(kind).tuning;
  tuning.works_here = false;  // of the device all is asked
  return tuned_solver(DeviceKind::threads, tuning);
}

std::vector<std::pair<Workload, Options>> calls() {
  Options drop, split, domain, refined;
  drop.crossing = Crossing::drop, split.crossing = Crossing::split, domain.domain = Domain::even_odd;
  refined.refine = Refinement{};
  refined.refine->most_added = 300;
  return {{workload("uniform", 9000), {}},
          {workload("letters", 1000), {}},
          {workload("hub", 600), {}},
          {workload("nested_squares", 400), domain},
          {random_crossing(150, 1000, 60, 3), drop},
          {random_crossing(150, 1000, 60, 4), split},
          {random_pslg(80, 1000, 30, 5), refined}};
}

}  // namespace

TEST_CASE("the layer pretends") {
  const Lesser lesser("extensions buffer local group=7");
  const DeviceInfo info = pocl_as(DeviceKind::threads).device();
  CHECK(!info.atomics64);
  CHECK(!info.fp64);
  CHECK(!info.subgroups);
  CHECK(info.largest_buffer_bytes == 128u << 20);
  CHECK(info.local_bytes <= 32u << 10);
  CHECK(info.largest_work_group == 7);
}

TEST_CASE("devices with less give the same bytes, as threads and as GPUs") {
  Solver whole = pocl_as(DeviceKind::threads);
  for (const char* words : pretensions)
    for (const DeviceKind kind : {DeviceKind::threads, DeviceKind::gpu}) {
      const Lesser lesser(words);
      CAPTURE(std::string(words));
      Solver less = pocl_as(kind);
      for (const auto& [work, options] : calls()) {
        CAPTURE(work.points.size());
        CHECK(difference(less.triangulate(work.points, work.constraints, options),
                         whole.triangulate(work.points, work.constraints, options)) == "");
      }
    }
}

TEST_CASE("what needs a larger buffer than there is fails as it should, and the solver works on") {
  const Lesser lesser("buffer");
  Solver solver = pocl_as(DeviceKind::threads);
  const Workload large = workload("uniform", 5000000), small = workload("uniform", 1000);  // faces: 2 x 16 bytes, twice
  try {
    solver.solve(large.points);
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    CHECK(error.status() == Status::out_of_memory);
    CHECK(std::string(error.what()).find("134217728") != std::string::npos);
  }
  CHECK(solver.solve(small.points).triangle_count() > 1900);
}

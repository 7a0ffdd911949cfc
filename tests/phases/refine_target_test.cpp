// SPDX-License-Identifier: Apache-2.0
// Targets that rounding brings too near a vertex: with sides shorter than those that calls leave alone.
#include <doctest/doctest.h>

#include <algorithm>

#include "kinds.hpp"
#include "phases/refine.hpp"
#include "phases/relink.hpp"
#include "solve/triangulate.hpp"
#include "workloads.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

RefineResult refined_to_single_cells(runtime::Runtime& runtime, const Workload& work) {
  Primitives primitives(runtime);
  Options options;
  options.grid = FixedGrid{};
  DeviceTriangulation made =
      triangulate(runtime, primitives, source_of(runtime, work.points, work.constraints), options);
  RelinkedMesh relinked = relink(runtime, primitives, made.vertices, made.mesh);
  Subsegments subsegments = find_subsegments(runtime, made.vertices, relinked.mesh, made.pieces);
  Refiner refiner(runtime, primitives, refine_rules(34000000, 1), 4000, std::move(made.vertices),
                  std::move(relinked.mesh), std::move(subsegments), {}, {});
  refiner.keep(relinked.refs, {}, made.mesh.triangles);
  Ticker ticker;
  return refiner.run(ticker);
}

}  // namespace

TEST_CASE("they are given up, counted as that, and the refinement ends") {
  for (auto& [name, device] : devices_as_all_kinds()) {
    CAPTURE(name);
    std::uint64_t near = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const RefineResult done = refined_to_single_cells(*device, random_pslg(25, 40, 0, seed));
      CHECK(done.complete);
      CHECK(done.left[GCDT_LEFT_LIMIT] == 0);
      near += done.left[GCDT_LEFT_TARGET];
    }
    CHECK(near > 0);
  }
}

// SPDX-License-Identifier: Apache-2.0
// Gates (kernels/constrain/gates.h): what they say, when there are some, and that walks by them come to what walks by
// the mesh do.
#include "phases/gates.hpp"
#include "called.hpp"
#include "kept_hashes.hpp"
#include "phases/constrain.hpp"
#include "solver_fixture.hpp"
#include "staged.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

constexpr std::uint32_t always = 0, never = 0xFFFFFFFFu;

void check_gates(const fixture::HostMesh& m, const std::vector<cl_int4>& gates) {
  REQUIRE(gates.size() == m.edge_faces.size());
  std::size_t outer = 0, symbolic = 0;
  for (std::size_t side = 0; side < gates.size(); ++side) {
    const cl_uint ref = m.edge_faces[side];
    const auto after = static_cast<cl_uint>(gates[side].s[2]), before = static_cast<cl_uint>(gates[side].s[3]);
    if (ref == GCDT_NONE) {
      ++outer;
      CHECK(after == GCDT_NONE);
      CHECK(before == GCDT_NONE);
      continue;
    }
    const cl_uint face = GCDT_REF_FACE(ref), k = GCDT_REF_CORNER(ref), apex = m.corners[face].s[k];
    CHECK(after == m.sides[face].s[(k + 1) % 3]);
    CHECK(before == m.sides[face].s[(k + 2) % 3]);
    if (apex < m.n) {
      CHECK(gates[side].s[0] == m.points[apex][0]);
      CHECK(gates[side].s[1] == m.points[apex][1]);
    } else {
      ++symbolic;
      CHECK(gates[side].s[0] < 0);
      CHECK((static_cast<cl_uint>(gates[side].s[0]) & 0x7FFFFFFFu) == apex - m.n);
    }
  }
  CHECK(outer == 3);
  CHECK(symbolic >= 3);
}

CleanResult clean_all(fixture::Staged& made) {
  return made.cleaner.clean(made.walked(), made.cleaner.keep(made.plan, {}), made.counters);
}

/// A row of vertices between two far ones, which all of them have for neighbours, and a constraint between these.
void make_hubs(std::vector<fixture::Point>& points, std::vector<Constraint>& constraints) {
  constexpr std::int64_t length = 1000, y = 1 << 20;
  points = {{length + 1, y - length}, {length + 1, y + length}};
  for (std::int64_t i = 0; i < length; ++i) points.push_back({2 * i, y});
  constraints = {{0, 1}};
}

Called call_gated(runtime::Runtime& runtime, const Workload& work, std::uint32_t crossings_gated,
                  Crossing policy = Crossing::reject) {
  Tuning tuning = runtime.tuning();
  tuning.crossings_gated = crossings_gated;
  tuning.here_vertices = 0;  // where constraints are taken one after the other
  return call(runtime, work, tuning, policy);
}

}  // namespace

TEST_CASE("a gate says what the mesh says of the face behind an edge") {
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    for (const char* kind : {"tiny", "grid", "uniform", "corners", "collinear"})
      for (const std::uint32_t n : {1u, 3u, 40u, 500u}) {
        CAPTURE(kind);
        CAPTURE(n);
        fixture::MeshOnDevice made(*device.runtime, fixture::make_points(kind, n, 7), 8);
        made.insert_all(false);
        Gates gates = no_gates(*device.runtime);
        CHECK(!gates.made);
        make_gates(*device.runtime, made.vertices, made.mesh, gates);
        REQUIRE(gates.made);
        std::vector<cl_int4> read(gates.at.size());
        device.runtime->read(gates.at, read.data(), read.size());
        check_gates(made.now(), read);
      }
  }
}

TEST_CASE("gates take the room of the history, and are not made beside fans") {
  std::vector<fixture::Point> points, hubs;
  std::vector<Constraint> few = {{0, 1}}, between;
  for (std::int64_t i = 0; i < 900; ++i) points.push_back({(i * 7919) % 30011, (i * 104729) % 30013});
  make_hubs(hubs, between);
  for (Treated& device : devices_as_all_kinds()) {
    CAPTURE(device.name);
    runtime::Runtime& runtime = *device.runtime;
    for (const std::uint32_t gated : {always, never}) {
      CAPTURE(gated);
      fixture::Staged made(runtime, points, few);
      made.plan.crossings_gated = gated;
      CleanResult clean = clean_all(made);
      CHECK(made.history.gates.made == (gated == always));
      CHECK(made.history.top.allocated());
      // By lengths much seemed to be crossed, and was not: then the history stays until all is known to be right.
      made.plan.crossings_gated = never;
      REQUIRE(constrain(runtime, made.primitives, made.plan, made.vertices, made.mesh, made.history, clean.pieces,
                        made.counters)
                  .failed == 0);
      CHECK(fixture::marked_edges(made.now()) == fixture::expected_pieces(made.points, made.constraints));
    }
    // The hubs have all of the row around them once it is flipped, so that cleaning asks for fans.
    fixture::Staged made(runtime, hubs, between);
    made.flip();
    made.history = freeze_all(runtime, made.vertices, made.mesh, made.counters);
    made.plan.crossings_gated = always;
    CleanResult clean = clean_all(made);
    CHECK(made.history.fans.made);
    CHECK(!made.history.gates.made);
    clean = clean_all(made);  // with these fans
    CHECK(!made.history.gates.made);
    CHECK(fixture::read_pieces(runtime, clean.pieces) == fixture::expected_pieces(made.points, made.constraints));
  }
}

TEST_CASE("the result is the same with gates and without") {
  for (Treated& device : devices_as_all_kinds()) {
    runtime::Runtime& runtime = *device.runtime;
    CAPTURE(device.name);
    const std::size_t n = runtime.kind() == DeviceKind::lanes ? 1000 : 4000;
    std::uint64_t holes = 0;
    const auto compare = [&](const Workload& work) {
      const Called gated = call_gated(runtime, work, always), plain = call_gated(runtime, work, never);
      CHECK(plain.seen.error == "");
      CHECK(gated.seen == plain.seen);
      CHECK(gated.statistics.crossed_pairs == plain.statistics.crossed_pairs);
      CHECK(gated.statistics.cases.chain_vertices == plain.statistics.cases.chain_vertices);
      CHECK(gated.statistics.cases.holes == plain.statistics.cases.holes);
      holes += gated.statistics.cases.holes;
    };
    for (const char* name : {"sunray", "hub", "fan", "letters", "spiral", "star", "closed_comb", "two_clusters"}) {
      CAPTURE(name);
      compare(workload(name, n));
    }
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(seed);
      compare(random_pslg(300, seed % 2 == 0 ? 40 : 100000, 200, seed));
    }
    compare(make_workload(solver(), "synthetic_cons_6", 4000));
    CHECK(holes > 0);  // farthest cuts are asked for
  }
}

// Enforcing gives the history back, by which what crosses is looked for.
TEST_CASE("what crosses is found, dropped and split with gates, too") {
  for (Treated& device : devices_as_all_kinds()) {
    runtime::Runtime& runtime = *device.runtime;
    CAPTURE(device.name);
    for (std::uint64_t seed = 1; seed <= (runtime.kind() == DeviceKind::lanes ? 1 : 4); ++seed) {
      CAPTURE(seed);
      const Workload work = random_crossing(100, 1000, 60, seed);
      for (const Crossing policy : {Crossing::reject, Crossing::drop, Crossing::split}) {
        const Called gated = call_gated(runtime, work, always, policy);
        CHECK((gated.seen.error != "") == (policy == Crossing::reject));
        CHECK(gated.seen == call_gated(runtime, work, never, policy).seen);
      }
    }
  }
}

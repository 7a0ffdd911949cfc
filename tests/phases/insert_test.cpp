// SPDX-License-Identifier: Apache-2.0
// Postconditions of the insert and flip phases, on devices as what they are and as GPUs.
#include "phases/insert.hpp"
#include "kinds.hpp"
#include "mesh_fixture.hpp"
#include "phases/flip.hpp"
#include "phases/grow.hpp"
#include "reference.hpp"

using namespace fixture;

namespace {

struct Run {
  std::uint64_t insert_rounds = 0, flip_rounds = 0, flips = 0;
};

// CGAL's triangulation, ties by docs/contract.md, 4.
std::set<std::array<std::uint32_t, 3>> expected_faces(const std::vector<Point>& points) {
  std::set<std::array<std::uint32_t, 3>> faces;
  for (auto t : reference::reference_cdt(points, {})) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    faces.insert(t);
  }
  return faces;
}

// Inserts and flips level by level, proving the mesh after every step; at the end it is what CGAL makes.
Run triangulate(runtime::Runtime& runtime, std::vector<Point> points, std::uint32_t coarsest) {
  const Vertices vertices = upload(runtime, points, coarsest);
  const Plan plan = make_plan(runtime, vertices);
  Mesh mesh = make_mesh(runtime, vertices.n());
  const WorkLists lists = make_work_lists(runtime, vertices.n());
  History history = make_history(runtime, vertices.levels);
  PhaseCounters counters(runtime);
  Ticker ticker;
  insert_root(runtime, vertices, mesh);
  Run run;
  for (unsigned level = 0; level < vertices.levels.count; ++level) {
    const std::uint32_t now = vertices.levels.begin[level + 1];
    run.insert_rounds += insert_level(runtime, plan, vertices, mesh, history, lists, counters, level, ticker);
    CHECK(invalid_reason(download(runtime, mesh, points, now), now) == "");
    const FlipResult flipped = flip(runtime, plan, vertices, mesh, lists, counters, now, ticker);
    run.flip_rounds += flipped.rounds;
    run.flips += flipped.flips;
    const HostMesh after = download(runtime, mesh, points, now);
    CHECK(invalid_reason(after, now) == "");
    CHECK(illegal_edges(after) == 0);
    if (now == vertices.n()) CHECK(finite_faces(after) == expected_faces(points));
  }
  return run;
}

}  // namespace

TEST_CASE("every level leaves a valid mesh, flips leave no illegal edge, and the last one CGAL's triangulation") {
  for (test::Treated& device : test::devices_as_all_kinds())
    for (const char* kind : {"uniform", "grid", "collinear", "clusters", "corners", "parabola", "tiny"})
      for (std::uint32_t n : {0u, 1u, 2u, 3u, 4u, 10u, 100u, 1000u, 5000u}) {
        CAPTURE(kind);
        CAPTURE(n);
        CAPTURE(device.name);
        triangulate(*device.runtime, make_points(kind, n, 7), 64);
      }
}

TEST_CASE("the same with rounds that are all wide, all of one work-group, a few at a time, and stamps that run out") {
  for (test::Treated& device : test::devices_as_all_kinds())
    for (const std::uint32_t in_group : {0u, 0xFFFFFFFFu})
      for (const std::uint32_t stamps : {2u, 3u, 0xFFFFFFFFu}) {
        CAPTURE(device.name);
        CAPTURE(in_group);
        CAPTURE(stamps);
        Tuning tuning = device.runtime->tuning();
        tuning.one_group_vertices = tuning.one_group_edges = in_group;
        tuning.most_stamps = stamps;
        tuning.rounds_of_group = 3;
        const test::Tuned tuned(*device.runtime, tuning);
        for (const char* kind : {"uniform", "grid", "clusters", "tiny"}) {
          CAPTURE(kind);
          // In three levels: so that stamps run out.
          CHECK(triangulate(*device.runtime, make_points(kind, 600, 7), 64).insert_rounds > 6);
        }
      }
}

TEST_CASE("work-items beyond the edges of a small mesh claim with words that later claims are above") {
  runtime::CallHook hook;
  hook.tuning.width = 1000;
  int tried = 0;
  for (const cl::Device& device : devices_under_test()) {
    runtime::Runtime runtime(device, hook), other(device, hook);  // two, so that every launch is wide
    if (!runtime.contiguous()) continue;                          // others have no grow_insert
    ++tried;
    for (std::uint32_t n = 3; n < 40; ++n) {
      CAPTURE(n);
      std::vector<Point> points = make_points("uniform", n, 7);
      const Vertices vertices = upload(runtime, points, 64);
      Mesh mesh = make_mesh(runtime, vertices.n());
      const WorkLists lists = make_work_lists(runtime, vertices.n());
      PhaseCounters counters(runtime);
      Ticker ticker;
      grow(runtime, make_plan(runtime, vertices), vertices, mesh, lists, counters, vertices.n(), ticker);
      const HostMesh grown = download(runtime, mesh, points, vertices.n());
      CHECK(invalid_reason(grown, vertices.n()) == "");
      CHECK(illegal_edges(grown) == 0);
      std::vector<cl_uint4> records(2 * std::size_t{mesh.faces()});
      runtime.read(mesh.face_data, records.data(), records.size());
      cl_uint claimed = 0;
      for (std::uint32_t face = 0; face < mesh.faces(); ++face) {
        const cl_uint claim = records[GCDT_CORNERS(face)].s[3];
        claimed += claim > 0;
        CHECK(claim < mesh.claims_below);
      }
      CHECK(claimed > 0);
    }
  }
  CHECK(tried > 0);
}

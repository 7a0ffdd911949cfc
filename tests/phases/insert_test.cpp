// SPDX-License-Identifier: Apache-2.0
// Postconditions of the insert and flip phases, on devices as what they are and as GPUs.
#include "phases/insert.hpp"
#include "kinds.hpp"
#include "mesh_fixture.hpp"

using namespace fixture;

namespace {

struct Run {
  std::uint64_t insert_rounds = 0, flip_rounds = 0, flips = 0;
};

// Inserts and flips level by level, proving the mesh after every step; at the end it is what CGAL makes.
Run triangulate(runtime::Runtime& runtime, std::vector<Point> points, std::uint32_t coarsest) {
  MeshOnDevice made(runtime, std::move(points), coarsest);
  Run run;
  for (unsigned level = 0; level < made.levels(); ++level) {
    const std::uint32_t now = made.vertices_of(level);
    run.insert_rounds += made.insert(level);
    CHECK(invalid_reason(made.after(level), now) == "");
    const FlipResult flipped = made.flip(level);
    run.flip_rounds += flipped.rounds;
    run.flips += flipped.flips;
    const HostMesh after = made.after(level);
    CHECK(invalid_reason(after, now) == "");
    CHECK(illegal_edges(after) == 0);
    if (now == made.n()) CHECK(finite_faces(after) == expected_faces(made.points));
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

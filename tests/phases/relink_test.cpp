// SPDX-License-Identifier: Apache-2.0
// The mesh that is made of a result's triangles against the one that they were taken from, on every device as what it
// is and as a GPU.
#include "phases/relink.hpp"

#include <doctest/doctest.h>

#include "kinds.hpp"
#include "mesh_fixture.hpp"

using namespace fixture;
using gcdt::test::devices_as_all_kinds;

namespace {

/// All faces, symbolic ones too, each starting with its least vertex.
std::set<std::array<std::uint32_t, 3>> all_faces(const HostMesh& m) {
  std::set<std::array<std::uint32_t, 3>> all;
  for (const cl_uint4& f : m.corners) {
    std::array<std::uint32_t, 3> c = {f.s[0], f.s[1], f.s[2]};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    all.insert(c);
  }
  return all;
}

/// The triangles and the mesh made of them; a tenth of the edges is marked as constrained on the way.
void check_relinked(runtime::Runtime& runtime, const std::vector<Point>& points, bool canonical) {
  MeshOnDevice made(runtime, points, 8);
  made.insert_all(true);
  std::vector<cl_uint> marks(made.mesh.edges(), 0);
  for (std::size_t e = 0; e < marks.size(); e += 10) marks[e] = GCDT_MARK_CONSTRAINED;
  runtime.write(made.mesh.edge_marks, marks.data(), marks.size());
  Primitives primitives(runtime);
  Plan plan = made.plan;
  plan.output = Plan::By::all;
  const OrderedMesh ordered = order_triangles(runtime, primitives, plan, made.mesh, made.vertices, canonical);
  REQUIRE(ordered.triangles > 0);
  const RelinkedMesh again = relink(runtime, primitives, made.vertices, ordered);
  const HostMesh before = made.now(), after = download(runtime, again.mesh, made.points, made.n());
  REQUIRE(invalid_reason(after, made.n()) == "");
  CHECK(all_faces(after) == all_faces(before));
  std::set<std::array<std::uint32_t, 2>> marked, found;
  for (std::uint32_t e = 0; e < before.edges; ++e) {
    const auto ends = ends_of_edge(before, e);
    if (before.marks[e] != 0 && ends[1] < made.n()) marked.insert(ends);
    if (after.marks[e] != 0) found.insert(ends_of_edge(after, e));
  }
  CHECK(found == marked);
  std::vector<cl_uint> refs(ordered.triangles), corners(3 * std::size_t{ordered.triangles});
  runtime.read(again.refs, refs.data(), refs.size());
  runtime.read(ordered.corners, corners.data(), corners.size());
  std::size_t wrong = 0;
  for (std::size_t t = 0; t < refs.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      wrong += after.corners[refs[t] >> 2].s[((refs[t] & 3) + k) % 3] != corners[3 * t + k];
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("faces, edges, symbols, marks and references are those of the mesh that the triangles were taken from") {
  for (auto& [name, device] : devices_as_all_kinds()) {
    CAPTURE(name);
    for (const char* kind : {"uniform", "grid", "clusters", "corners", "parabola", "tiny"})
      for (const std::uint32_t n : {7u, 60u, 900u}) {
        CAPTURE(kind);
        CAPTURE(n);
        check_relinked(*device, make_points(kind, n, n), true);
        check_relinked(*device, make_points(kind, n, n), false);
      }
  }
}

TEST_CASE("hulls of three and four vertices, in every position to the symbols") {
  runtime::Runtime& runtime = *devices_as_all_kinds().front().runtime;
  const std::vector<Point> places = {{0, 0},
                                     {1, 0},
                                     {2, 0},
                                     {0, 1},
                                     {2, 1},
                                     {0, 2},
                                     {1, 2},
                                     {2, 2},
                                     {2147483647, 0},
                                     {0, 2147483647},
                                     {2147483647, 2147483647}};
  std::size_t tried = 0;
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = a + 1; b < places.size(); ++b)
      for (std::size_t c = b + 1; c < places.size(); ++c) {
        const Point p = places[a], q = places[b], r = places[c];
        if ((q[0] - p[0]) * (r[1] - p[1]) == (q[1] - p[1]) * (r[0] - p[0])) continue;
        ++tried;
        check_relinked(runtime, {p, q, r}, true);
        check_relinked(runtime, {p, q, r, {1, 1}}, true);
      }
  CHECK(tried > 100);
}

TEST_CASE("triangles that are not those of a hull are refused") {
  runtime::Runtime& runtime = *devices_as_all_kinds().front().runtime;
  MeshOnDevice made(runtime, make_points("uniform", 60, 1), 8);
  made.insert_all(true);
  Primitives primitives(runtime);
  Plan plan = made.plan;
  plan.output = Plan::By::all;
  OrderedMesh ordered = order_triangles(runtime, primitives, plan, made.mesh, made.vertices);
  --ordered.triangles;
  CHECK_THROWS_WITH_AS(relink(runtime, primitives, made.vertices, ordered), doctest::Contains("relink:"), Error);
}

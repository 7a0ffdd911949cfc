// SPDX-License-Identifier: Apache-2.0
// Vertices that go into a Delaunay mesh one after the other, in one sequence or in many side by side, and flips by the
// same work-items: every mesh against CGAL's, on CPUs whose work-items are threads' loops.
#include "phases/grow.hpp"
#include "constraint_oracle.hpp"
#include "faulty_device.hpp"
#include "forest_fixture.hpp"
#include "kinds.hpp"

using namespace fixture;

namespace {

runtime::Runtime& threads() {
  static const std::unique_ptr<runtime::Runtime> made = threads_runtime(runtime::Meshes::one);
  return *made;
}

GrowResult grow(MeshOnDevice& made, std::uint32_t end) {
  return gcdt::grow(made.runtime, made.plan, made.vertices, made.mesh, made.lists, made.counters, end, made.ticker);
}
GrowResult grow(MeshOnDevice& made) { return grow(made, made.n()); }

void fill_with_rubbish(const MeshOnDevice& made) {
  const Mesh& mesh = made.mesh;
  const std::vector<cl_uint4> faces(2 * std::size_t{mesh.faces()}, cl_uint4{{7, 7, 7, 0xFFFFFFFFu}});
  const std::vector<cl_uint> words(2 * std::size_t{mesh.edges()}, 3);
  made.runtime.write(mesh.face_data, faces.data(), faces.size());
  made.runtime.write(mesh.edge_faces, words.data(), words.size());
  made.runtime.write(mesh.edge_marks, words.data(), mesh.edges());
}

/// The mesh of the first vertices is CGAL's triangulation of them, and no edge is constrained or queued.
void check_delaunay(const HostMesh& m, std::uint32_t vertices, std::vector<Point> points) {
  REQUIRE(invalid_reason(m, vertices) == "");
  CHECK(illegal_edges(m) == 0);
  points.resize(vertices);
  CHECK(finite_faces(m) == expected_faces(points));
  CHECK(std::all_of(m.marks.begin(), m.marks.end(), [](cl_uint mark) { return mark == 0; }));
}

/// All vertices in one mesh that is not Delaunay, with about one in five finite edges constrained.
HostMesh constrain_some(const MeshOnDevice& made) {
  HostMesh m = made.now();
  Random random{5};
  for (std::uint32_t e = 0; e < m.edges; ++e) {
    const auto [u, v] = ends_of_edge(m, e);
    if (u < m.n && v < m.n && random.below(5) == 0) m.marks[e] |= GCDT_MARK_CONSTRAINED;
  }
  made.runtime.write(made.mesh.edge_marks, m.marks.data(), m.marks.size());
  return m;
}

std::vector<Constraint> as_constraints(const std::set<Constraint>& pieces) { return {pieces.begin(), pieces.end()}; }

}  // namespace

TEST_CASE("of any few vertices the mesh is CGAL's triangulation, whatever it held before") {
  for (const std::string kind : {"uniform", "grid", "collinear", "clusters", "corners", "parabola", "tiny"})
    for (const std::uint32_t n : {1u, 2u, 3u, 4u, 10u, 100u, 1000u, 5000u}) {
      CAPTURE(kind);
      CAPTURE(n);
      MeshOnDevice made(threads(), make_points(kind, n, 7), 64);
      fill_with_rubbish(made);
      grow(made);
      check_delaunay(made.now(), made.n(), made.points);
    }
}

TEST_CASE("so it is where many sequences meet, however often their stamps run out") {
  for (const std::uint32_t stamps : {2u, 0xFFFFFFFFu})
    for (const std::string kind : {"uniform", "grid", "clusters", "collinear"})
      for (const std::uint32_t shares : {2u, 5u, 64u}) {
        CAPTURE(stamps);
        CAPTURE(kind);
        CAPTURE(shares);
        Tuning tuning = threads().tuning();
        tuning.most_stamps = stamps;
        const test::Tuned tuned(threads(), tuning);
        MeshOnDevice made(threads(), make_points(kind, 12000, 11), 64);
        made.plan.grown_shares = shares;
        const GrowResult result = grow(made);
        CHECK(result.rounds > 2);  // two launches would do if no sequence met another
        check_delaunay(made.now(), made.n(), made.points);
      }
}

TEST_CASE("it ends with any level, and then has the vertices of the levels up to it") {
  MeshOnDevice made(threads(), make_points("uniform", 20000, 3), 8);
  REQUIRE(made.levels() > 4);
  for (unsigned level = made.levels(); level-- > 0;) {
    CAPTURE(level);
    grow(made, made.vertices_of(level));
    check_delaunay(made.after(level), made.vertices_of(level), made.points);
  }
}

TEST_CASE("the vertices that split edges are counted: on a line, those that come between two others") {
  MeshOnDevice made(threads(), make_points("collinear", 1000, 1), 64);  // in one sequence, by number
  std::uint64_t between = 0;
  for (auto v = made.points.begin(); v != made.points.end(); ++v) {
    const auto [least, greatest] = std::minmax_element(made.points.begin(), v);
    between += *least < *v && *v < *greatest;
  }
  REQUIRE(between > 0);
  CHECK(grow(made).edge_splits == between);
}

TEST_CASE("work-items beyond the edges of a small mesh claim with words that later claims are above") {
  runtime::CallHook hook;
  hook.tuning.width = 1000;
  // Two, so that every launch is wide.
  const auto runtime = threads_runtime(runtime::Meshes::one, hook), other = threads_runtime(runtime::Meshes::one, hook);
  for (std::uint32_t n = 3; n < 40; ++n) {
    CAPTURE(n);
    MeshOnDevice made(*runtime, make_points("uniform", n, 7), 64);
    grow(made);
    check_delaunay(made.now(), n, made.points);
    std::vector<cl_uint4> records(2 * std::size_t{made.mesh.faces()});
    runtime->read(made.mesh.face_data, records.data(), records.size());
    cl_uint claimed = 0;
    for (std::uint32_t face = 0; face < made.mesh.faces(); ++face) {
      const cl_uint claim = records[GCDT_CORNERS(face)].s[3];
      claimed += claim > 0;
      CHECK(claim < made.mesh.claims_below);
    }
    CHECK(claimed > 0);
  }
}

// As where others change faces meanwhile: then it may come into a face by another edge than it believes.
TEST_CASE("a walk that takes a face for the one that holds its vertex asks, and goes on") {
  const std::string asked = "if (oq < 0) {", taken = "if (left % 5u == 0u) arrived = true; else ";
  const auto misled = threads_runtime(runtime::Meshes::one, test::editing({{asked, taken + asked}}));
  for (const std::uint32_t shares : {1u, 5u}) {
    std::uint64_t steps[2];
    for (const bool is_misled : {false, true}) {
      MeshOnDevice made(is_misled ? *misled : threads(), make_points("uniform", 5000, 7), 64);
      made.plan.grown_shares = shares;
      steps[is_misled] = grow(made).steps;
      check_delaunay(made.now(), made.n(), made.points);
    }
    if (shares == 1) CHECK(steps[0] != steps[1]);  // it was misled: who asks anew may leave by another edge
  }
}

TEST_CASE("every problem of a forest is CGAL's triangulation of its own vertices") {
  const auto runtime = threads_runtime(runtime::Meshes::many);
  for (const std::uint64_t seed : {1u, 2u}) {
    std::vector<std::vector<Point>> problems = small_problems(seed);
    problems.push_back(make_points("uniform", 3000, seed));
    ForestOnDevice forest(*runtime, problems);
    forest.grow();
    const std::vector<HostMesh> meshes = forest.now();
    for (std::size_t p = 0; p < meshes.size(); ++p) {
      CAPTURE(p);
      check_delaunay(meshes[p], meshes[p].n, meshes[p].points);
    }
  }
}

// Without a limit around an edge grow_flip would not come back. What it leaves then is for the rounds behind it, which
// have a limit of their own.
TEST_CASE("flips that never end are given up around an edge, after as many as there are edges") {
  runtime::CallHook hook = test::editing({{"} else if (is_illegal(mesh, near, far)) {", "} else {"}});
  hook.tuning.width = 1;  // one work-item: the same flips each time
  const auto endless = threads_runtime(runtime::Meshes::one, hook);
  MeshOnDevice made(*endless, make_points("uniform", 30, 13), 30);
  made.insert(0);
  REQUIRE(illegal_edges(made.now()) > 0);
  const FlipResult result =
      grow_flip(*endless, made.plan, made.vertices, made.mesh, made.lists, made.counters, made.ticker);
  CHECK(result.flips >= made.mesh.edges());
}

TEST_CASE("flips make a mesh Delaunay but for its constrained edges, which stay, and leave no edge queued") {
  for (const std::uint32_t stamps : {2u, 0xFFFFFFFFu})
    for (const std::string kind : {"uniform", "grid", "clusters", "parabola"})
      for (const std::uint32_t n : {4u, 300u, 8000u}) {
        CAPTURE(stamps);
        CAPTURE(kind);
        CAPTURE(n);
        Tuning tuning = threads().tuning();
        tuning.most_stamps = stamps;
        const test::Tuned tuned(threads(), tuning);
        MeshOnDevice made(threads(), make_points(kind, n, 13), n);
        made.insert(0);
        const HostMesh before = constrain_some(made);
        REQUIRE((n < 300 || illegal_edges(before) > 0));
        const FlipResult result =
            grow_flip(threads(), made.plan, made.vertices, made.mesh, made.lists, made.counters, made.ticker);
        CHECK((result.flips > 0) == (illegal_edges(before) > 0));
        const HostMesh after = made.now();
        REQUIRE(invalid_reason(after, made.n()) == "");
        CHECK(illegal_edges(after) == 0);
        CHECK(marked_edges(after) == marked_edges(before));
        CHECK(finite_faces(after) == expected_faces(made.points, as_constraints(marked_edges(before))));
        CHECK(std::none_of(after.marks.begin(), after.marks.end(), [](cl_uint m) { return m & GCDT_MARK_QUEUED; }));
      }
}

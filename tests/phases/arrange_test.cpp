// SPDX-License-Identifier: Apache-2.0
// The canonical order of forests, problem by problem, against that of CGAL's triangulations, and the sort of each
// problem's keys against the standard library's, on CPUs whose work-items are threads' loops.
#include "forest_fixture.hpp"
#include "phases/output.hpp"

using namespace fixture;

namespace {

runtime::Runtime& threads() {
  static const std::unique_ptr<runtime::Runtime> made = threads_runtime(runtime::Meshes::many);
  return *made;
}

/// A result in host memory; triangles and vertices count through all problems.
struct Arranged {
  std::vector<std::uint32_t> first_triangle, corners;
  std::vector<std::int32_t> neighbours;
  std::vector<std::uint8_t> constrained;
};

Arranged arrange(ForestOnDevice& forest) {
  Primitives primitives(forest.runtime);
  const ArrangedForest made = arrange_problems(forest.runtime, primitives, forest.mesh, forest.vertices);
  Arranged all;
  all.first_triangle.resize(forest.roots() + 1);
  all.corners.resize(3 * std::size_t{made.mesh.triangles});
  all.neighbours.resize(all.corners.size());
  all.constrained.resize(made.mesh.triangles);
  forest.runtime.read(made.first_triangle, all.first_triangle.data(), all.first_triangle.size());
  forest.runtime.read(made.mesh.corners, all.corners.data(), all.corners.size());
  forest.runtime.read(made.mesh.neighbours, all.neighbours.data(), all.neighbours.size());
  forest.runtime.read(made.mesh.constrained, all.constrained.data(), all.constrained.size());
  return all;
}

/// docs/contract.md, 4 and 5, by CGAL: each problem's mesh under its constraints, which are edges of its own.
Arranged expected(const ForestOnDevice& forest, const std::vector<std::vector<Constraint>>& constraints) {
  Arranged all;
  for (cl_uint p = 0; p < forest.roots(); ++p) {
    const auto first = std::uint32_t(all.constrained.size());
    all.first_triangle.push_back(first);
    const reference::ReferenceMesh mesh = reference::reference_mesh(forest.problems[p], constraints[p]);
    for (const auto& corners : mesh.triangles)
      for (const std::uint32_t v : corners) all.corners.push_back(forest.begin[p] + v);
    for (const auto& across : mesh.neighbours)
      for (const std::int32_t t : across) all.neighbours.push_back(t < 0 ? t : std::int32_t(first) + t);
    all.constrained.insert(all.constrained.end(), mesh.constrained.begin(), mesh.constrained.end());
  }
  all.first_triangle.push_back(std::uint32_t(all.constrained.size()));
  return all;
}

void check_equal(const Arranged& found, const Arranged& wanted) {
  CHECK(found.first_triangle == wanted.first_triangle);
  CHECK(found.corners == wanted.corners);
  CHECK(found.neighbours == wanted.neighbours);
  CHECK(found.constrained == wanted.constrained);
}

/// Marks about one in three finite edges of a grown forest, whose mesh is Delaunay with and without. Returns them
/// problem by problem.
std::vector<std::vector<Constraint>> constrain_some(const ForestOnDevice& forest) {
  std::vector<std::vector<Constraint>> all;
  std::vector<cl_uint> marks(forest.mesh.edges(), GCDT_MARK_QUEUED);  // which is nobody's concern
  Random random{3};
  const std::vector<HostMesh> meshes = forest.now();
  for (cl_uint p = 0; p < forest.roots(); ++p) {
    all.emplace_back();
    // Edges of the root have symbolic ends only.
    for (std::uint32_t e = 3; e < meshes[p].edges; ++e) {
      const Constraint ends = ends_of_edge(meshes[p], e);
      if (ends[1] >= meshes[p].n || random.below(3) != 0) continue;
      all[p].push_back(ends);
      marks[device::gcdt_forest_edges(forest.begin[p], forest.roots()) + e - 3] |= GCDT_MARK_CONSTRAINED;
    }
  }
  forest.runtime.write(forest.mesh.edge_marks, marks.data(), marks.size());
  return all;
}

}  // namespace

TEST_CASE("triangles, neighbours and flags of every problem come in canonical order, one problem after the other") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    CAPTURE(seed);
    std::vector<std::vector<Point>> problems = small_problems(seed);
    problems.push_back(make_points("uniform", 3000, seed));
    ForestOnDevice forest(threads(), problems);
    forest.grow();
    check_equal(arrange(forest), expected(forest, std::vector<std::vector<Constraint>>(problems.size())));
    const auto constraints = constrain_some(forest);
    check_equal(arrange(forest), expected(forest, constraints));
  }
}

TEST_CASE("the order is that of the Morton code with the highest bits, up to the grid's corners") {
  const std::int64_t far = 0x7FFFFFFF;
  const std::vector<Point> corners = {{0, 0}, {far, 0}, {0, far}, {far, far}};
  std::vector<Point> scattered = make_points("corners", 40, 5);
  scattered.insert(scattered.end(), corners.begin(), corners.end());
  ForestOnDevice forest(threads(), {corners, scattered, {{0, far}, {far, 0}, {far, far}}});
  forest.grow();
  check_equal(arrange(forest), expected(forest, std::vector<std::vector<Constraint>>(3)));
}

TEST_CASE("problems without a triangle have none, and those beside them keep theirs") {
  ForestOnDevice none(threads(), {{}, {{5, 5}}, {{1, 2}, {3, 4}}, make_points("collinear", 50, 1), {}});
  none.grow();
  const Arranged nothing = arrange(none);
  CHECK(nothing.corners.empty());
  CHECK(nothing.first_triangle == std::vector<std::uint32_t>(6, 0));
  ForestOnDevice one(threads(), {{}, {{5, 5}}, {{0, 0}, {4, 0}, {0, 4}}, make_points("collinear", 50, 1), {}});
  one.grow();
  const Arranged triangle = arrange(one);
  CHECK(triangle.first_triangle == std::vector<std::uint32_t>{0, 0, 0, 1, 1, 1});
  CHECK(triangle.corners == std::vector<std::uint32_t>{1, 2, 3});
  CHECK(triangle.neighbours == std::vector<std::int32_t>{-1, -1, -1});
}

TEST_CASE("each problem's keys are sorted by all their bits within its own places, and equal ones stay in order") {
  Random random{9};
  std::vector<cl_uint> first = {0};
  for (const cl_uint size : {0u, 1u, 2u, 31u, 32u, 33u, 34u, 0u, 1000u, 5u, 300u}) first.push_back(first.back() + size);
  const cl_uint problems = cl_uint(first.size()) - 1, count = first.back();
  for (const std::uint64_t kinds : {3ull, 200ull, 0ull}) {  // so many keys; 0: any
    CAPTURE(kinds);
    std::vector<cl_ulong> keys(count);
    std::vector<cl_uint> values(count);
    for (cl_uint i = 0; i < count; ++i) {
      keys[i] = kinds == 0 ? random.next() : std::uint64_t(random.below(kinds)) * 0x9E3779B97F4A7C15ull;
      values[i] = i;
    }
    auto& runtime = threads();
    const auto key_buffer = runtime.upload("keys", keys), other_keys = runtime.upload("other keys", keys);
    const auto value_buffer = runtime.upload("values", values), other_values = runtime.upload("other values", values);
    const auto first_buffer = runtime.upload("first inputs", first);
    runtime.launch("arrange", "arrange_keys", runtime::over_large(problems), problems, first_buffer, key_buffer,
                   value_buffer, other_keys, other_values);
    std::vector<cl_ulong> sorted_keys(count);
    std::vector<cl_uint> sorted_values(count);
    runtime.read(key_buffer, sorted_keys.data(), count);
    runtime.read(value_buffer, sorted_values.data(), count);
    for (cl_uint p = 0; p < problems; ++p)
      std::stable_sort(values.begin() + first[p], values.begin() + first[p + 1],
                       [&](cl_uint a, cl_uint b) { return keys[a] < keys[b]; });
    CHECK(sorted_values == values);
    for (cl_uint i = 0; i < count; ++i) CHECK(sorted_keys[i] == keys[values[i]]);
  }
}

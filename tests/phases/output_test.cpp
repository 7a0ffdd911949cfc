// SPDX-License-Identifier: Apache-2.0
// The canonical order against a plain sequential one, on every device.
#include <doctest/doctest.h>

#include "phases/output.hpp"
#include "sample.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// The order of docs/contract.md, 5, on the host, from Morton codes of the points themselves; corners are input
/// numbers.
Triangulation canonical(const Sample& sample) {
  const auto& faces = sample.mesh->faces();
  auto code = [&](std::uint32_t v) { return device::gcdt_morton(sample.points[v][0], sample.points[v][1]); };
  struct Entry {
    std::array<std::uint64_t, 2> key;
    int face, first;
  };
  std::vector<Entry> entries;
  for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
    if (!sample.mesh->finite(f)) continue;
    const auto& c = faces[f].corners;
    int first = 0;
    for (int k = 1; k < 3; ++k)
      if (code(c[k]) < code(c[first])) first = k;
    entries.push_back({{code(c[first]), code(c[(first + 1) % 3])}, f, first});
  }
  std::sort(entries.begin(), entries.end(), [](auto& a, auto& b) { return a.key < b.key; });
  std::vector<std::int32_t> position(faces.size(), -1);
  for (std::size_t i = 0; i < entries.size(); ++i) position[entries[i].face] = static_cast<std::int32_t>(i);
  Triangulation result;
  for (const Entry& e : entries) {
    const Face& face = faces[e.face];
    std::array<std::uint32_t, 3> corners;
    std::array<std::int32_t, 3> neighbours;
    std::uint8_t flags = 0;
    for (int k = 0; k < 3; ++k) {
      const int from = (e.first + k) % 3;
      corners[k] = sample.vertex_input[face.corners[from]];
      neighbours[k] = position[face.neighbours[from]];
      flags |= face.constrained[from] ? 1 << k : 0;
    }
    result.triangles.push_back(corners);
    result.neighbours.push_back(neighbours);
    result.constrained.push_back(flags);
  }
  for (std::uint32_t v : sample.input_vertex) result.representative.push_back(sample.vertex_input[v]);
  return result;
}

Triangulation ordered_on(runtime::Runtime& runtime, const Sample& sample, std::uint32_t seed) {
  Primitives primitives(runtime);
  const Vertices vertices = upload_vertices(runtime, sample);
  const Mesh mesh = upload_mesh(runtime, sample, seed);
  OrderedMesh ordered = order_triangles(runtime, primitives, make_plan(runtime, vertices), mesh, vertices);
  Triangulation result;
  Pieces no_pieces;
  no_pieces.ends = runtime.allocate<cl_uint2>("pieces", 0);
  no_pieces.source_offsets = runtime.allocate<cl_uint>("source offsets", 1);
  const auto representatives = number_by_input(runtime, make_plan(runtime, vertices), vertices, ordered, no_pieces);
  CHECK(runtime.read_one(no_pieces.source_offsets) == 0);
  result.representative.resize(representatives.size());
  result.triangles.resize(ordered.triangles);
  result.neighbours.resize(ordered.triangles);
  result.constrained.resize(ordered.triangles);
  runtime.read(representatives, result.representative.data(), representatives.size());
  if (result.triangles.empty()) return result;
  runtime.read(ordered.corners, result.triangles[0].data(), 3 * result.triangles.size());
  runtime.read(ordered.neighbours, result.neighbours[0].data(), 3 * result.triangles.size());
  runtime.read(ordered.constrained, result.constrained.data(), result.triangles.size());
  return result;
}

}  // namespace

TEST_CASE(
    "triangles, neighbours, flags and representatives come out in canonical order on every device, however the mesh is "
    "numbered") {
  for (const Sample& sample : samples()) {
    const Triangulation expected = canonical(sample);
    for (auto& runtime : runtimes())
      for (std::uint32_t seed : {1u, 2u}) {
        CAPTURE(sample.name);
        CAPTURE(runtime->info().name);
        const Triangulation result = ordered_on(*runtime, sample, seed);
        CHECK(result.triangles == expected.triangles);
        CHECK(result.neighbours == expected.neighbours);
        CHECK(result.constrained == expected.constrained);
        CHECK(result.representative == expected.representative);
      }
  }
}

TEST_CASE("the order is the same for every launch geometry") {
  const Sample sample = make_sample("random", random_points(300, 1000, 9), 40);
  const Triangulation expected = canonical(sample);
  for (auto& runtime : runtimes()) {
    CAPTURE(runtime->info().name);
    const runtime::Geometry usual = runtime->geometry();
    for (const runtime::Geometry& geometry :
         {runtime::Geometry{1, 3}, runtime::Geometry{7, 2}, runtime::Geometry{64, 1}}) {
      runtime->geometry() = geometry;
      const Triangulation result = ordered_on(*runtime, sample, 3);
      CHECK(result.triangles == expected.triangles);
      CHECK(result.neighbours == expected.neighbours);
      CHECK(result.constrained == expected.constrained);
    }
    runtime->geometry() = usual;
  }
}

TEST_CASE("fewer than three vertices, or all on one line, give no triangles and all representatives") {
  for (const Sample& sample : samples()) {
    if (sample.n() >= 3 && sample.name != "on one line") continue;
    const Triangulation result = ordered_on(*runtimes().front(), sample, 1);
    CAPTURE(sample.name);
    CHECK(result.triangles.empty());
    CHECK(result.representative.size() == sample.input_vertex.size());
  }
}

TEST_CASE("ordering leaves nothing in device memory beside its result, and holds at most 66 bytes a face at a time") {
  const Sample sample = make_sample("random", random_points(2000, 1 << 20, 5), 0);
  for (auto& runtime : runtimes()) {
    CAPTURE(runtime->info().name);
    Primitives primitives(*runtime);
    const Vertices vertices = upload_vertices(*runtime, sample);
    const Mesh mesh = upload_mesh(*runtime, sample, 1);
    const Plan plan = make_plan(*runtime, vertices);
    const std::uint64_t before = runtime->meter().now;
    runtime->meter().peak = before;
    {
      const OrderedMesh ordered = order_triangles(*runtime, primitives, plan, mesh, vertices);
      const std::uint64_t held = runtime->meter().now - before;
      const std::uint64_t result = ordered.corners.bytes() + ordered.neighbours.bytes() + ordered.constrained.bytes();
      CHECK(held >= result);
      // Of few vertices there is room for a triangle a face before triangles are counted.
      CHECK(held <= (plan.output == Plan::By::one ? 25 * mesh.faces() : result));
      CHECK(runtime->meter().peak - before <= std::uint64_t{66} * mesh.faces());
    }
    CHECK(runtime->meter().now == before);
  }
}

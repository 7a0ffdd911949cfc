// SPDX-License-Identifier: Apache-2.0
// Meshes for the phase tests: vertices uploaded from grid points, a mesh made of them level by level, read back, and
// proved valid on the host by plain loops.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/levels.h"
#include "common/predicates.h"
#include "phases/flip.hpp"
#include "phases/walk.hpp"
#include "reference.hpp"

namespace fixture {

using namespace gcdt;
using Point = std::array<std::int64_t, 2>;

/// The devices under test: every one present; a machine without any fails.
inline std::vector<cl::Device> devices_under_test() {
  std::vector<cl::Device> all = runtime::all_devices();
  REQUIRE_MESSAGE(!all.empty(), "no OpenCL device: install pocl-opencl-icd");
  return all;
}

/// splitmix64: the same numbers on every platform.
struct Random {
  std::uint64_t state;
  std::uint64_t next() {
    std::uint64_t z = (state += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  std::int64_t below(std::uint64_t bound) { return static_cast<std::int64_t>(next() % bound); }
};

/// Sorts along the Z-order curve and drops duplicates.
inline std::vector<Point> along_curve(std::vector<Point> points) {
  auto key = [](const Point& p) { return device::gcdt_morton(std::uint32_t(p[0]), std::uint32_t(p[1])); };
  std::sort(points.begin(), points.end(), [&](const Point& a, const Point& b) { return key(a) < key(b); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// Vertices as the order phase makes them; `points` is left in the order of vertex numbers, and input v is vertex v.
inline Vertices upload(runtime::Runtime& runtime, std::vector<Point>& points, std::uint32_t coarsest) {
  const std::vector<Point> ranked = along_curve(points);
  Vertices vertices;
  vertices.levels = device::make_levels(std::uint32_t(ranked.size()), coarsest);
  std::vector<cl_int2> xy(ranked.size());
  std::vector<cl_uint> same(ranked.size());
  points.assign(ranked.size(), {});
  for (std::uint32_t v = 0; v < ranked.size(); ++v) {
    points[v] = ranked[device::gcdt_rank_of_vertex(&vertices.levels, v)];
    xy[v].s[0] = int(points[v][0]);
    xy[v].s[1] = int(points[v][1]);
    same[v] = v;
  }
  vertices.points = runtime.allocate<cl_int2>("points", xy.size());
  runtime.write(vertices.points, xy.data(), xy.size());
  vertices.levels_buffer = runtime.allocate<device::Levels>("levels", 1);
  runtime.write(vertices.levels_buffer, &vertices.levels, 1);
  vertices.input_vertex = runtime.allocate<cl_uint>("vertices of inputs", same.size());
  runtime.write(vertices.input_vertex, same.data(), same.size());
  return vertices;
}

struct HostMesh {
  std::uint32_t n = 0, faces = 0, edges = 0;
  std::vector<Point> points;
  std::vector<cl_uint4> corners, sides;
  std::vector<cl_uint> edge_faces, marks;

  device::Vertex vertex(std::uint32_t v) const {
    return v >= n ? device::gcdt_symbolic_vertex(int(v - n)) : device::gcdt_finite_vertex(points[v][0], points[v][1]);
  }
};

inline HostMesh download(runtime::Runtime& runtime, const Mesh& mesh, const std::vector<Point>& points,
                         std::uint32_t vertices_in_mesh) {
  HostMesh host;
  host.n = mesh.n;
  host.faces = device::gcdt_face_count(vertices_in_mesh);
  host.edges = device::gcdt_forest_edges(vertices_in_mesh, 1);
  host.points = points;
  host.corners.resize(host.faces);
  host.sides.resize(host.faces);
  host.edge_faces.resize(2 * host.edges);
  host.marks.resize(host.edges);
  std::vector<cl_uint4> face_data(2 * std::size_t{host.faces});
  runtime.read(mesh.face_data, face_data.data(), face_data.size());
  for (std::size_t t = 0; t < host.faces; ++t) {
    host.corners[t] = face_data[GCDT_CORNERS(t)];
    host.sides[t] = face_data[GCDT_SIDES(t)];
  }
  runtime.read(mesh.edge_faces, host.edge_faces.data(), 2 * host.edges);
  runtime.read(mesh.edge_marks, host.marks.data(), host.edges);
  return host;
}

/// Vertices on a device, and what phases need to make a mesh of them.
struct MeshOnDevice {
  runtime::Runtime& runtime;
  std::vector<Point> points;  ///< in the order of vertex numbers
  Vertices vertices;
  Plan plan;
  Mesh mesh;
  WorkLists lists;
  History history;
  PhaseCounters counters;
  Ticker ticker;

  MeshOnDevice(runtime::Runtime& on, std::vector<Point> given, std::uint32_t coarsest)
      : runtime(on),
        points(std::move(given)),
        vertices(upload(on, points, coarsest)),
        plan(make_plan(on, vertices)),
        mesh(make_mesh(on, vertices.n())),
        lists(make_work_lists(on, vertices.n())),
        history(make_history(on, vertices.levels)),
        counters(on) {}
  MeshOnDevice(const MeshOnDevice&) = delete;
  MeshOnDevice& operator=(const MeshOnDevice&) = delete;

  std::uint32_t n() const { return vertices.n(); }
  unsigned levels() const { return vertices.levels.count; }
  /// Vertices in the levels up to this one.
  std::uint32_t vertices_of(unsigned level) const { return vertices.levels.begin[level + 1]; }
  /// Returns the number of rounds.
  std::uint64_t insert(unsigned level) {
    if (level == 0) insert_root(runtime, vertices, mesh);
    return insert_level(runtime, plan, vertices, mesh, history, true, lists, counters, level, ticker);
  }
  FlipResult flip(unsigned level) {
    counters.zero();
    return flip_inserted(level);
  }
  /// With the counters as insert() left them.
  FlipResult flip_inserted(unsigned level) {
    return gcdt::flip(runtime, plan, vertices, mesh, lists, counters, vertices_of(level), ticker);
  }
  FlipResult flip() { return flip(levels() - 1); }
  /// All levels; the last one is flipped only if asked.
  void insert_all(bool flips_last) {
    for (unsigned level = 0; level < levels(); ++level) {
      insert(level);
      if (level + 1 < levels() || flips_last) flip_inserted(level);
    }
  }
  HostMesh after(unsigned level) const { return download(runtime, mesh, points, vertices_of(level)); }
  HostMesh now() const { return after(levels() - 1); }
  WalkedMesh walked() { return {plan, vertices, mesh, history}; }
};

/// Empty if the mesh is a valid triangulation of the symbolic triangle with exactly the vertices
/// 0 .. vertices_in_mesh-1: all faces counter-clockwise, faces and edges refer to each other, each
/// edge's sides run in opposite directions, only the symbolic triangle's edges have one side.
/// (Boundaries of counter-clockwise triangles that cancel but for the outer triangle's cover it once.)
inline std::string invalid_reason(const HostMesh& m, std::uint32_t vertices_in_mesh) {
  using namespace gcdt::device;
  std::vector<char> used(m.n + 3, 0);
  std::vector<char> side_seen(2 * m.edges, 0);
  for (std::uint32_t t = 0; t < m.faces; ++t) {
    const cl_uint* c = m.corners[t].s;
    for (int k = 0; k < 3; ++k) {
      if (c[k] >= m.n + 3 || (c[k] < m.n && c[k] >= vertices_in_mesh))
        return "face " + std::to_string(t) + " has corner " + std::to_string(c[k]);
      used[c[k]] = 1;
      const cl_uint s = m.sides[t].s[k];
      if (s >= 2 * m.edges) return "face " + std::to_string(t) + " has side code " + std::to_string(s);
      if (side_seen[s]++) return "side " + std::to_string(s) + " is used twice";
      if (m.edge_faces[s] != GCDT_FACE_REF(t, k))
        return "edge side " + std::to_string(s) + " does not refer to its face " + std::to_string(t);
    }
    if (vertices_in_mesh > 0 && !(gcdt_orient2d(m.vertex(c[0]), m.vertex(c[1]), m.vertex(c[2])) > 0))
      return "face " + std::to_string(t) + " is not counter-clockwise";
  }
  for (std::uint32_t e = 0; e < m.edges; ++e) {
    const cl_uint r0 = m.edge_faces[2 * e], r1 = m.edge_faces[2 * e + 1];
    if (r0 == GCDT_NONE || r1 == GCDT_NONE) {
      const cl_uint r = r0 == GCDT_NONE ? r1 : r0;
      const cl_uint* c = m.corners[r >> 2].s;
      if (c[((r & 3) + 1) % 3] < m.n || c[((r & 3) + 2) % 3] < m.n)
        return "edge " + std::to_string(e) + " has one side";
      continue;
    }
    const cl_uint *a = m.corners[r0 >> 2].s, *b = m.corners[r1 >> 2].s;
    if (a[((r0 & 3) + 1) % 3] != b[((r1 & 3) + 2) % 3] || a[((r0 & 3) + 2) % 3] != b[((r1 & 3) + 1) % 3])
      return "edge " + std::to_string(e) + " joins different vertices on its two sides";
  }
  for (std::uint32_t v = 0; v < vertices_in_mesh; ++v)
    if (!used[v]) return "vertex " + std::to_string(v) + " is in no face";
  return "";
}

/// The vertices of an edge of a valid mesh, ascending.
inline std::array<std::uint32_t, 2> ends_of_edge(const HostMesh& m, std::uint32_t e) {
  const cl_uint one = m.edge_faces[2 * e], ref = one == GCDT_NONE ? m.edge_faces[2 * e + 1] : one;
  const cl_uint* c = m.corners[ref >> 2].s;
  const std::uint32_t u = c[((ref & 3) + 1) % 3], v = c[((ref & 3) + 2) % 3];
  return {std::min(u, v), std::max(u, v)};
}

/// Unconstrained edges that must_flip() rejects.
inline std::size_t illegal_edges(const HostMesh& m) {
  std::size_t count = 0;
  for (std::uint32_t e = 0; e < m.edges; ++e) {
    const cl_uint r0 = m.edge_faces[2 * e], r1 = m.edge_faces[2 * e + 1];
    if (r0 == GCDT_NONE || r1 == GCDT_NONE || (m.marks[e] & GCDT_MARK_CONSTRAINED)) continue;
    const cl_uint *a = m.corners[r0 >> 2].s, *b = m.corners[r1 >> 2].s;
    const cl_uint k = r0 & 3;
    count += device::gcdt_must_flip(m.vertex(a[(k + 2) % 3]), m.vertex(a[k]), m.vertex(a[(k + 1) % 3]),
                                    m.vertex(b[r1 & 3])) != 0;
  }
  return count;
}

/// The finite faces as a set, each starting with its least vertex.
inline std::set<std::array<std::uint32_t, 3>> finite_faces(const HostMesh& m) {
  std::set<std::array<std::uint32_t, 3>> all;
  for (const cl_uint4& f : m.corners) {
    std::array<std::uint32_t, 3> c = {f.s[0], f.s[1], f.s[2]};
    if (c[0] >= m.n || c[1] >= m.n || c[2] >= m.n) continue;
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    all.insert(c);
  }
  return all;
}

/// CGAL's triangulation as such a set, ties by docs/contract.md, 4.
inline std::set<std::array<std::uint32_t, 3>> expected_faces(const std::vector<Point>& points,
                                                             const std::vector<Constraint>& constraints = {}) {
  std::set<std::array<std::uint32_t, 3>> faces;
  for (auto t : reference::reference_cdt(points, constraints)) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    faces.insert(t);
  }
  return faces;
}

/// Named point sets on the grid, n about as asked.
inline std::vector<Point> make_points(const std::string& kind, std::uint32_t n, std::uint64_t seed) {
  Random random{seed};
  const std::int64_t s = 2147483647;
  std::vector<Point> p;
  if (kind == "uniform")
    for (std::uint32_t i = 0; i < n; ++i) p.push_back({random.below(s + 1ull), random.below(s + 1ull)});
  if (kind == "grid") {
    std::uint32_t side = 1;
    while (side * side < n) ++side;
    for (std::uint32_t i = 0; i < n; ++i) p.push_back({i % side, i / side});
  }
  if (kind == "collinear")
    for (std::uint32_t i = 0; i < n; ++i) p.push_back({3 * std::int64_t(i), 5 * std::int64_t(i)});
  if (kind == "clusters")
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::int64_t x = (i % 7) * 300000000ll, y = (i % 5) * 400000000ll, r = 1ll << (3 * (i % 9) + 2);
      p.push_back({std::min(s, x + random.below(r)), std::min(s, y + random.below(r))});
    }
  if (kind == "corners") {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::int64_t x = random.below(3), y = random.below(3);
      p.push_back({std::clamp<std::int64_t>(random.below(2) * s + (random.below(2) ? x : -x), 0, s),
                   std::clamp<std::int64_t>(random.below(2) * s + (random.below(2) ? y : -y), 0, s)});
    }
  }
  if (kind == "parabola")
    for (std::uint32_t i = 0; i < n; ++i) p.push_back({i, std::int64_t(i) * i});
  if (kind == "tiny")
    for (std::uint32_t i = 0; i < n; ++i) p.push_back({random.below(6), random.below(6)});
  return p;
}

}  // namespace fixture

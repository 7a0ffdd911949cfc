// SPDX-License-Identifier: Apache-2.0
// Small constrained Delaunay triangulations made on the host (sequential_mesh.hpp) and put into device
// memory as the pipeline's phases would leave them, for tests of what comes after.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "device_list.hpp"
#include "mesh/mesh.hpp"
#include "sequential_mesh.hpp"

namespace gcdt::test {

/// One runtime for each device of the machine, rusticl's software renderer included; for those that have a way of their
/// own for few vertices, a second one that launches what the calling thread can do, a third one without that way, and a
/// fourth one that treats the device as a GPU.
inline std::vector<std::unique_ptr<runtime::Runtime>>& runtimes() {
  static std::vector<std::unique_ptr<runtime::Runtime>> all = [] {
    std::vector<std::unique_ptr<runtime::Runtime>> made;
    for (const auto& device : every_device()) {
      made.push_back(std::make_unique<runtime::Runtime>(device));
      runtime::CallHook hook;
      if (!made.back()->contiguous()) continue;
      hook.tuning.works_here = false;
      if (made.back()->can_work_here()) made.push_back(std::make_unique<runtime::Runtime>(device, hook));
      hook.tuning.one_item_vertices = 0;
      made.push_back(std::make_unique<runtime::Runtime>(device, hook));
      hook.tuning.kind = DeviceKind::gpu;
      made.push_back(std::make_unique<runtime::Runtime>(device, hook));
    }
    return made;
  }();
  return all;
}

/// Distinct points in vertex order, their numbering, pieces, and the mesh.
struct Sample {
  std::string name;
  device::Levels levels = {};
  std::vector<Point> points;
  std::vector<std::uint32_t> vertex_input, input_vertex;
  std::vector<std::array<std::uint32_t, 2>> pieces;  ///< lower rank first, sorted by ranks
  std::unique_ptr<SequentialMesh> mesh;

  std::uint32_t n() const { return static_cast<std::uint32_t>(points.size()); }
  std::uint32_t rank(std::uint32_t v) const { return device::gcdt_rank_of_vertex(&levels, v); }
  void sort_pieces() {
    for (auto& p : pieces)
      if (rank(p[1]) < rank(p[0])) std::swap(p[0], p[1]);
    std::sort(pieces.begin(), pieces.end(), [&](auto& a, auto& b) {
      return std::make_pair(rank(a[0]), rank(a[1])) < std::make_pair(rank(b[0]), rank(b[1]));
    });
  }
};

/// Numbers the points: along the curve, level by level; inputs are a shuffle with some duplicates.
inline Sample number_points(std::string name, std::vector<Point> points, std::uint32_t seed) {
  auto code = [](const Point& p) {
    return device::gcdt_morton(static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[1]));
  };
  std::sort(points.begin(), points.end(), [&](auto& a, auto& b) { return code(a) < code(b); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  Sample sample;
  sample.name = std::move(name);
  const auto n = static_cast<std::uint32_t>(points.size());
  sample.levels = device::make_levels(n, 8);
  sample.points.resize(n);
  for (std::uint32_t r = 0; r < n; ++r)
    sample.points[device::gcdt_vertex_of_rank(&sample.levels, sample.levels.count - 1, r)] = points[r];
  std::mt19937 random(seed);
  for (std::uint32_t v = 0; v < n; ++v)
    for (std::uint32_t copies = random() % 8 == 0 ? 2 : 1; copies > 0; --copies) sample.input_vertex.push_back(v);
  std::shuffle(sample.input_vertex.begin(), sample.input_vertex.end(), random);
  sample.vertex_input.resize(n);
  for (std::size_t i = sample.input_vertex.size(); i-- > 0;)
    sample.vertex_input[sample.input_vertex[i]] = static_cast<std::uint32_t>(i);
  return sample;
}

/// Triangulates the sample under up to `wanted` random pieces that neither cross nor meet a vertex.
inline void triangulate(Sample& sample, std::size_t wanted, std::uint32_t seed) {
  sample.mesh = std::make_unique<SequentialMesh>(sample.points);
  const SequentialMesh& mesh = *sample.mesh;
  std::mt19937 random(seed);
  for (std::size_t attempt = 0; sample.n() > 1 && attempt < 4 * wanted && sample.pieces.size() < wanted; ++attempt) {
    const std::uint32_t a = random() % sample.n(), b = random() % sample.n();
    bool fits = a != b;
    for (std::uint32_t v = 0; v < sample.n() && fits; ++v) {
      const Point &p = sample.points[a], &q = sample.points[b], &x = sample.points[v];
      const auto dot = (std::int64_t{x[0]} - p[0]) * (std::int64_t{x[0]} - q[0]) +
                       (std::int64_t{x[1]} - p[1]) * (std::int64_t{x[1]} - q[1]);
      fits = v == a || v == b || mesh.orient(a, b, v) != 0 || dot > 0;
    }
    for (const auto& p : sample.pieces)
      fits = fits && !mesh.crosses(a, b, p[0], p[1]) && std::minmax(a, b) != std::minmax(p[0], p[1]);
    if (!fits) continue;
    sample.pieces.push_back({a, b});
    sample.mesh->constrain(a, b);
  }
  sample.mesh->restore();
  sample.sort_pieces();
}

inline Sample make_sample(std::string name, std::vector<Point> points, std::size_t pieces, std::uint32_t seed = 1) {
  Sample sample = number_points(std::move(name), std::move(points), seed);
  triangulate(sample, pieces, seed);
  return sample;
}

inline std::vector<Point> random_points(std::size_t count, std::int32_t side, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> coordinate(0, side);
  std::vector<Point> points(count);
  for (auto& p : points) p = {coordinate(random), coordinate(random)};
  return points;
}

inline std::vector<Point> grid_points(std::int32_t columns, std::int32_t rows, std::int32_t step = 1) {
  std::vector<Point> points;
  for (std::int32_t x = 0; x < columns; ++x)
    for (std::int32_t y = 0; y < rows; ++y) points.push_back({x * step, y * step});
  return points;
}

inline std::vector<Sample> samples() {
  constexpr std::int32_t far = 0x7FFFFFFF;
  std::vector<Sample> all;
  all.push_back(make_sample("no vertex", {}, 0));
  all.push_back(make_sample("one vertex", {{5, 7}}, 0));
  all.push_back(make_sample("two vertices", {{5, 7}, {0, 9}}, 1));
  all.push_back(make_sample("a triangle", {{0, 0}, {far, 0}, {0, far}}, 1));
  all.push_back(make_sample("the grid's corners", {{0, 0}, {far, 0}, {0, far}, {far, far}}, 1));
  all.push_back(make_sample(
      "on one line",
      [] {
        std::vector<Point> line;
        for (std::int32_t i = 0; i < 50; ++i) line.push_back({3 * i, 7 * i});
        return line;
      }(),
      5));
  all.push_back(make_sample("one vertex off a line", {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {2, 9}}, 2));
  all.push_back(make_sample("a square grid", grid_points(13, 11), 25));
  all.push_back(make_sample("a wide grid", grid_points(20, 3, 1 << 26), 10));
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    all.push_back(make_sample("random, full range " + std::to_string(seed), random_points(40u * seed, far, seed),
                              15 * seed, seed));
    all.push_back(
        make_sample("random, crowded " + std::to_string(seed), random_points(60u * seed, 15, seed), 10 * seed, seed));
  }
  return all;
}

/// The sample's vertices and pieces on a device.
inline Vertices upload_vertices(runtime::Runtime& runtime, const Sample& sample) {
  Vertices vertices;
  vertices.levels = sample.levels;
  vertices.levels_buffer = runtime.allocate<device::Levels>("levels", 1);
  vertices.points = runtime.allocate<cl_int2>("points", sample.n());
  vertices.vertex_input = runtime.allocate<cl_uint>("vertex input", sample.n());
  vertices.input_vertex = runtime.allocate<cl_uint>("input vertex", sample.input_vertex.size());
  static_assert(sizeof(Point) == sizeof(cl_int2), "points are pairs");
  runtime.write(vertices.levels_buffer, &sample.levels, 1);
  runtime.write(vertices.points, reinterpret_cast<const cl_int2*>(sample.points.data()), sample.n());
  runtime.write(vertices.vertex_input, sample.vertex_input.data(), sample.n());
  runtime.write(vertices.input_vertex, sample.input_vertex.data(), sample.input_vertex.size());
  return vertices;
}

inline Pieces upload_pieces(runtime::Runtime& runtime, const Sample& sample) {
  Pieces pieces;
  pieces.count = static_cast<std::uint32_t>(sample.pieces.size());
  pieces.ends = runtime.allocate<cl_uint2>("piece ends", pieces.count);
  runtime.write(pieces.ends, reinterpret_cast<const cl_uint2*>(sample.pieces.data()), pieces.count);
  return pieces;
}

/// The sample's mesh on a device: faces, corners within faces and edges numbered at random. If a vertex
/// was left out, the two faces too few are symbolic ones that no link leads to.
inline Mesh upload_mesh(runtime::Runtime& runtime, const Sample& sample, std::uint32_t seed) {
  const auto& faces = sample.mesh->faces();
  Mesh mesh;
  mesh.n = sample.n();
  std::mt19937 random(seed);
  std::vector<cl_uint> face_number(mesh.faces()), turn(mesh.faces()), edge_number(mesh.edges());
  for (cl_uint f = 0; f < mesh.faces(); ++f) face_number[f] = f, turn[f] = random() % 3;
  for (cl_uint e = 0; e < mesh.edges(); ++e) edge_number[e] = e;
  std::shuffle(face_number.begin(), face_number.end(), random);
  std::shuffle(edge_number.begin(), edge_number.end(), random);
  std::vector<cl_uint4> face_data(2 * std::size_t{mesh.faces()}, cl_uint4{});
  for (cl_uint f = 0; f < mesh.faces(); ++f) face_data[GCDT_CORNERS(f)] = cl_uint4{{mesh.n, mesh.n + 1, mesh.n + 2, 0}};
  std::vector<cl_uint> edge_faces(2 * mesh.edges(), GCDT_NONE), edge_marks(mesh.edges(), GCDT_MARK_QUEUED);
  cl_uint edges = 0;
  auto place = [&](cl_uint f, int k, cl_uint side) {
    const cl_uint slot = (k + turn[f]) % 3;
    face_data[GCDT_CORNERS(face_number[f])].s[slot] = faces[f].corners[k];
    face_data[GCDT_SIDES(face_number[f])].s[slot] = side;
    edge_faces[side] = GCDT_FACE_REF(face_number[f], slot);
  };
  for (cl_uint f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int g = faces[f].neighbours[k];
      if (g >= 0 && static_cast<cl_uint>(g) < f) continue;
      const cl_uint edge = edge_number[edges++], side = random() % 2;
      if (faces[f].constrained[k]) edge_marks[edge] |= GCDT_MARK_CONSTRAINED;
      place(f, k, GCDT_SIDE(edge, side));
      int j = 0;
      while (g >= 0 && faces[g].neighbours[j] != static_cast<int>(f)) ++j;
      if (g >= 0) place(g, j, GCDT_SIDE(edge, side ^ 1u));
    }
  mesh.face_data = runtime.allocate<cl_uint4>("faces", face_data.size());
  mesh.edge_faces = runtime.allocate<cl_uint>("edge faces", edge_faces.size());
  mesh.edge_marks = runtime.allocate<cl_uint>("edge marks", edge_marks.size());
  runtime.write(mesh.face_data, face_data.data(), face_data.size());
  runtime.write(mesh.edge_faces, edge_faces.data(), edge_faces.size());
  runtime.write(mesh.edge_marks, edge_marks.data(), edge_marks.size());
  return mesh;
}

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
// Many small problems in one mesh, as batches have them on CPUs whose work-items are threads' loops, where one
// work-item does all of a problem (kernels/common/forest.h): vertices on a device, and each problem's part of the mesh
// read back.
#pragma once

#include <memory>

#include "device_list.hpp"
#include "mesh_fixture.hpp"
#include "phases/grow.hpp"

namespace fixture {

/// A runtime of a device whose work-items are threads' loops: only they have grow, enforce and arrange.
inline std::unique_ptr<runtime::Runtime> threads_runtime(runtime::Meshes meshes, const runtime::CallHook& hook = {}) {
  for (const cl::Device& device : test::every_device()) {
    auto made = std::make_unique<runtime::Runtime>(device, hook);
    if (made->kind() != DeviceKind::threads) continue;
    made->use_programs(meshes);
    return made;
  }
  FAIL("no CPU whose work-items are loops of threads: install pocl-opencl-icd");
  return nullptr;
}

/// Problems one after the other with one level: vertices are ranks.
struct ForestOnDevice {
  runtime::Runtime& runtime;
  std::vector<std::vector<Point>> problems;  ///< the points of each, distinct, along the curve
  std::vector<cl_uint> begin = {0};          ///< first vertex of each; P + 1
  std::vector<cl_uint> input_vertex;         ///< one or two inputs for each vertex, in any order
  Vertices vertices;
  Plan plan;
  Mesh mesh;
  WorkLists lists;
  PhaseCounters counters;

  ForestOnDevice(runtime::Runtime& on, std::vector<std::vector<Point>> given)
      : runtime(on), problems(std::move(given)), counters(on) {
    for (std::vector<Point>& points : problems) {
      points = along_curve(std::move(points));
      begin.push_back(begin.back() + cl_uint(points.size()));
    }
    number_inputs();
    upload_vertices();
    plan = make_plan(runtime, vertices);
    plan.problems = plan.constraints = plan.output = Plan::By::each;
    mesh = make_mesh(runtime, n(), roots());
    lists = make_work_lists(runtime, n(), roots());
  }
  ForestOnDevice(const ForestOnDevice&) = delete;
  ForestOnDevice& operator=(const ForestOnDevice&) = delete;

  cl_uint n() const { return begin.back(); }
  cl_uint roots() const { return cl_uint(problems.size()); }
  GrowResult grow() {
    Ticker ticker;
    return gcdt::grow(runtime, plan, vertices, mesh, lists, counters, n(), ticker);
  }
  /// Each problem's mesh as it would be alone: vertices, faces and edges count from its own first.
  std::vector<HostMesh> now() const {
    std::vector<cl_uint4> face_data(2 * std::size_t{mesh.faces()});
    std::vector<cl_uint> edge_faces(2 * std::size_t{mesh.edges()}), marks(mesh.edges());
    runtime.read(mesh.face_data, face_data.data(), face_data.size());
    runtime.read(mesh.edge_faces, edge_faces.data(), edge_faces.size());
    runtime.read(mesh.edge_marks, marks.data(), marks.size());
    std::vector<HostMesh> all;
    for (cl_uint p = 0; p < roots(); ++p) all.push_back(part(p, face_data, edge_faces, marks));
    return all;
  }

 private:
  // Every third vertex is two inputs.
  void number_inputs() {
    for (cl_uint v = 0; v < n(); ++v) input_vertex.insert(input_vertex.end(), v % 3 == 0 ? 2 : 1, v);
    Random random{n()};
    for (std::size_t i = input_vertex.size(); i > 1; --i)
      std::swap(input_vertex[i - 1], input_vertex[std::size_t(random.below(i))]);
  }

  void upload_vertices() {
    const std::size_t words = 2 + std::size_t{n()} + roots() + 1;
    std::vector<cl_int2> points(n() + (words + 1) / 2);
    cl_uint* word = reinterpret_cast<cl_uint*>(points.data() + n());
    word[0] = roots();
    for (cl_uint p = 0; p < roots(); ++p) {
      vertices.largest = std::max(vertices.largest, begin[p + 1] - begin[p]);
      for (cl_uint v = begin[p]; v < begin[p + 1]; ++v) {
        points[v] = {{int(problems[p][v - begin[p]][0]), int(problems[p][v - begin[p]][1])}};
        word[2 + v] = p;
      }
    }
    std::copy(begin.begin(), begin.end(), word + 2 + n());
    vertices.roots = roots();
    vertices.levels = device::make_levels(n(), std::max(n(), 1u));
    vertices.points = runtime.allocate<cl_int2>("points", points.size());
    vertices.levels_buffer = runtime.allocate<device::Levels>("levels", 1);
    vertices.input_vertex = runtime.allocate<cl_uint>("vertices of inputs", input_vertex.size());
    runtime.write(vertices.points, points.data(), points.size());
    runtime.write(vertices.levels_buffer, &vertices.levels, 1);
    runtime.write(vertices.input_vertex, input_vertex.data(), input_vertex.size());
  }

  // What is another problem's becomes GCDT_NONE, which is valid nowhere but across from an outer edge.
  HostMesh part(cl_uint p, const std::vector<cl_uint4>& face_data, const std::vector<cl_uint>& edge_faces,
                const std::vector<cl_uint>& marks) const {
    HostMesh m;
    m.points = problems[p];
    m.n = begin[p + 1] - begin[p];
    m.faces = device::gcdt_face_count(m.n);
    m.edges = device::gcdt_forest_edges(m.n, 1);
    const cl_uint first_face = device::gcdt_forest_faces(begin[p], roots()),
                  first_edge = device::gcdt_forest_edges(begin[p], roots());
    // Symbolic vertices, faces and edges of the root stand elsewhere than what vertices bring.
    const auto local = [](cl_uint i, cl_uint root, cl_uint of_root, cl_uint first, cl_uint end) {
      if (i >= root && i < root + of_root) return i - root;
      return i >= first && i < end ? of_root + i - first : GCDT_NONE;
    };
    const auto global = [](cl_uint i, cl_uint root, cl_uint of_root, cl_uint first) {
      return i < of_root ? root + i : first + i - of_root;
    };
    for (cl_uint t = 0; t < m.faces; ++t) {
      const cl_uint from = global(t, p, 1, first_face);
      cl_uint4 corners = face_data[GCDT_CORNERS(from)], sides = face_data[GCDT_SIDES(from)];
      for (int k = 0; k < 3; ++k) {
        const cl_uint v = corners.s[k], s = sides.s[k];
        corners.s[k] = v >= n() + 3 * p && v < n() + 3 * p + 3 ? m.n + v - n() - 3 * p
                       : v >= begin[p] && v < begin[p + 1]     ? v - begin[p]
                                                               : GCDT_NONE;
        const cl_uint e = local(s / 2, 3 * p, 3, first_edge, first_edge + m.edges - 3);
        sides.s[k] = e == GCDT_NONE ? e : 2 * e + s % 2;
      }
      m.corners.push_back(corners);
      m.sides.push_back(sides);
    }
    for (cl_uint e = 0; e < m.edges; ++e) {
      const cl_uint from = global(e, 3 * p, 3, first_edge);
      m.marks.push_back(marks[from]);
      for (int side = 0; side < 2; ++side) {
        const cl_uint ref = edge_faces[2 * from + side];
        const cl_uint t = ref == GCDT_NONE ? ref : local(ref >> 2, p, 1, first_face, first_face + m.faces - 1);
        m.edge_faces.push_back(t == GCDT_NONE ? t : t << 2 | (ref & 3));
      }
    }
    return m;
  }
};

/// Problems of all kinds of points and of all small sizes, with some that have no vertex.
inline std::vector<std::vector<Point>> small_problems(std::uint64_t seed) {
  std::vector<std::vector<Point>> all;
  for (const char* kind : {"uniform", "grid", "collinear", "clusters", "corners", "parabola", "tiny"})
    for (const std::uint32_t n : {0u, 1u, 2u, 3u, 4u, 10u, 60u, 200u}) all.push_back(make_points(kind, n, seed));
  return all;
}

}  // namespace fixture

// SPDX-License-Identifier: Apache-2.0
// Point location near vertices with many triangles: the fans of a finished mesh, and walks that turn around a vertex by
// bisection instead of triangle by triangle.
#include <cmath>
#include <map>

#include "constrain/fan.h"
#include "kinds.hpp"
#include "query/derived.hpp"
#include "query/locate.h"
#include "solve/triangulate.hpp"
#include "triangle_search.hpp"
#include "workloads.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

using Place = std::array<std::int32_t, 2>;
constexpr std::int32_t unit = 1 << 20;

struct Input {
  std::string name;
  std::vector<Place> points;
  std::vector<Constraint> constraints;
  std::size_t hubs;  // vertices with fans
  Domain domain = Domain::hull;
};

Place on_circle(double radius, double turns) {
  const double angle = 2 * 3.14159265358979 * turns;
  return {unit + static_cast<std::int32_t>(radius * std::cos(angle)),
          unit + static_cast<std::int32_t>(radius * std::sin(angle))};
}

/// A hub inside, most of whose neighbours are in a sixth of the circle around it. `turned` by how many eighths.
Input wheel(int count, int turned) {
  Input input{"wheel " + std::to_string(turned), {{unit, unit}}, {}, 1};
  for (int i = 0; i < count; ++i) {
    const double whole = static_cast<double>(i) / count;
    const double at = whole < 0.7 ? whole / 0.7 / 6 : 1.0 / 6 + (whole - 0.7) / 0.3 * 5 / 6;
    input.points.push_back(on_circle(1e6, at + turned / 8.0));
  }
  return input;
}

/// A hub on the convex hull, at the end of a half circle's diameter or beyond it. `turned` by how many eighths.
Input half_wheel(int count, int turned, bool flat) {
  Input input{(flat ? "flat half wheel " : "half wheel ") + std::to_string(turned), {{unit, unit}}, {}, 1};
  for (int i = 0; i <= count; ++i)
    input.points.push_back(on_circle(1e6, (flat ? 0.5 : 0.4) * i / count + turned / 8.0));
  return input;
}

/// A row between two hubs on the hull.
Input row_between_hubs(int count) {
  Input input{"row between hubs", {{count, unit - count}, {count, unit + count}}, {}, 2};
  for (int i = 0; i < count; ++i) input.points.push_back({2 * i, unit});
  return input;
}

/// Constraints from two hubs inside a square to a row between them, so that the mesh is far from Delaunay; of which the
/// domain keeps some.
Input constrained_hubs(int count) {
  Input input{"constrained hubs", {{count, unit - 9 * count}, {count + 1, unit + 9 * count}}, {}, 2, Domain::even_odd};
  for (int i = 0; i < count; ++i) {
    input.points.push_back({2 * i, unit + i % 3});
    const auto v = static_cast<std::uint32_t>(i + 2);
    input.constraints.insert(input.constraints.end(), {{0, v}, {v, 1}});
  }
  const auto first = static_cast<std::uint32_t>(input.points.size());
  for (const Place corner : {Place{-9 * count, unit - 10 * count}, Place{11 * count, unit - 10 * count},
                             Place{11 * count, unit + 10 * count}, Place{-9 * count, unit + 10 * count}})
    input.points.push_back(corner);
  for (std::uint32_t k = 0; k < 4; ++k) input.constraints.push_back({first + k, first + (k + 1) % 4});
  return input;
}

std::vector<Input> inputs() {
  std::vector<Input> all = {row_between_hubs(4000), constrained_hubs(2500)};
  for (int turned = 0; turned < 8; ++turned) {
    all.push_back(wheel(4000, turned));
    all.push_back(half_wheel(4000, turned, turned % 2 == 0));
  }
  return all;
}

/// A mesh on a device, and how often each kernel was launched since.
struct Searched {
  Searched(runtime::Runtime& on, const Input& input) : runtime(on), primitives(on) {
    Options options;
    options.domain = input.domain;
    result = triangulate(runtime, primitives, source_of(runtime, input.points, input.constraints), options);
    triangles.resize(result.mesh.triangles);
    std::vector<cl_uint> corners(3 * triangles.size());
    runtime.read(result.mesh.corners, corners.data(), corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) triangles[i / 3][i % 3] = corners[i];
  }
  std::vector<cl_int> locate(const std::vector<Place>& queries) {
    const Located located = derived.locate(runtime, primitives, result, stage(runtime, queries));
    std::vector<cl_int> found(queries.size());
    runtime.read(located.triangles, found.data(), found.size());
    return found;
  }
  runtime::Runtime& runtime;
  Primitives primitives;
  DeviceTriangulation result;
  Derived derived;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Points inside triangles, on edges, on vertices, outside, near hubs.
std::vector<Place> make_queries(const Input& input, const Searched& searched) {
  Random random(7);
  std::vector<Place> queries(input.points.begin(), input.points.begin() + 20);
  for (std::size_t i = 0; i < 300; ++i) {
    const auto& [a, b, c] = searched.triangles[random.below(searched.triangles.size())];
    const Place p = input.points[a], q = input.points[b], r = input.points[c];
    for (const std::int32_t near : {1, 8, 64})
      queries.push_back({p[0] + (q[0] - p[0]) / 2 / near + (r[0] - p[0]) / 3 / near,
                         p[1] + (q[1] - p[1]) / 2 / near + (r[1] - p[1]) / 3 / near});
    queries.push_back({p[0] + (q[0] - p[0]) / 2, p[1] + (q[1] - p[1]) / 2});
  }
  for (int i = 0; i < 100; ++i) queries.push_back(on_circle(1e6 + 1000, i / 100.0));
  for (const Place& hub : {input.points[0], input.points[1]})
    for (std::int32_t d = 1; d < 1 << 19; d *= 8)
      for (const Place step : {Place{d, 0}, Place{0, d}, Place{-d, 0}, Place{0, -d}, Place{d, d}, Place{-d, -d}})
        queries.push_back({hub[0] + step[0], hub[1] + step[1]});
  return queries;
}

/// Queries of an input, and where they are in its triangles, which are the same on every device.
struct Expected {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Place> queries;
  std::vector<cl_int> found;
};

void check_all(const Input& input, Searched& searched) {
  static std::map<std::string, Expected> by_name;
  const auto [at, first] = by_name.try_emplace(input.name);
  Expected& expected = at->second;
  if (first) {
    expected.triangles = searched.triangles;
    expected.queries = make_queries(input, searched);
    for (const Place& query : expected.queries)
      expected.found.push_back(found_in(input.points, searched.triangles, query));
  }
  REQUIRE(searched.triangles == expected.triangles);
  CHECK(searched.locate(expected.queries) == expected.found);
}

/// Reads the fans of a mesh whose corners are input numbers; of those, none are equal here.
void check_fans(const Input& input, Searched& searched) {
  runtime::Runtime& runtime = searched.runtime;
  const OrderedMesh& mesh = hull_mesh(searched.result);
  const Vertices& vertices = searched.result.vertices;
  PhaseCounters counters(runtime);
  counters.zero();
  const Fans fans = make_result_fans(runtime, searched.primitives, vertices, mesh, true, counters);
  CHECK(counters.read().failed == 0);
  std::vector<cl_uint> begins(std::size_t{vertices.n()} + 1), corners(std::size_t{3} * mesh.triangles),
      vertex(input.points.size());
  runtime.read(fans.begins, begins.data(), begins.size());
  runtime.read(mesh.corners, corners.data(), corners.size());
  runtime.read(vertices.input_vertex, vertex.data(), vertex.size());
  std::vector<cl_uint2> faces(begins.back());
  runtime.read(fans.faces, faces.data(), faces.size());
  std::map<std::uint32_t, std::uint32_t> degree;
  for (cl_uint& corner : corners) ++degree[corner = vertex[corner]];
  std::size_t hubs = 0;
  for (std::uint32_t v = 0; v < vertices.n(); ++v) {
    const std::uint32_t size = begins[v + 1] - begins[v];
    REQUIRE(size == (degree[v] >= GCDT_FAN_LEAST ? degree[v] : 0));
    hubs += size > 0;
    std::uint32_t gaps = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      const cl_uint2 own = faces[begins[v] + i];
      const cl_uint* c = &corners[3 * own.s[0]];
      const auto k = static_cast<std::uint32_t>(std::find(c, c + 3, v) - c);
      REQUIRE(k < 3);
      CHECK(c[(k + 1) % 3] == own.s[1]);
      if (c[(k + 2) % 3] == faces[begins[v] + (i + 1) % size].s[1]) continue;
      ++gaps;
      CHECK(i + 1 == size);  // only behind the last, where the hull is
    }
    CHECK(gaps <= 1);
  }
  CHECK(hubs == input.hubs);
}

template <class Check>
void on_all(Check&& check) {
  for (Treated& device : devices_as_all_kinds())
    for (const Input& input : inputs()) {
      CAPTURE(device.name);
      CAPTURE(input.name);
      Searched searched(*device.runtime, input);
      check(input, searched);
    }
}

}  // namespace

TEST_CASE("fans of a finished mesh are the triangles around vertices with many, in their order") { on_all(check_fans); }

TEST_CASE("queries near vertices with many triangles are in the least triangle that holds them") { on_all(check_all); }

TEST_CASE("a walk at a vertex with many triangles is short") {
  for (const cl::Device& device : every_device()) {
    std::map<std::string, int> launched;
    runtime::CallHook hook;
    hook.before = [&](const char* call, const char* detail) {
      if (std::string(call) == "clEnqueueNDRangeKernel") ++launched[detail];
      return CL_SUCCESS;
    };
    runtime::Runtime runtime(device, hook);
    CAPTURE(runtime.info().name);
    for (const Input& input : {wheel(60000, 1), half_wheel(60000, 3, true), row_between_hubs(60000)}) {
      CAPTURE(input.name);
      Searched searched(runtime, input);
      const std::vector<Place> queries = make_queries(input, searched);
      for (const int passes : {0, 1}) {
        CAPTURE(passes);
        launched.clear();
        searched.locate(queries);
        // One until the fans are made, at the first call alone. Without fans there are dozens.
        const int walks = passes == 0 ? 2 : 1;
        CHECK(launched["locate_walk"] == walks);
        CHECK(launched["fans_place"] == walks - 1);
      }
    }
  }
}

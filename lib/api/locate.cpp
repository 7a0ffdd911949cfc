// SPDX-License-Identifier: Apache-2.0
// The C interface: point location and interpolation with host arrays.
#include "api/state.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

// The most queries that are on the device at once.
constexpr std::size_t chunk = Tuning::queries_at_once;

/// One chunk of queries, back on the host.
struct Found {
  Array<cl_int> triangles;
  Array<cl_uint> corners;
  Array<cl_long> areas;
};

/// Calls use(first, found) for each chunk.
template <class Use>
void locate_all(gcdt_result& result, const Points& points, Use&& use) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::uint64_t axis = 0; axis < 2; ++axis)
      if (const double v = points.coordinate(i, static_cast<int>(axis)); !(v - v == 0))
        throw Error(Status::coordinate_not_finite,
                    std::string(axis ? "y" : "x") + " of query " + std::to_string(i) + " is not a finite number",
                    {i, axis});
  State& state = *result.state;
  state.runtime.memory().begin_call();
  Found found;
  for (std::size_t first = 0; first < points.size(); first += chunk) {
    const std::size_t count = std::min(chunk, points.size() - first);
    const Located located =
        result.derived.locate(state.runtime, state.primitives, result.data,
                              stage(state.runtime, part_of(points.type(), points.data(), first, count)));
    found.triangles.resize(count);
    found.corners.resize(3 * count);
    found.areas.resize(3 * count);
    state.runtime.read(located.triangles, found.triangles.data(), count);
    state.runtime.read(located.corners, found.corners.data(), 3 * count);
    state.runtime.read(located.areas, found.areas.data(), 3 * count);
    use(first, found);
  }
}

/// The weights of query i: the areas are exact, and so is their sum, below 2^63.
std::array<double, 3> weights_of(const Found& found, std::size_t i) {
  if (found.triangles[i] < 0) return {0, 0, 0};
  const cl_long* a = &found.areas[3 * i];
  const auto all = static_cast<double>(a[0] + a[1] + a[2]);
  return {static_cast<double>(a[0]) / all, static_cast<double>(a[1]) / all, static_cast<double>(a[2]) / all};
}

Points read_queries(int32_t coordinate_type, const void* points, uint64_t count) {
  require(points || count == 0, "points is null");
  return part_of(read_type(coordinate_type), points, 0, static_cast<std::size_t>(count));
}

}  // namespace

int32_t gcdt_locate(gcdt_result* result, int32_t coordinate_type, const void* points, uint64_t count,
                    int32_t* triangles, double* weights) {
  return guarded_call(result, [&] {
    const Points queries = read_queries(coordinate_type, points, count);
    require(triangles || count == 0, "triangles is null");
    // The caller's arrays are written only when nothing can fail any more.
    Array<cl_int> all_triangles(queries.size());
    Array<double> all_weights(weights ? 3 * queries.size() : 0);
    locate_all(*result, queries, [&](std::size_t first, const Found& found) {
      std::copy(found.triangles.begin(), found.triangles.end(),
                all_triangles.begin() + static_cast<std::ptrdiff_t>(first));
      for (std::size_t i = 0; weights && i < found.triangles.size(); ++i) {
        const auto w = weights_of(found, i);
        std::copy(w.begin(), w.end(), &all_weights[3 * (first + i)]);
      }
    });
    std::copy(all_triangles.begin(), all_triangles.end(), triangles);
    std::copy(all_weights.begin(), all_weights.end(), weights);
  });
}

int32_t gcdt_interpolate(gcdt_result* result, int32_t coordinate_type, const void* points, uint64_t count,
                         const double* vertex_values, double outside, double* values) {
  return guarded_call(result, [&] {
    const Points queries = read_queries(coordinate_type, points, count);
    require(vertex_values || result->data.representatives.size() == 0, "vertex_values is null");
    require(values || count == 0, "values is null");
    Array<double> all(queries.size());
    locate_all(*result, queries, [&](std::size_t first, const Found& found) {
      for (std::size_t i = 0; i < found.triangles.size(); ++i) {
        const auto w = weights_of(found, i);
        double value = 0;
        for (std::size_t k = 0; k < 3; ++k)
          if (w[k] != 0) value += w[k] * vertex_values[found.corners[3 * i + k]];
        all[first + i] = found.triangles[i] < 0 ? outside : value;
      }
    });
    std::copy(all.begin(), all.end(), values);
  });
}

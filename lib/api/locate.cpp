// SPDX-License-Identifier: Apache-2.0
// The C interface: point location and interpolation with host arrays.
#include "api/state.hpp"
#include "device/host_room.hpp"
#include "device/parts.hpp"
#include "device/transfer_chunks.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

// The most queries that are on the device at once.
constexpr std::size_t chunk = Tuning::queries_at_once;
// Queries that are worth a thread: some 0.1 ms of divisions.
constexpr std::size_t queries_of_a_thread = std::size_t{1} << 14;

/// Where a chunk's results go on the host, in arrays that nobody has written to before; null: not wanted.
struct Destination {
  cl_int* triangles = nullptr;
  cl_uint* corners = nullptr;
  cl_long* areas = nullptr;
};

/// Calls to(first, count) before each chunk for its destination, and use(first, count) when the results are there.
template <class To, class Use>
void locate_all(gcdt_result& result, const Points& points, To&& to, Use&& use) {
  State& state = *result.state;
  state.runtime.memory().begin_call();
  for (std::size_t first = 0; first < points.size(); first += chunk) {
    const std::size_t count = std::min(chunk, points.size() - first);
    const Located located =
        result.derived.locate(state.runtime, state.primitives, result.data,
                              stage(state.runtime, part_of(points.type(), points.data(), first, count)), first);
    const Destination there = to(first, count);
    state.runtime.read(located.triangles, there.triangles, count);
    if (there.corners) state.runtime.read(located.corners, there.corners, 3 * count);
    if (there.areas) state.runtime.read(located.areas, there.areas, 3 * count);
    use(first, count);
  }
}

template <class T>
runtime::HostRoom::Range range_of(Array<T>& array, std::size_t first, std::size_t count) {
  return {reinterpret_cast<unsigned char*>(array.data() + first), count * sizeof(T)};
}

/// Threads that make new arrays ready while queries are located.
runtime::HostRoom make_room(const runtime::Runtime& runtime, const std::vector<runtime::HostRoom::Range>& ranges) {
  std::size_t bytes = 0;
  for (const auto& range : ranges) bytes += range.bytes;
  if (!runtime::prepares_host_memory(runtime) || bytes < runtime.tuning().least_chunked) return {};
  return {ranges, runtime.tuning().room_threads};
}

/// The weights of a query: the areas are exact, and so is their sum, below 2^63.
std::array<double, 3> weights_of(cl_int triangle, const cl_long* areas) {
  if (triangle < 0) return {0, 0, 0};
  const auto all = static_cast<double>(areas[0] + areas[1] + areas[2]);
  return {static_cast<double>(areas[0]) / all, static_cast<double>(areas[1]) / all,
          static_cast<double>(areas[2]) / all};
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
    Array<cl_int> found(queries.size());
    Array<cl_long> areas(weights ? 3 * queries.size() : 0);
    runtime::HostRoom room =
        make_room(result->state->runtime, {range_of(found, 0, found.size()), range_of(areas, 0, areas.size())});
    locate_all(
        *result, queries,
        [&](std::size_t first, std::size_t some) {
          room.leave(range_of(found, first, some));
          if (weights) room.leave(range_of(areas, 3 * first, 3 * some));
          return Destination{found.data() + first, nullptr, weights ? areas.data() + 3 * first : nullptr};
        },
        [](std::size_t, std::size_t) {});
    for_each_in_threads(
        queries.size(),
        [&](std::size_t i) {
          triangles[i] = found[i];
          if (!weights) return;
          const auto w = weights_of(found[i], areas.data() + 3 * i);
          std::copy(w.begin(), w.end(), weights + 3 * i);
        },
        queries_of_a_thread);
  });
}

int32_t gcdt_interpolate(gcdt_result* result, int32_t coordinate_type, const void* points, uint64_t count,
                         const double* vertex_values, double outside, double* values) {
  return guarded_call(result, [&] {
    const Points queries = read_queries(coordinate_type, points, count);
    require(vertex_values || result->data.representatives.size() == 0, "vertex_values is null");
    require(values || count == 0, "values is null");
    Array<cl_int> found;
    Array<cl_uint> corners;
    Array<cl_long> areas;
    Array<double> all(queries.size());
    locate_all(
        *result, queries,
        [&](std::size_t, std::size_t some) {
          found.resize(some), corners.resize(3 * some), areas.resize(3 * some);
          return Destination{found.data(), corners.data(), areas.data()};
        },
        [&](std::size_t first, std::size_t some) {
          for_each_in_threads(
              some,
              [&](std::size_t i) {
                const auto w = weights_of(found[i], areas.data() + 3 * i);
                double value = 0;
                for (std::size_t k = 0; k < 3; ++k)
                  if (w[k] != 0) value += w[k] * vertex_values[corners[3 * i + k]];
                all[first + i] = found[i] < 0 ? outside : value;
              },
              queries_of_a_thread);
        });
    std::copy(all.begin(), all.end(), values);
  });
}

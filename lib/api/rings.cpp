// SPDX-License-Identifier: Apache-2.0
// The C interface: polygons as constraints.
#include <utility>

#include "api/state.hpp"
#include "exact/doubles.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

/// Offsets must ascend from 0 to `last`.
void check_offsets(const std::uint64_t* offsets, std::uint64_t count, std::uint64_t last, const char* name) {
  if (!offsets) throw Error(Status::invalid_argument, std::string(name) + " is null");
  for (std::uint64_t i = 0; i < count; ++i)
    if (offsets[i] > offsets[i + 1])
      throw Error(Status::invalid_argument,
                  std::string(name) + ": element " + std::to_string(i) + " is larger than the next one", {i});
  if (offsets[0] != 0 || offsets[count] != last)
    throw Error(Status::invalid_argument,
                std::string(name) + " must go from 0 to " + std::to_string(last) + ", not " +
                    std::to_string(offsets[0]) + " to " + std::to_string(offsets[count]),
                {offsets[0] != 0 ? 0 : count});
}

/// The sign of the area of vertices [begin, end), exactly.
int orientation(const Points& points, std::uint64_t begin, std::uint64_t end) {
  exact::ShoelaceSum sum;
  for (std::uint64_t i = begin; i < end; ++i) {
    const std::uint64_t j = i + 1 < end ? i + 1 : begin;
    sum.add({points.coordinate(i, 0), points.coordinate(i, 1)}, {points.coordinate(j, 0), points.coordinate(j, 1)});
  }
  return sum.sign();
}

void turn_around(std::uint32_t* constraints, std::uint64_t begin, std::uint64_t end) {
  for (std::uint64_t i = begin; i < end; ++i) std::swap(constraints[2 * i], constraints[2 * i + 1]);
}

}  // namespace

int32_t gcdt_ring_constraints(const gcdt_input* input, const gcdt_rings* rings, uint32_t* constraints,
                              uint64_t capacity) {
  return guarded(nullptr, [&] {
    const gcdt_rings given = read_struct(rings, "gcdt_rings");
    const gcdt_input vertices = read_struct(input, "gcdt_input");
    const Points points = read_points(vertices);
    if (points.size() > max_vertices)
      throw Error(Status::too_many_vertices, std::to_string(points.size()) + " vertices are too many to be numbered");
    check_offsets(given.ring_offsets, given.ring_count, points.size(), "gcdt_rings.ring_offsets");
    if (given.polygon_offsets)
      check_offsets(given.polygon_offsets, given.polygon_count, given.ring_count, "gcdt_rings.polygon_offsets");
    if (capacity < points.size()) throw too_small(points.size(), capacity, "constraints");
    require(constraints || points.size() == 0, "constraints is null");
    for (std::uint64_t v = 0; v < 2 * points.size() && given.polygon_offsets; ++v)
      if (const double c = points.coordinate(v / 2, v % 2); !(c - c == 0)) {
        const bool whole = points.type() == Points::Type::int64;
        throw Error(whole ? Status::coordinate_outside_grid : Status::coordinate_not_finite,
                    "a coordinate of vertex " + std::to_string(v / 2) + (whole ? " is beyond 2^53" : " is not finite"),
                    {v / 2, v % 2});
      }
    for (std::uint64_t r = 0; r < given.ring_count; ++r) {
      const std::uint64_t begin = given.ring_offsets[r], end = given.ring_offsets[r + 1];
      for (std::uint64_t v = begin; v < end; ++v) {
        constraints[2 * v] = static_cast<std::uint32_t>(v);
        constraints[2 * v + 1] = static_cast<std::uint32_t>(v + 1 < end ? v + 1 : begin);
      }
    }
    for (std::uint64_t p = 0; p < given.polygon_count && given.polygon_offsets; ++p)
      for (std::uint64_t r = given.polygon_offsets[p]; r < given.polygon_offsets[p + 1]; ++r) {
        const std::uint64_t begin = given.ring_offsets[r], end = given.ring_offsets[r + 1];
        const int wanted = r == given.polygon_offsets[p] ? 1 : -1;
        if (orientation(points, begin, end) == -wanted) turn_around(constraints, begin, end);
      }
  });
}

// SPDX-License-Identifier: Apache-2.0
#include "proof/wanted.hpp"

#include <algorithm>
#include <cmath>

namespace gcdt::proof {

namespace {

// The doubled area in cells. Who made the mesh may have rounded otherwise.
long double in_cells(double area, long double cell) { return area / (cell * cell / 2) * (1 + 1e-12L); }

std::uint32_t length_in_cells(double length, double cell) {
  constexpr double longest = 0x7fffffff;
  const double cells = std::floor(length / cell);
  return cells < 1 ? 1 : static_cast<std::uint32_t>(std::min(cells, longest));
}

}  // namespace

Shape shape_of(const Sites& sites, const std::array<std::uint32_t, 3>& corners) {
  Shape s = {sites.turn(corners[0], corners[1], corners[2]), -1, 0, 0, 0};
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vertex at = sites.at[corners[k]], from = sites.at[corners[(k + 1) % 3]], to = sites.at[corners[(k + 2) % 3]];
    const Direction u(at, from), v(at, to), across(from, to);
    const std::int64_t dot = u.x * v.x + u.y * v.y, squared = across.x * across.x + across.y * across.y;
    if (dot > s.dot) s.dot = dot, s.k = k, s.shortest = squared;
    s.longest = std::max(s.longest, squared);
  }
  return s;
}

Wanted::Wanted(const Refinement& refinement, const Grid& grid)
    : refinement_(refinement),
      cell_(grid.cell()),
      most_area_(in_cells(refinement.most_area, cell_)),
      least_(std::max(8.0L, std::ceil(refinement.least_length / cell_))) {
  constexpr long double pi = 3.141592653589793238462643383279502884L;
  // Less the last digit of the one who made the mesh.
  if (refinement.least_angle > 0)
    tangent_ = Wide(std::floor(std::ldexp(std::tan(refinement.least_angle * pi / 180), 31))) - 1;
  for (const double area : refinement.region_areas) most_areas_.push_back(in_cells(area, cell_));
}

bool Wanted::is_large(const Shape& shape, const std::array<std::uint32_t, 3>& corners, std::uint32_t seed) const {
  const auto area = static_cast<long double>(shape.area);
  if (area > most_area_ || (seed < most_areas_.size() && area > most_areas_[seed])) return true;
  if (lengths_.empty()) return false;
  // The longest side against sqrt(2) times the mean of what the corners want.
  const Wide sum = Wide(lengths_[corners[0]]) + lengths_[corners[1]] + lengths_[corners[2]];
  return 9 * Wide(shape.longest) > 2 * sum * sum;
}

std::string Wanted::find_lengths(const Sites& sites, std::uint32_t inputs, Span<std::array<std::uint32_t, 4>> origins) {
  if (refinement_.sizes.empty()) return {};
  const auto all = static_cast<std::uint32_t>(sites.at.size());
  if (origins.size() != all - inputs)
    return say("wanted lengths need the origins of all ", all - inputs, " added vertices, not of ", origins.size());
  constexpr std::uint32_t unknown = 0, waiting = none;
  for (std::uint32_t v = 0; v < inputs; ++v)
    lengths_.push_back(length_in_cells(refinement_.sizes[v], static_cast<double>(cell_)));
  lengths_.resize(all, unknown);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t first = inputs; first < all; ++first) {
    if (lengths_[first] == unknown) stack.push_back(first);
    while (!stack.empty()) {
      const std::uint32_t v = stack.back();
      const auto& origin = origins[v - inputs];
      const std::size_t before = stack.size();
      lengths_[v] = waiting;
      for (std::size_t k = 0; k < (origin[2] == none ? 2u : 3u); ++k) {
        const std::uint32_t on = origin[k];
        if (on >= all || lengths_[on] == waiting)
          return say("added vertex ", v, " has an origin, vertex ", on, ", that ",
                     on >= all ? "does not exist" : "needs it");
        if (lengths_[on] == unknown) stack.push_back(on);
      }
      if (stack.size() > before) continue;
      stack.pop_back();
      if (auto reason = find_length(sites, v, origin); !reason.empty()) return reason;
    }
  }
  return {};
}

// Linear on the triangle, or on the edge at the foot of the perpendicular, rounded down.
std::string Wanted::find_length(const Sites& sites, std::uint32_t v, const std::array<std::uint32_t, 4>& origin) {
  std::array<Wide, 3> weights = {};
  const auto& [a, b, c, piece] = origin;
  if (c != none) {
    weights = {sites.turn(b, c, v), sites.turn(c, a, v), sites.turn(a, b, v)};
    if (std::min({weights[0], weights[1], weights[2]}) < 0)
      return say("added vertex ", v, " is outside of the triangle on which it was put");
  } else {
    const Direction edge(sites.at[a], sites.at[b]), to(sites.at[a], sites.at[v]);
    const Wide whole = Wide(edge.x) * edge.x + Wide(edge.y) * edge.y, along = Wide(edge.x) * to.x + Wide(edge.y) * to.y;
    weights[1] = std::clamp(along, Wide(0), whole);
    weights[0] = whole - weights[1];
  }
  Wide sum = 0, whole = 0;
  for (std::size_t k = 0; k < (c == none ? 2u : 3u); ++k) sum += weights[k] * lengths_[origin[k]], whole += weights[k];
  if (whole == 0) return say("added vertex ", v, " was put on something without extent");
  lengths_[v] = static_cast<std::uint32_t>(sum / whole);
  return {};
}

}  // namespace gcdt::proof

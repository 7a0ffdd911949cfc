// SPDX-License-Identifier: Apache-2.0
// The C interface: values of the vertices that splitting and refinement add.
#include <algorithm>
#include <array>
#include <cmath>

#include "api/state.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

using Point = std::array<double, 2>;

/// The value on the segment between two vertices, at its point nearest to `p`, linear between the values of the two.
/// Differences are scaled by the largest one, so that their squares neither overflow nor vanish.
double value_along(const Points& points, const Constraint& constraint, const double* values, const Point& p) {
  const auto at = [&](std::uint32_t v) { return Point{points.coordinate(v, 0), points.coordinate(v, 1)}; };
  const Point a = at(constraint[0]), b = at(constraint[1]);
  const double scale = std::max(std::abs(b[0] / 2 - a[0] / 2), std::abs(b[1] / 2 - a[1] / 2));
  double along = 0, square = 0;
  for (std::size_t axis = 0; axis < 2 && scale > 0; ++axis) {
    const double whole = (b[axis] / 2 - a[axis] / 2) / scale, part = (p[axis] / 2 - a[axis] / 2) / scale;
    along += part * whole;
    square += whole * whole;
  }
  const double t = square > 0 ? std::min(1.0, std::max(0.0, along / square)) : 0.0;
  return (1 - t) * values[constraint[0]] + t * values[constraint[1]];
}

/// The input of a call, read and looked over.
struct CheckedInput {
  Points points;
  Constraints constraints;

  explicit CheckedInput(const gcdt_input* input) {
    const gcdt_input given = read_struct(input, "gcdt_input");
    points = read_points(given);
    constraints = read_constraints(given);
  }

  /// Added vertex `i` has the pair `crossing` of constraints, which must exist.
  void check_crossing(std::uint64_t i, const std::uint32_t* crossing) const {
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t c = crossing[side];
      if (c >= constraints.size())
        throw Error(Status::invalid_argument,
                    "added vertex " + std::to_string(i) + ": there is no constraint " + std::to_string(c), {i, c});
      for (const std::uint32_t v : constraints[c])
        if (v >= points.size())
          throw Error(Status::index_out_of_range,
                      "constraint " + std::to_string(c) + " has vertex " + std::to_string(v) + ", but there are " +
                          std::to_string(points.size()),
                      {c, v == constraints[c][1]});
    }
  }

  double value_at_crossing(const std::uint32_t* crossing, const double* added, const double* vertex_values) const {
    const Point p = {added[0], added[1]};
    return value_along(points, constraints[crossing[0]], vertex_values, p) / 2 +
           value_along(points, constraints[crossing[1]], vertex_values, p) / 2;
  }
};

/// Values at vertices that stand on others, which may stand on others again.
class Standing {
 public:
  Standing(const CheckedInput& given, const double* added, const std::uint32_t* crossings, const std::uint32_t* origins,
           std::uint64_t count, const double* vertex_values)
      : given_(given),
        added_(added),
        crossings_(crossings),
        origins_(origins),
        vertex_values_(vertex_values),
        states_(static_cast<std::size_t>(count), State::open),
        values_(static_cast<std::size_t>(count)) {}

  /// Of all added vertices. Ends: each is pushed at most once by each that stands on it, and once more by itself.
  const std::vector<double>& run() {
    std::vector<std::uint64_t> stack;
    for (std::uint64_t i = 0; i < states_.size(); ++i) {
      if (states_[i] == State::open) stack.push_back(i);
      while (!stack.empty()) {
        const std::uint64_t top = stack.back();
        if (states_[top] == State::open && push_open(top, stack)) continue;
        if (states_[top] != State::known) values_[top] = value_of(top);
        states_[top] = State::known;
        stack.pop_back();
      }
    }
    return values_;
  }

 private:
  enum class State : unsigned char { open, waiting, known };

  [[noreturn]] void refuse(std::uint64_t i, const std::string& why) const {
    throw Error(Status::invalid_argument, "added vertex " + std::to_string(i) + " " + why, {i});
  }
  bool is_crossing(std::uint64_t i) const { return origins_[4 * i] == UINT32_MAX; }
  std::size_t corners(std::uint64_t i) const { return origins_[4 * i + 2] == UINT32_MAX ? 2 : 3; }

  /// Pushes what vertex `i` stands on and is not known yet. Returns whether there is any.
  bool push_open(std::uint64_t i, std::vector<std::uint64_t>& stack) {
    states_[i] = State::waiting;
    if (is_crossing(i)) {
      given_.check_crossing(i, crossings_ + 2 * i);
      return false;
    }
    const std::size_t before = stack.size();
    for (std::size_t k = 0; k < corners(i); ++k) {
      const std::uint32_t v = origins_[4 * i + k];
      if (v >= given_.points.size() + states_.size()) refuse(i, "stands on a vertex that does not exist");
      if (v < given_.points.size()) continue;
      const std::uint64_t on = v - given_.points.size();
      if (states_[on] == State::waiting) refuse(i, "stands on one that stands on it");
      if (states_[on] == State::open) stack.push_back(on);
    }
    return stack.size() > before;
  }

  Point place(std::uint32_t v) const {
    if (v < given_.points.size()) return {given_.points.coordinate(v, 0), given_.points.coordinate(v, 1)};
    const double* const xy = added_ + 2 * (v - given_.points.size());
    return {xy[0], xy[1]};
  }
  double value(std::uint32_t v) const {
    return v < given_.points.size() ? vertex_values_[v] : values_[v - given_.points.size()];
  }

  /// Linear between two or three vertices, whose places are scaled to 1. Beside them, as after rounding to the grid,
  /// what is nearest on the edge; nothing is extrapolated.
  double value_of(std::uint64_t i) const {
    if (is_crossing(i)) return given_.value_at_crossing(crossings_ + 2 * i, added_ + 2 * i, vertex_values_);
    const std::uint32_t* const on = origins_ + 4 * i;
    const Point o = place(on[0]), x = {added_[2 * i], added_[2 * i + 1]};
    double scale = 0;
    for (std::size_t k = 1; k < corners(i); ++k)
      for (std::size_t axis = 0; axis < 2; ++axis)
        scale = std::max(scale, std::abs(place(on[k])[axis] / 2 - o[axis] / 2));
    if (scale == 0) return value(on[0]);
    const auto from_first = [&](const Point& p) {
      return Point{(p[0] / 2 - o[0] / 2) / scale, (p[1] / 2 - o[1] / 2) / scale};
    };
    const Point b = from_first(place(on[1])), m = from_first(x);
    if (corners(i) == 2) {
      const double t = std::clamp((m[0] * b[0] + m[1] * b[1]) / (b[0] * b[0] + b[1] * b[1]), 0.0, 1.0);
      return (1 - t) * value(on[0]) + t * value(on[1]);
    }
    const Point c = from_first(place(on[2]));
    const double whole = b[0] * c[1] - b[1] * c[0];
    if (whole == 0) return value(on[0]);
    const double at_b = std::max(0.0, (m[0] * c[1] - m[1] * c[0]) / whole),
                 at_c = std::max(0.0, (b[0] * m[1] - b[1] * m[0]) / whole), at_o = std::max(0.0, 1 - at_b - at_c);
    return (at_o * value(on[0]) + at_b * value(on[1]) + at_c * value(on[2])) / (at_o + at_b + at_c);
  }

  const CheckedInput& given_;
  const double* added_;
  const std::uint32_t* crossings_;
  const std::uint32_t* origins_;
  const double* vertex_values_;
  std::vector<State> states_;
  std::vector<double> values_;
};

}  // namespace

int32_t gcdt_added_values(const gcdt_input* input, const double* added, const uint32_t* crossings, uint64_t count,
                          const double* vertex_values, double* values) {
  return guarded(nullptr, [&] {
    const CheckedInput given(input);
    require((added && crossings && values) || count == 0, "added, crossings or values is null");
    require(vertex_values || given.points.size() == 0, "vertex_values is null");
    for (std::uint64_t i = 0; i < count; ++i) given.check_crossing(i, crossings + 2 * i);
    for (std::uint64_t i = 0; i < count; ++i)
      values[i] = given.value_at_crossing(crossings + 2 * i, added + 2 * i, vertex_values);
  });
}

int32_t gcdt_refined_values(const gcdt_input* input, const double* added, const uint32_t* crossings,
                            const uint32_t* origins, uint64_t count, const double* vertex_values, double* values) {
  return guarded(nullptr, [&] {
    const CheckedInput given(input);
    require((added && crossings && origins && values) || count == 0, "added, crossings, origins or values is null");
    require(vertex_values || given.points.size() == 0, "vertex_values is null");
    Standing standing(given, added, crossings, origins, count, vertex_values);
    const std::vector<double>& all = standing.run();
    std::copy(all.begin(), all.end(), values);
  });
}

// SPDX-License-Identifier: Apache-2.0
// The signs of orient2d and incircle of doubles, exact over all of their range, and quotients rounded to doubles.
#pragma once

#include <array>

#include "exact/integer.hpp"

namespace gcdt::exact {

using Point = std::array<double, 2>;  ///< finite

/// 1: a, b, c turn left; -1: right; 0: on a line.
int orient2d(const Point& a, const Point& b, const Point& c);

/// 1: d is inside the circle through a, b, c, which turn left; 0: on it; -1: outside.
int incircle(const Point& a, const Point& b, const Point& c, const Point& d);

/// The double nearest to number * 2^unit / divisor, half to even.
double nearest_double(const Natural& number, int unit, std::uint64_t divisor);

/// Twice the area of a polygon, edge by edge, whatever the sizes of its coordinates.
class ShoelaceSum {
 public:
  void add(const Point& a, const Point& b);
  int sign() const;

 private:
  Integer sum_;   // in units of 2^unit_
  int unit_ = 0;  // of the finest product so far
  bool empty_ = true;
};

}  // namespace gcdt::exact

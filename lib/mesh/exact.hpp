// SPDX-License-Identifier: Apache-2.0
// Integers without a bound, the signs of orient2d and incircle of doubles, exact over all of their range, and quotients
// rounded to doubles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace gcdt::exact {

/// Sign and magnitude; the magnitude has no leading zeros, and 0 no sign.
class Integer {
 public:
  Integer() = default;
  Integer(bool negative, std::uint64_t magnitude, int shift);  ///< (-1)^negative * magnitude * 2^shift, shift >= 0

  int sign() const { return words_.empty() ? 0 : negative_ ? -1 : 1; }
  friend Integer operator+(const Integer& a, const Integer& b);
  friend Integer operator-(const Integer& a, const Integer& b);
  friend Integer operator*(const Integer& a, const Integer& b);

 private:
  using Words = std::vector<std::uint32_t>;
  Integer(bool negative, Words words);
  static int compare(const Words& a, const Words& b);
  static Words add(const Words& a, const Words& b);
  static Words subtract(const Words& a, const Words& b);  // a >= b

  bool negative_ = false;
  Words words_;  // least first
};

using Point = std::array<double, 2>;  ///< finite

/// 1: a, b, c turn left; -1: right; 0: on a line.
int orient2d(const Point& a, const Point& b, const Point& c);

/// 1: d is inside the circle through a, b, c, which turn left; 0: on it; -1: outside.
int incircle(const Point& a, const Point& b, const Point& c, const Point& d);

/// The double nearest to number * 2^unit / divisor, half to even; number >= 0.
double nearest_double(const Integer& number, int unit, std::uint64_t divisor);

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

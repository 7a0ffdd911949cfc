// SPDX-License-Identifier: Apache-2.0
#include "exact/doubles.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>

namespace gcdt::exact {

Dyadic dyadic(double v) {
  std::uint64_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  const std::uint64_t fraction = bits & ((1ull << 52) - 1);
  const int exponent = static_cast<int>(bits >> 52 & 0x7ff);
  Dyadic d;
  d.mantissa = exponent == 0 ? fraction : fraction | 1ull << 52;
  d.exponent = (exponent == 0 ? 1 : exponent) - 1075;
  d.negative = bits >> 63 && d.mantissa != 0;
  return d;
}

namespace {

/// The coordinates as integers in one unit, a power of two.
template <std::size_t N>
std::array<Integer, 2 * N> scaled(const std::array<Point, N>& points) {
  int unit = std::numeric_limits<int>::max();
  for (const Point& p : points)
    for (const double v : p)
      if (v != 0) unit = std::min(unit, dyadic(v).exponent);
  std::array<Integer, 2 * N> result;
  for (std::size_t i = 0; i < 2 * N; ++i) result[i] = dyadic(points[i / 2][i % 2]).in_units(unit);
  return result;
}

constexpr double epsilon = std::numeric_limits<double>::epsilon() / 2;

/// Within these, no product of four differences overflows, and none that matters underflows.
bool ordinary(double v) { return v == 0 || (std::fabs(v) > 1e-60 && std::fabs(v) < 1e60); }

}  // namespace

// The bound of rounding errors is Shewchuk's (Adaptive Precision Floating-Point Arithmetic, 1997, section 4), doubled.
int orient2d(const Point& a, const Point& b, const Point& c) {
  const double ax = a[0] - c[0], ay = a[1] - c[1], bx = b[0] - c[0], by = b[1] - c[1];
  if (ordinary(ax) && ordinary(ay) && ordinary(bx) && ordinary(by)) {
    const double left = ax * by, right = ay * bx, value = left - right;
    const double bound = 8 * epsilon * (std::fabs(left) + std::fabs(right));
    if (value > bound) return 1;
    if (value < -bound) return -1;
  }
  const auto v = scaled<3>({a, b, c});
  return ((v[0] - v[4]) * (v[3] - v[5]) - (v[1] - v[5]) * (v[2] - v[4])).sign();
}

int incircle(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double ax = a[0] - d[0], ay = a[1] - d[1], bx = b[0] - d[0], by = b[1] - d[1], cx = c[0] - d[0],
               cy = c[1] - d[1];
  if (ordinary(ax) && ordinary(ay) && ordinary(bx) && ordinary(by) && ordinary(cx) && ordinary(cy)) {
    const double la = ax * ax + ay * ay, lb = bx * bx + by * by, lc = cx * cx + cy * cy;
    const double value = la * (bx * cy - by * cx) + lb * (cx * ay - cy * ax) + lc * (ax * by - ay * bx);
    const double size = la * (std::fabs(bx * cy) + std::fabs(by * cx)) +
                        lb * (std::fabs(cx * ay) + std::fabs(cy * ax)) + lc * (std::fabs(ax * by) + std::fabs(ay * bx));
    const double bound = 24 * epsilon * size;
    if (value > bound) return 1;
    if (value < -bound) return -1;
  }
  const auto v = scaled<4>({a, b, c, d});
  const Integer px = v[0] - v[6], py = v[1] - v[7], qx = v[2] - v[6], qy = v[3] - v[7], rx = v[4] - v[6],
                ry = v[5] - v[7];
  return ((px * px + py * py) * (qx * ry - qy * rx) + (qx * qx + qy * qy) * (rx * py - ry * px) +
          (rx * rx + ry * ry) * (px * qy - py * qx))
      .sign();
}

// Positive doubles are in the order of their bits: bisection for the largest that is not above.
double nearest_double(const Natural& number, int unit, std::uint64_t divisor) {
  const int least = std::numeric_limits<double>::min_exponent - std::numeric_limits<double>::digits;
  const int base = std::min(unit, least);
  const Natural wanted = number << (unit - base), over = divisor;
  const auto from_bits = [](std::uint64_t bits) {
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  };
  const auto scaled = [&](std::uint64_t bits) { return over * dyadic(from_bits(bits)).in_units(base).size(); };
  std::uint64_t low = 0, high = std::uint64_t{0x7ff} << 52;  // not above; above
  while (high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    (wanted < scaled(middle) ? high : low) = middle;
  }
  if (high == std::uint64_t{0x7ff} << 52) return from_bits(low);
  const Natural twice = wanted + wanted, ends = scaled(low) + scaled(high);
  return from_bits(ends < twice || (ends == twice && (low & 1) != 0) ? high : low);
}

void ShoelaceSum::add(const Point& a, const Point& b) {
  for (const auto& [u, v, minus] : {std::tuple(a[0], b[1], false), std::tuple(a[1], b[0], true)}) {
    if (u == 0 || v == 0) continue;
    const Dyadic p = dyadic(u), q = dyadic(v);
    const int unit = p.exponent + q.exponent;
    if (empty_) unit_ = unit;
    empty_ = false;
    if (unit < unit_) {
      sum_ = sum_ << (unit_ - unit);
      unit_ = unit;
    }
    const Integer product = p.in_units(p.exponent) * q.in_units(q.exponent) << (unit - unit_);
    sum_ = minus ? sum_ - product : sum_ + product;
  }
}

int ShoelaceSum::sign() const { return sum_.sign(); }

}  // namespace gcdt::exact

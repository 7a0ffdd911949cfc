// SPDX-License-Identifier: Apache-2.0
#include "mesh/exact.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>

namespace gcdt::exact {

Integer::Integer(bool negative, std::uint64_t magnitude, int shift) : negative_(negative && magnitude != 0) {
  if (magnitude == 0) return;
  words_.assign(static_cast<std::size_t>(shift / 32), 0);
  const int up = shift % 32;
  std::uint64_t carry = 0;
  for (int i = 0; i < 3; ++i, magnitude >>= 32) {
    carry |= (magnitude & 0xffffffffu) << up;
    words_.push_back(static_cast<std::uint32_t>(carry));
    carry >>= 32;
  }
  while (words_.back() == 0) words_.pop_back();
}

Integer::Integer(bool negative, Words words) : negative_(negative), words_(std::move(words)) {
  while (!words_.empty() && words_.back() == 0) words_.pop_back();
  if (words_.empty()) negative_ = false;
}

int Integer::compare(const Words& a, const Words& b) {
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  for (std::size_t i = a.size(); i-- > 0;)
    if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
  return 0;
}

Integer::Words Integer::add(const Words& a, const Words& b) {
  Words sum(std::max(a.size(), b.size()) + 1);
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    carry += (i < a.size() ? std::uint64_t{a[i]} : 0) + (i < b.size() ? b[i] : 0);
    sum[i] = static_cast<std::uint32_t>(carry);
    carry >>= 32;
  }
  return sum;
}

Integer::Words Integer::subtract(const Words& a, const Words& b) {
  Words rest(a.size());
  std::uint64_t borrow = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::uint64_t difference = std::uint64_t{a[i]} - (i < b.size() ? b[i] : 0) - borrow;
    rest[i] = static_cast<std::uint32_t>(difference);
    borrow = difference >> 63;
  }
  return rest;
}

Integer operator+(const Integer& a, const Integer& b) {
  if (a.negative_ == b.negative_) return {a.negative_, Integer::add(a.words_, b.words_)};
  if (Integer::compare(a.words_, b.words_) >= 0) return {a.negative_, Integer::subtract(a.words_, b.words_)};
  return {b.negative_, Integer::subtract(b.words_, a.words_)};
}

Integer operator-(const Integer& a, const Integer& b) {
  return a + Integer(!b.negative_ && !b.words_.empty(), b.words_);
}

Integer operator*(const Integer& a, const Integer& b) {
  Integer::Words product(a.words_.size() + b.words_.size(), 0);
  for (std::size_t i = 0; i < a.words_.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < b.words_.size() || carry != 0; ++j) {
      carry += product[i + j] + (j < b.words_.size() ? std::uint64_t{a.words_[i]} * b.words_[j] : 0);
      product[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
  }
  return {a.negative_ != b.negative_, std::move(product)};
}

namespace {

/// m * 2^e with |m| < 2^53 an integer.
struct Dyadic {
  std::int64_t m;
  int e;
};

Dyadic dyadic(double v) {
  int e = 0;
  const double fraction = std::frexp(v, &e);
  return {static_cast<std::int64_t>(std::ldexp(fraction, 53)), e - 53};
}

/// The coordinates as integers in one unit, a power of two.
template <std::size_t N>
std::array<Integer, 2 * N> scaled(const std::array<Point, N>& points) {
  int unit = std::numeric_limits<int>::max();
  for (const Point& p : points)
    for (const double v : p)
      if (v != 0) unit = std::min(unit, dyadic(v).e);
  std::array<Integer, 2 * N> result;
  for (std::size_t i = 0; i < 2 * N; ++i) {
    const double v = points[i / 2][i % 2];
    if (v == 0) continue;
    const Dyadic d = dyadic(v);
    result[i] = Integer(d.m < 0, static_cast<std::uint64_t>(d.m < 0 ? -d.m : d.m), d.e - unit);
  }
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
double nearest_double(const Integer& number, int unit, std::uint64_t divisor) {
  const int least = std::numeric_limits<double>::min_exponent - std::numeric_limits<double>::digits - 1;  // of halves
  const int base = std::min(unit, least);
  const Integer wanted = number * Integer(false, 1, unit - base), over(false, divisor, 0);
  const auto from_bits = [](std::uint64_t bits) {
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  };
  const auto scaled = [&](double value) {
    if (value == 0) return Integer();
    const Dyadic d = dyadic(value);
    const auto m = static_cast<std::uint64_t>(d.m);
    const int trailing = std::max(0, least - d.e);  // of a denormal: zeros
    return over * Integer(false, m >> trailing, d.e + trailing - base);
  };
  std::uint64_t low = 0, high = std::uint64_t{0x7ff} << 52;  // not above; above
  while (high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    ((scaled(from_bits(middle)) - wanted).sign() > 0 ? high : low) = middle;
  }
  if (high == std::uint64_t{0x7ff} << 52) return from_bits(low);
  const int beyond_half = (wanted + wanted - scaled(from_bits(low)) - scaled(from_bits(high))).sign();
  return from_bits(beyond_half > 0 || (beyond_half == 0 && (low & 1) != 0) ? high : low);
}

void ShoelaceSum::add(const Point& a, const Point& b) {
  for (const auto& [u, v, minus] : {std::tuple(a[0], b[1], false), std::tuple(a[1], b[0], true)}) {
    if (u == 0 || v == 0) continue;
    const Dyadic p = dyadic(u), q = dyadic(v);
    const int unit = p.e + q.e;
    if (empty_) unit_ = unit;
    empty_ = false;
    if (unit < unit_) {
      sum_ = sum_ * Integer(false, 1, unit_ - unit);
      unit_ = unit;
    }
    const auto size = [](std::int64_t m) { return static_cast<std::uint64_t>(m < 0 ? -m : m); };
    const Integer product = Integer(p.m < 0, size(p.m), unit - unit_) * Integer(q.m < 0, size(q.m), 0);
    sum_ = minus ? sum_ - product : sum_ + product;
  }
}

int ShoelaceSum::sign() const { return sum_.sign(); }

}  // namespace gcdt::exact

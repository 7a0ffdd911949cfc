// SPDX-License-Identifier: Apache-2.0
// Integers without a bound, for solver and proof; the proof's tests compare with another library's.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace gcdt::exact {

class Natural {
 public:
  Natural() = default;
  template <class Unsigned>
  Natural(Unsigned v) {
    for (; v != 0; v = v >> 16 >> 16) words_.push_back(static_cast<std::uint32_t>(v));
  }

  friend int bit_length(const Natural& v) {
    int bits = 32 * v.size();
    while (bits > 0 && !(v.word((bits - 1) / 32) >> (bits - 1) % 32 & 1)) --bits;
    return bits;
  }

  /// Bits [shift, shift + 64).
  friend std::uint64_t bits_from(const Natural& v, int shift) {
    const int first = shift / 32, offset = shift % 32;
    const std::uint64_t two = std::uint64_t(v.word(first + 1)) << 32 | v.word(first);
    return offset == 0 ? two : two >> offset | std::uint64_t(v.word(first + 2)) << (64 - offset);
  }

  /// Is one of the lowest `count` bits set?
  friend bool any_below(const Natural& v, int count) {
    for (int i = 0; 32 * i < std::min(count, 32 * v.size()); ++i)
      if (const int left = count - 32 * i; v.word(i) & (left >= 32 ? ~0u : (1u << left) - 1)) return true;
    return false;
  }

  friend Natural operator<<(const Natural& a, int shift) {
    Natural result;
    if (a.size() == 0) return result;
    const int skip = shift / 32, offset = shift % 32;
    for (int i = 0; i < a.size() + skip + 1; ++i) {
      const std::uint64_t two = std::uint64_t(a.word(i - skip)) << 32 | a.word(i - skip - 1);
      result.words_.push_back(static_cast<std::uint32_t>(two >> (32 - offset)));
    }
    return result.trim();
  }

  friend Natural operator*(const Natural& a, const Natural& b) {
    Natural result;
    result.words_.assign(a.words_.size() + b.words_.size(), 0);
    for (int i = 0; i < a.size(); ++i) {
      std::uint64_t carry = 0;
      for (int j = 0; j < b.size() || carry != 0; ++j) {
        std::uint32_t& at = result.words_[static_cast<std::size_t>(i + j)];
        carry += at + std::uint64_t{a.word(i)} * b.word(j);
        at = static_cast<std::uint32_t>(carry);
        carry >>= 32;
      }
    }
    return result.trim();
  }

  friend Natural operator+(const Natural& a, const Natural& b) {
    Natural result;
    std::uint64_t carry = 0;
    for (int i = 0; i < std::max(a.size(), b.size()) || carry != 0; ++i) {
      carry += std::uint64_t{a.word(i)} + b.word(i);
      result.words_.push_back(static_cast<std::uint32_t>(carry));
      carry >>= 32;
    }
    return result;
  }

  /// b must not be larger.
  friend Natural operator-(const Natural& a, const Natural& b) {
    Natural result;
    std::uint64_t borrow = 0;
    for (int i = 0; i < a.size(); ++i) {
      const std::uint64_t difference = std::uint64_t{a.word(i)} - b.word(i) - borrow;
      result.words_.push_back(static_cast<std::uint32_t>(difference));
      borrow = difference >> 63;
    }
    return result.trim();
  }

  friend bool operator<(const Natural& a, const Natural& b) {
    if (a.size() != b.size()) return a.size() < b.size();
    return std::lexicographical_compare(a.words_.rbegin(), a.words_.rend(), b.words_.rbegin(), b.words_.rend());
  }
  friend bool operator>(const Natural& a, const Natural& b) { return b < a; }
  friend bool operator==(const Natural& a, const Natural& b) { return a.words_ == b.words_; }
  friend bool operator!=(const Natural& a, const Natural& b) { return !(a == b); }

 private:
  int size() const { return static_cast<int>(words_.size()); }
  std::uint32_t word(int i) const { return i >= 0 && i < size() ? words_[static_cast<std::size_t>(i)] : 0; }
  Natural& trim() {
    while (!words_.empty() && words_.back() == 0) words_.pop_back();
    return *this;
  }

  std::vector<std::uint32_t> words_;  // least first, without leading zeros
};

/// The quotient, which must be less than 2^64, and the remainder in `v`: schoolbook, bit by bit.
inline std::uint64_t divide(Natural& v, const Natural& by) {
  std::uint64_t quotient = 0;
  for (int shift = bit_length(v) - bit_length(by); shift >= 0; --shift) {
    const Natural part = by << shift;
    quotient <<= 1;
    if (v < part) continue;
    v = v - part;
    quotient |= 1;
  }
  return quotient;
}

class Integer {
 public:
  Integer() = default;
  Integer(bool negative, Natural size) : negative_(negative), size_(std::move(size)) {}

  int sign() const { return size_ == Natural() ? 0 : negative_ ? -1 : 1; }
  const Natural& size() const { return size_; }  ///< without its sign
  friend Integer operator+(const Integer& a, const Integer& b) {
    if (a.negative_ == b.negative_) return {a.negative_, a.size_ + b.size_};
    if (a.size_ < b.size_) return {b.negative_, b.size_ - a.size_};
    return {a.negative_, a.size_ - b.size_};
  }
  friend Integer operator-(const Integer& a, const Integer& b) { return a + Integer(!b.negative_, b.size_); }
  friend Integer operator*(const Integer& a, const Integer& b) {
    return {a.negative_ != b.negative_, a.size_ * b.size_};
  }
  friend Integer operator<<(const Integer& a, int shift) { return {a.negative_, a.size_ << shift}; }

 private:
  bool negative_ = false;
  Natural size_;
};

/// The value (-1)^negative * mantissa * 2^exponent of a finite double; zero has mantissa 0 and no sign.
struct Dyadic {
  bool negative = false;
  std::uint64_t mantissa = 0;
  int exponent = 0;

  /// In units of 2^unit, which must not be more than 2^exponent.
  Integer in_units(int unit) const { return {negative, Natural(mantissa) << (exponent - unit)}; }
};
Dyadic dyadic(double v);

}  // namespace gcdt::exact

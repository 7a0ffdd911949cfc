// SPDX-License-Identifier: Apache-2.0
// Natural numbers up to 3072 bits: what differences of doubles, measured in cells, need at most (grid.cpp).
#pragma once

#include <algorithm>
#include <cassert>

#include "proof/wide.hpp"

namespace gcdt::proof {

class Big {
 public:
  Big(UWide v = 0) {
    for (; v != 0; v >>= 32) words_[size_++] = static_cast<std::uint32_t>(v);
  }

  int bits() const { return size_ == 0 ? 0 : 32 * (size_ - 1) + bit_length(std::uint64_t(words_[size_ - 1])); }

  /// Bits [shift, shift + 64).
  std::uint64_t window(int shift) const {
    const int first = shift / 32, offset = shift % 32;
    UWide three = 0;
    for (int i = 2; i >= 0; --i) three = three << 32 | word(first + i);
    return static_cast<std::uint64_t>(three >> offset);
  }

  bool any_below(int count) const {
    for (int i = 0; i < size_ && 32 * i < count; ++i) {
      const int left = count - 32 * i;
      const std::uint32_t mask = left >= 32 ? ~0u : (1u << left) - 1;
      if (words_[i] & mask) return true;
    }
    return false;
  }

  int compare(const Big& other) const {
    if (size_ != other.size_) return size_ < other.size_ ? -1 : 1;
    for (int i = size_ - 1; i >= 0; --i)
      if (words_[i] != other.words_[i]) return words_[i] < other.words_[i] ? -1 : 1;
    return 0;
  }

  Big operator<<(int shift) const {
    Big result;
    if (size_ == 0) return result;
    const int skip = shift / 32, offset = shift % 32;
    assert(bits() + shift <= 32 * capacity);
    result.size_ = std::min(size_ + skip + 1, capacity);
    for (int i = 0; i < result.size_; ++i) {
      const std::uint64_t two = std::uint64_t(word(i - skip)) << 32 | word(i - skip - 1);
      result.words_[i] = static_cast<std::uint32_t>(two >> (32 - offset));
    }
    return result.trim();
  }

  Big operator>>(int shift) const {
    Big result;
    const int skip = shift / 32, offset = shift % 32;
    for (int i = 0; i + skip < size_; ++i) {
      const std::uint64_t two = std::uint64_t(word(i + skip + 1)) << 32 | word(i + skip);
      result.words_[result.size_++] = static_cast<std::uint32_t>(two >> offset);
    }
    return result.trim();
  }

  Big operator*(std::uint64_t factor) const {
    Big result;
    UWide carry = 0;
    for (int i = 0; i < size_ || carry != 0; ++i) {
      assert(i < capacity);
      carry += UWide(word(i)) * factor;
      result.words_[result.size_++] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    return result.trim();
  }

  Big operator+(const Big& other) const {
    Big result;
    std::uint64_t carry = 0;
    for (int i = 0; i < std::max(size_, other.size_) || carry; ++i) {
      assert(i < capacity);
      carry += std::uint64_t(word(i)) + other.word(i);
      result.words_[result.size_++] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    return result;
  }

  /// The difference; `other` must not be larger.
  Big operator-(const Big& other) const {
    Big result;
    std::uint64_t borrow = 0;
    for (int i = 0; i < size_; ++i) {
      const std::uint64_t difference = std::uint64_t(words_[i]) - other.word(i) - borrow;
      result.words_[result.size_++] = static_cast<std::uint32_t>(difference);
      borrow = difference >> 63;
    }
    return result.trim();
  }

 private:
  static constexpr int capacity = 96;

  std::uint32_t word(int i) const { return i >= 0 && i < size_ ? words_[i] : 0; }
  Big& trim() {
    while (size_ > 0 && words_[size_ - 1] == 0) --size_;
    return *this;
  }

  std::uint32_t words_[capacity];
  int size_ = 0;
};

inline bool operator<(const Big& a, const Big& b) { return a.compare(b) < 0; }
inline bool operator>(const Big& a, const Big& b) { return a.compare(b) > 0; }
inline bool operator==(const Big& a, const Big& b) { return a.compare(b) == 0; }
inline bool operator!=(const Big& a, const Big& b) { return a.compare(b) != 0; }
inline int bit_length(const Big& v) { return v.bits(); }
inline std::uint64_t bits_from(const Big& v, int shift) { return v.window(shift); }
inline bool any_below(const Big& v, int count) { return v.any_below(count); }

/// The quotient, which must be less than 2^64, and the remainder in `v`: schoolbook, bit by bit.
inline std::uint64_t divide(Big& v, const Big& by) {
  std::uint64_t quotient = 0;
  for (int shift = v.bits() - by.bits(); shift >= 0; --shift) {
    const Big part = by << shift;
    quotient <<= 1;
    if (!(v < part)) {
      v = v - part;
      quotient |= 1;
    }
  }
  return quotient;
}

}  // namespace gcdt::proof

// SPDX-License-Identifier: Apache-2.0
// The 128-bit integers of the proof, and their few operations; a compiler without them needs only this file replaced.
#pragma once

#include <cstdint>

#if !defined(__SIZEOF_INT128__)
#error "verify needs 128-bit integers: give Wide and UWide a class with + - * / % << >> and comparisons here"
#endif

namespace gcdt::proof {

__extension__ typedef __int128 Wide;
__extension__ typedef unsigned __int128 UWide;

inline int bit_length(std::uint64_t v) {
  int bits = 0;
  for (int step = 32; step > 0; step /= 2)
    if (v >> step) {
      v >>= step;
      bits += step;
    }
  return bits + static_cast<int>(v);
}

inline int bit_length(UWide v) {
  const auto high = static_cast<std::uint64_t>(v >> 64);
  return high ? 64 + bit_length(high) : bit_length(static_cast<std::uint64_t>(v));
}

/// Bits [shift, shift + 64) of v; `shift` in [0, 128).
inline std::uint64_t bits_from(UWide v, int shift) { return static_cast<std::uint64_t>(v >> shift); }

/// True if one of the lowest `count` bits is set; `count` in [0, 128).
inline bool any_below(UWide v, int count) { return (v & ((UWide(1) << count) - 1)) != 0; }

/// The quotient, and the remainder in `v`.
inline std::uint64_t divide(UWide& v, UWide by) {
  const UWide quotient = v / by;
  v -= quotient * by;
  return static_cast<std::uint64_t>(quotient);
}

}  // namespace gcdt::proof

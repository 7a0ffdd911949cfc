// SPDX-License-Identifier: Apache-2.0
// What a device gives back and the host then uses as an index or a size: it is held against its bound first, so that a
// device that computes wrongly, or whose memory or transfers do, ends in an error. Whether numbers within their bounds
// are right, the checks of meshes say (docs/scale.md).
#pragma once

#include <string>

#include "device/parts.hpp"
#include "mesh/grid.hpp"

namespace gcdt::tiles {

/// Throws check_failed: `what` is wrong with what a device has given back.
[[noreturn]] inline void refuse(const char* what) { throw Error(Status::check_failed, std::string("tiles: ") + what); }

/// Up to so many are looked at before threads would have begun.
constexpr std::size_t checked_by_one = std::size_t{1} << 16;

/// Throws check_failed unless fits(i) for each i below `count`.
template <class Fits>
void check_each(std::size_t count, const char* what, Fits&& fits) {
  if (count > checked_by_one) {
    if (count_in_threads(count, [&](std::size_t i) { return !fits(i); }) != 0) refuse(what);
    return;
  }
  for (std::size_t i = 0; i < count; ++i)
    if (!fits(i)) refuse(what);
}

/// Throws check_failed unless all numbers are below `end`.
template <class Numbers>
void check_below(const Numbers& numbers, std::uint64_t end, const char* what) {
  check_each(numbers.size(), what, [&](std::size_t i) { return numbers[i] < end; });
}
/// The same of pairs.
template <class Pairs>
void check_ends_below(const Pairs& pairs, std::uint64_t end, const char* what) {
  check_each(pairs.size(), what, [&](std::size_t i) { return pairs[i][0] < end && pairs[i][1] < end; });
}

/// Throws check_failed unless offsets of `count` lists in an array of `all` elements begin with 0, end with `all`, and
/// do not fall.
template <class Offsets>
void check_offsets(const Offsets& offsets, std::size_t count, std::size_t all, const char* what) {
  if (offsets.size() != count + 1 || offsets[0] != 0 || offsets[count] != all) refuse(what);
  check_each(count, what, [&](std::size_t i) { return offsets[i] <= offsets[i + 1]; });
}

/// Throws check_failed unless `before`, of the final triangles that come before each of the seam's, does not fall, and
/// ends with `finals` at the most.
inline void check_before(const std::vector<std::uint32_t>& before, std::uint32_t finals) {
  check_each(before.size(), "a triangle of the seam has no place among the final ones",
             [&](std::size_t i) { return before[i] <= (i + 1 < before.size() ? before[i + 1] : finals); });
}

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
// Final triangles that have been spilled, and how the host writes them to their places in the result.
#pragma once

#include "tiles/final.hpp"
#include "tiles/placed.hpp"

namespace gcdt::tiles {

/// How many of the seam's triangles come before each final one of a tile: a step function.
class Shifts {
 public:
  /// `before`: how many of `finals` final triangles come before each of the seam's. Must outlive the object. Throws
  /// check_failed unless they ascend, and there are so many.
  Shifts(const std::vector<std::uint32_t>& before, std::uint32_t finals);

  std::uint32_t finals() const { return finals_; }
  std::uint32_t at(std::uint32_t final) const {
    const std::uint32_t bucket = final / of_bucket;
    return static_cast<std::uint32_t>(
        std::upper_bound(before_.begin() + firsts_[bucket], before_.begin() + firsts_[bucket + 1], final) -
        before_.begin());
  }
  /// The final triangles before which just `shift` of the seam's come: the first one, and the first behind them.
  std::uint32_t begin_of(std::uint32_t shift) const { return shift == 0 ? 0 : before_[shift - 1]; }
  std::uint32_t end_of(std::uint32_t shift) const { return shift < before_.size() ? before_[shift] : finals_; }

 private:
  static constexpr std::uint32_t of_bucket = 256;
  const std::vector<std::uint32_t>& before_;
  std::uint32_t finals_;
  /// By bucket of final triangles, and of all: how many of the seam's come before its first one, or fewer.
  std::vector<std::uint32_t> firsts_;
};

/// A tile whose final triangles are to be written.
struct ToWrite {
  FinalTriangles& final;
  const TilePlaces& places;
  Berth to;                            ///< behind it: see write_tile()
  std::vector<std::uint32_t>& before;  ///< set to what write_tile() returns
};

/// Writes tiles that are spilled, of which those in the result's arrays come in their order. What was spilled is gone
/// afterwards.
void write_spilled(const GridInput& input, const std::vector<ToWrite>& tiles);

}  // namespace gcdt::tiles

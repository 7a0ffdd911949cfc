// SPDX-License-Identifier: Apache-2.0
// The rules of a refinement as the device wants them: integers, the same on every host (kernels/refine/refine.h).
#pragma once

#include <cstdint>

#include "refine/refine.h"

namespace gcdt {

/// Angles that can be asked for, in millionths of a degree.
constexpr std::uint32_t least_refined_angle = 1000000, most_refined_angle = 34000000;

/// Sides have so many cells at least, so that places and targets can be rounded.
constexpr std::uint32_t least_refined_side = 8;

/// A ratio of sine and cosine of an angle, both in units of 2^-56.
struct SineCosine {
  std::int64_t sine, cosine;
};

/// Of an angle in millionths of a degree, 0 to 90 degrees, by integers alone: no host has its own last digit. Off by
/// less than 2^-50.
SineCosine sine_cosine(std::uint32_t millionths);

/// floor(2^bits numerator / denominator + 1/2), for 0 < denominator < 2^62, 0 <= numerator < 2^62.
std::uint64_t rounded_ratio(std::int64_t numerator, std::int64_t denominator, unsigned bits);

/// Rules for the least angle, in millionths of a degree from least_refined_angle to most_refined_angle, and for sides
/// no shorter than `least_length` cells. Nothing else is wanted.
device::RefineRules refine_rules(std::uint32_t millionths, std::uint32_t least_length = least_refined_side);

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// What tests of refinement ask for.
#pragma once

#include <cmath>

#include <gcdt/types.hpp>

namespace gcdt::test {

inline Refinement refinement(double angle = 20, double area = HUGE_VAL) {
  Refinement wanted;
  wanted.least_angle = angle;
  wanted.most_area = area;
  return wanted;
}

inline Options refining(double angle = 20) {
  Options options;
  options.refine = refinement(angle);
  return options;
}

/// Of integers, as they are given; of crossings the first stays.
inline Options refining_on_grid(double angle = 20) {
  Options options = refining(angle);
  options.grid = FixedGrid{};
  options.crossing = Crossing::drop;
  return options;
}

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
// The histogram of least angles below a picture: where its bars and numbers stand.
#pragma once

#include "region_borders.hpp"

namespace gcdt::io {

struct HistogramBar {
  double x = 0, y = 0, width = 0, height = 0;
  std::uint32_t colour = 0;
};

/// In units of a canvas, of which it has the width.
struct Histogram {
  static constexpr double bars_high = 0.08 * Canvas::longer_side, numbers_high = 0.012 * Canvas::longer_side,
                          gap = 0.008 * Canvas::longer_side, height = bars_high + gap + numbers_high;

  std::vector<HistogramBar> bars;                    ///< one a degree that has triangles
  std::vector<std::pair<double, unsigned>> numbers;  ///< where degrees are written, and which
  double base = 0;                                   ///< of the bars, downwards from the top of all

  /// `top`: downwards, where it begins. Nothing without triangles.
  Histogram(const Canvas& canvas, const Fill& fill, double top) : base(top + bars_high) {
    const std::size_t most =
        fill.histogram.empty() ? 0 : *std::max_element(fill.histogram.begin(), fill.histogram.end());
    if (most == 0) return;
    const double degree = canvas.width / static_cast<double>(fill.histogram.size());
    for (std::size_t k = 0; k < fill.histogram.size(); ++k) {
      if (fill.histogram[k] == 0) continue;
      const double high = bars_high * static_cast<double>(fill.histogram[k]) / static_cast<double>(most);
      const auto colour = static_cast<std::size_t>(static_cast<double>(k) / degrees_of_colour);
      bars.push_back({static_cast<double>(k) * degree, base - high, degree, high, fill.colours[colour]});
    }
    const unsigned step = canvas.width < Canvas::longer_side / 3 ? 30 : 10;
    for (unsigned number = 0; number <= 60; number += step) numbers.emplace_back(number * degree, number);
  }
};

}  // namespace gcdt::io

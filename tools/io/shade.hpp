// SPDX-License-Identifier: Apache-2.0
// The shade that many short strokes give.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "canvas.hpp"

namespace gcdt::io {

/// Pixels with as much ink as strokes through them leave.
class Shade {
 public:
  /// The canvas at so many units a pixel.
  Shade(const Canvas& canvas, double units_per_pixel);

  int width() const { return width_; }
  int height() const { return height_; }
  /// Adds a stroke that is so many pixels wide.
  void add(const Canvas::Place& from, const Canvas::Place& to, double pixels);
  /// How much of each pixel is covered, from 0 to 255, row by row. Strokes lie over each other as they would by chance.
  std::vector<std::uint8_t> coverage() const;

 private:
  void put(double x, double y, float ink);

  double units_;
  int width_, height_;
  std::vector<float> ink_;
};

}  // namespace gcdt::io

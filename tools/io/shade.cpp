// SPDX-License-Identifier: Apache-2.0
#include "shade.hpp"

namespace gcdt::io {

Shade::Shade(const Canvas& canvas, double units_per_pixel)
    : units_(units_per_pixel),
      width_(static_cast<int>(canvas.width / units_per_pixel) + 2),
      height_(static_cast<int>(canvas.height / units_per_pixel) + 2),
      ink_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

/// Shares ink out to the four pixels whose middles are around.
void Shade::put(double x, double y, float ink) {
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const auto right = static_cast<float>(x - 0.5 - left), low = static_cast<float>(y - 0.5 - top);
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const int column = static_cast<int>(left) + dx, row = static_cast<int>(top) + dy;
      if (column < 0 || row < 0 || column >= width_ || row >= height_) continue;
      const float share = (dx ? right : 1 - right) * (dy ? low : 1 - low);
      ink_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column)] +=
          share * ink;
    }
}

void Shade::add(const Canvas::Place& from, const Canvas::Place& to, double pixels) {
  const double x = from[0] / units_, y = from[1] / units_;
  const double across = to[0] / units_ - x, down = to[1] / units_ - y,
               length = std::sqrt(across * across + down * down);
  const int steps = 2 * std::max(1, static_cast<int>(std::ceil(length)));
  const auto ink = static_cast<float>(length * pixels / steps);
  for (int i = 0; i < steps; ++i) put(x + across * (i + 0.5) / steps, y + down * (i + 0.5) / steps, ink);
}

std::vector<std::uint8_t> Shade::coverage() const {
  std::vector<std::uint8_t> covered(ink_.size());
  for (std::size_t i = 0; i < ink_.size(); ++i)
    covered[i] = static_cast<std::uint8_t>(std::lround(255 * (1 - std::exp(-static_cast<double>(ink_[i])))));
  return covered;
}

}  // namespace gcdt::io

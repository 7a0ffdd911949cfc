// SPDX-License-Identifier: Apache-2.0
// Inputs like vectorised images: outlines of thresholded procedural images. Compiled without contraction
// to fused multiply-add, and only + - * / sqrt on doubles: the same bits on every machine.
//
// Outlines come from marching squares. A vertex lies inside a side of a cell of pixels, a segment joins two
// sides of one cell, and two segments of a cell cut off opposite corners: so segments cannot cross, also
// after rounding along the side.
#include <algorithm>
#include <cmath>

#include "inputs.hpp"

namespace gcdt::bench {

namespace {

using test::Random;

std::uint32_t index(std::size_t i) { return static_cast<std::uint32_t>(i); }

/// Brightness of width x height pixels; what is above zero is inside.
struct Image {
  Image(std::size_t w, std::size_t h) : width(w), height(h), value(w * h, -1.0f) {}
  float at(std::size_t x, std::size_t y) const { return value[y * width + x]; }
  std::size_t width, height;
  std::vector<float> value;
};

/// Where along a side from brightness a to b the outline passes: a multiple of 2^-16, well inside the side.
double crossing(float a, float b) {
  const double t = static_cast<double>(a) / (static_cast<double>(a) - static_cast<double>(b));
  return std::floor(std::min(std::max(t, 0.0625), 0.9375) * 65536 + 0.5) / 65536;
}

/// The outlines of the image, in pixels, in the order of the scan.
Workload outlines(const Image& image) {
  Workload work;
  const auto vertex = [&](double x, double y) {
    work.points.push_back({x, y});
    return index(work.points.size() - 1);
  };
  const auto inside = [&](std::size_t x, std::size_t y) { return image.at(x, y) > 0; };
  const auto along_row = [&](std::size_t y, std::vector<std::uint32_t>& sides) {
    for (std::size_t x = 0; x + 1 < image.width; ++x)
      if (inside(x, y) != inside(x + 1, y))
        sides[x] =
            vertex(static_cast<double>(x) + crossing(image.at(x, y), image.at(x + 1, y)), static_cast<double>(y));
  };
  std::vector<std::uint32_t> lower(image.width), upper(image.width), upright(image.width);
  along_row(0, lower);
  for (std::size_t y = 0; y + 1 < image.height; ++y) {
    along_row(y + 1, upper);
    for (std::size_t x = 0; x < image.width; ++x)
      if (inside(x, y) != inside(x, y + 1))
        upright[x] =
            vertex(static_cast<double>(x), static_cast<double>(y) + crossing(image.at(x, y), image.at(x, y + 1)));
    for (std::size_t x = 0; x + 1 < image.width; ++x) {
      // corners counter-clockwise from (x, y), and the side that follows each
      const bool corner[4] = {inside(x, y), inside(x + 1, y), inside(x + 1, y + 1), inside(x, y + 1)};
      const std::uint32_t side[4] = {lower[x], upright[x + 1], upper[x], upright[x]};
      std::uint32_t cut[4];
      int count = 0, first = 0;
      for (int k = 0; k < 4; ++k)
        if (corner[k] != corner[(k + 1) % 4]) {
          if (count == 0) first = k;
          cut[count++] = side[k];
        }
      if (count == 2) work.constraints.push_back({cut[0], cut[1]});
      // all four sides: cut off the two inner corners, corner k lies between sides k - 1 and k
      if (count == 4 && corner[first])
        work.constraints.insert(work.constraints.end(), {{cut[3], cut[0]}, {cut[1], cut[2]}});
      if (count == 4 && !corner[first])
        work.constraints.insert(work.constraints.end(), {{cut[0], cut[1]}, {cut[2], cut[3]}});
    }
    std::swap(lower, upper);
  }
  return work;
}

}  // namespace

Workload shuffled(const Workload& work, Random& random) {
  Workload result = test::shuffled_vertices(work, random);
  test::shuffle(result.constraints, random);
  return result;
}

namespace {

/// A leaf: what two discs of radius `r` share, `length` from tip to tip, its axis along `axis`.
void draw_leaf(Image& image, Point centre, Point axis, double length, double r) {
  const double offset = std::sqrt(r * r - length * length / 4);  // of the discs' centres from the axis
  const double reach = length / 2 + 2;
  const auto low = [&](double c) { return static_cast<std::size_t>(std::max(0.0, std::floor(c - reach))); };
  const auto high = [&](double c, std::size_t size) {
    return std::min(size, static_cast<std::size_t>(std::max(0.0, c + reach + 1)));
  };
  for (std::size_t y = low(centre[1]); y < high(centre[1], image.height); ++y)
    for (std::size_t x = low(centre[0]); x < high(centre[0], image.width); ++x) {
      const double dx = static_cast<double>(x) - centre[0], dy = static_cast<double>(y) - centre[1];
      const double u = dx * axis[0] + dy * axis[1], v = std::fabs(dy * axis[0] - dx * axis[1]) + offset;
      float& value = image.value[y * image.width + x];
      value = std::max(value, static_cast<float>(r - std::sqrt(u * u + v * v)));
    }
}

/// Smooth noise in [-1, 1]: random values at every `period` pixels, smoothly blended; two octaves.
Image noise(std::size_t side, std::size_t period, double threshold, Random& random) {
  Image image(side, side);
  std::fill(image.value.begin(), image.value.end(), 0.0f);
  double weight = 0.75;
  for (std::size_t p : {period, period / 2}) {
    const std::size_t knots = side / p + 2;
    std::vector<double> knot(knots * knots);
    for (double& k : knot) k = random.between(-1, 1);
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x < side; ++x) {
        const double s = smooth(static_cast<double>(x % p) / static_cast<double>(p));
        const double t = smooth(static_cast<double>(y % p) / static_cast<double>(p));
        const double* k = &knot[y / p * knots + x / p];
        const double blend = (k[0] * (1 - s) + k[1] * s) * (1 - t) + (k[knots] * (1 - s) + k[knots + 1] * s) * t;
        image.value[y * side + x] += static_cast<float>(weight * blend);
      }
    weight = 0.25;
  }
  for (std::size_t y = 0; y < side; ++y)  // an empty margin: every outline is closed
    for (std::size_t x = 0; x < side; ++x) {
      float& value = image.value[y * side + x];
      const bool margin = x == 0 || y == 0 || x + 1 == side || y + 1 == side;
      value = margin ? -1.0f : value - static_cast<float>(threshold);
    }
  return image;
}

}  // namespace

Workload leafs(std::size_t n) {
  constexpr double cell = 24, outline_of_a_leaf = 53.3;  // pixels; vertices on average, measured
  Random random(18000);
  const std::size_t across =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(static_cast<double>(n) / outline_of_a_leaf) + 0.5));
  const std::size_t side = static_cast<std::size_t>(cell) * (across + 1);
  Image image(side, side);
  for (std::size_t i = 0; i < across * across; ++i) {
    const double x = cell * (static_cast<double>(i % across) + 1) + random.between(-3, 3);
    const double y = cell * (static_cast<double>(i / across) + 1) + random.between(-3, 3);
    const double length = random.between(16, 22);
    const Point axis = test::direction(static_cast<std::uint32_t>(random.next() >> 32));
    draw_leaf(image, {x, y}, axis, length, length * random.between(0.55, 0.9));
  }
  return shuffled(outlines(image), random);
}

Workload airport(std::size_t n) {
  Random random(19000);
  Workload scene;
  const auto line = [&](Point a, Point b) {
    const std::uint32_t first = index(scene.points.size());
    scene.points.insert(scene.points.end(), {a, b});
    scene.constraints.push_back({first, first + 1});
  };
  const auto tile = [&](double left, double bottom, double edge) {
    const std::size_t side = 32 << random.below(3);
    const Workload work = outlines(noise(side, 12, random.between(-0.1, 0.2), random));
    const std::uint32_t first = index(scene.points.size());
    const double pixel = edge / static_cast<double>(side);
    for (const Point& p : work.points) scene.points.push_back({left + p[0] * pixel, bottom + p[1] * pixel});
    for (const Segment& s : work.constraints) scene.constraints.push_back({first + s[0], first + s[1]});
  };
  double y = 0;
  while (scene.points.size() < n) {
    const double u = random.unit(), height = 0.002 + 0.05 * u * u;
    for (double x = 0.2 * random.unit(); x + height < 1 && scene.points.size() < n;) {  // a row of clusters
      tile(x, y, height);
      x += height * 1.1;
      if (random.below(3) == 0) line({x, y}, {x + 0.05 * height, y + height});
      x += 0.1 * height + 0.3 * random.unit();
    }
    y += height;
    const std::size_t lanes = 3 + random.below(6);
    const double gap = 0.0002 + 0.002 * random.unit();
    for (std::size_t k = 0; k < lanes; ++k) {  // a runway: lines across everything
      y += gap;
      line({-0.01, y - 0.2 * gap * random.unit()}, {1.01, y + 0.2 * gap * random.unit()});
    }
    y += gap;
  }
  const Point turn = test::direction(300000000);  // 25 degrees: no line is parallel to an axis
  const double scale = 1 / std::max(1.0, y);
  for (Point& p : scene.points) {
    p = {scale * p[0], scale * p[1]};
    p = {test::snapped(p[0] * turn[0] - p[1] * turn[1]), test::snapped(p[0] * turn[1] + p[1] * turn[0])};
  }
  return shuffled(scene, random);
}

}  // namespace gcdt::bench

// SPDX-License-Identifier: Apache-2.0
#include "batch_inputs.hpp"

#include <algorithm>

#include "workloads.hpp"

namespace gcdt::bench {

namespace {

using test::Random;
using Point = std::array<double, 2>;

/// Hundredths to decimals: the double nearest to the decimal.
double decimal(std::int64_t hundredths) { return static_cast<double>(hundredths) / 100; }

std::int64_t nearest(double value) { return static_cast<std::int64_t>(value + (value < 0 ? -0.5 : 0.5)); }

class Sketch {
 public:
  explicit Sketch(SketchBatch& batch) : batch_(batch) {}

  /// A vertex of the problem, in hundredths; its number.
  std::uint32_t vertex(std::int64_t x, std::int64_t y) {
    batch_.vertices.push_back({decimal(x), decimal(y)});
    return count_++;
  }
  void line(std::uint32_t a, std::uint32_t b) { batch_.constraints.push_back({a, b}); }

  /// A closed outline around (x, y), about a circle, at `lobes` places bulging by a fifth. Its vertices stand at even
  /// steps of the rational parameter t of each quadrant, ((1 - t^2) / (1 + t^2), 2t / (1 + t^2)), so at least 2/3 of a
  /// step of the angle apart: over 100 hundredths for the sizes here, against which rounding is nothing.
  void ring(double x, double y, double radius, std::uint32_t vertices, std::uint32_t lobes) {
    const std::uint32_t first = count_;
    for (std::uint32_t i = 0; i < vertices; ++i) {
      const double turn = 4.0 * i / vertices;
      const auto quadrant = static_cast<std::uint32_t>(turn);
      const double t = turn - quadrant, d = 1 + t * t;
      const double c = (1 - t * t) / d, s = 2 * t / d;
      const double wave = lobes == 0 ? 0 : static_cast<double>(i * lobes % vertices) / vertices;
      const double r = radius * (1 + 0.8 * wave * (1 - wave));
      const double dx[] = {c, -s, -c, s}, dy[] = {s, c, -s, -c};
      vertex(nearest(x + r * dx[quadrant]), nearest(y + r * dy[quadrant]));
      if (i > 0) line(count_ - 2, count_ - 1);
    }
    line(count_ - 1, first);
  }

  /// Four vertices around all others, and the lines between opposite ones.
  void diagonals() {
    std::array<double, 2> low = {0, 0}, high = {0, 0};
    for (std::size_t v = batch_.vertex_offsets.back(); v < batch_.vertices.size(); ++v)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        low[axis] = std::min(low[axis], batch_.vertices[v][axis]);
        high[axis] = std::max(high[axis], batch_.vertices[v][axis]);
      }
    const std::uint32_t first = count_;
    for (const double x : {low[0] - 1, high[0] + 1})
      for (const double y : {low[1] - 1, high[1] + 1}) vertex(nearest(x * 100), nearest(y * 100));
    line(first, first + 3);
    line(first + 1, first + 2);
  }

  void leave_out() {
    batch_.vertices.resize(batch_.vertex_offsets.back());
    batch_.constraints.resize(batch_.constraint_offsets.back());
  }

  void end() {
    batch_.vertex_offsets.push_back(batch_.vertices.size());
    batch_.constraint_offsets.push_back(batch_.constraints.size());
  }

 private:
  SketchBatch& batch_;
  std::uint32_t count_ = 0;
};

/// A round or lobed plate with holes in a row of cells inside it, none of which touch.
void plate(Sketch& sketch, std::uint32_t n, bool curved, Random& random) {
  const std::uint32_t holes = n < 16 ? 0 : 1 + static_cast<std::uint32_t>(random.next() % 3);
  const std::uint32_t outer = holes == 0 ? n : n / 2, each = holes == 0 ? 0 : (n - outer) / holes;
  sketch.ring(0, 0, 50000, outer + (n - outer - each * holes), curved ? 5 : 0);
  for (std::uint32_t h = 0; h < holes; ++h)
    sketch.ring((2.0 * h + 1 - holes) * 15000, static_cast<double>(random.next() % 4000), 6000 + random.next() % 5000,
                each, curved ? 3 : 0);
}

/// Random vertices in bands of a height each; in a band a chain from left to right joins half of them, so chains
/// cross neither themselves nor each other.
void graph(Sketch& sketch, std::uint32_t n, Random& random) {
  const std::uint32_t bands = 1 + n / 40;
  for (std::uint32_t band = 0, left = n; band < bands; ++band) {
    const std::uint32_t here = left / (bands - band);
    left -= here;
    std::vector<std::int64_t> xs;
    for (std::uint32_t i = 0; i < here; ++i)  // one in each column: distinct
      xs.push_back(std::int64_t{i} * 2000 + static_cast<std::int64_t>(random.next() % 1999));
    for (std::uint32_t i = 0, before = 0; i < here; ++i) {
      const std::uint32_t v =
          sketch.vertex(xs[i], std::int64_t{band} * 10000 + static_cast<std::int64_t>(random.next() % 9900));
      // Every second vertex: the chain goes from one to the next but one.
      if (i % 2 == 0) {
        if (i > 0) sketch.line(before, v);
        before = v;
      }
    }
  }
}

}  // namespace

SketchBatch sketches(std::size_t problems, std::uint64_t seed) { return crossed_sketches(problems, 0, false, seed); }

SketchBatch crossed_sketches(std::size_t problems, std::size_t crossing, bool left_out, std::uint64_t seed) {
  // Thirteen sizes, each 10^(1/6) times the one before.
  constexpr std::uint32_t sizes[] = {10, 15, 22, 32, 46, 68, 100, 147, 215, 316, 464, 681, 1000};
  SketchBatch batch;
  Random random(seed);
  for (std::size_t p = 0; p < problems; ++p) {
    Sketch sketch(batch);
    const std::uint32_t n = sizes[random.next() % std::size(sizes)];
    if (p % 3 == 2)
      graph(sketch, n, random);
    else
      plate(sketch, n, p % 3 == 1, random);
    if (is_crossed(p, problems, crossing)) {
      if (left_out) {
        sketch.leave_out();
        continue;
      }
      sketch.diagonals();
    }
    sketch.end();
  }
  return batch;
}

SketchBatch one_large(std::size_t large, std::size_t problems, std::uint64_t seed) {
  SketchBatch batch;
  batch.vertices = test::uniform(large, seed).points;
  Sketch(batch).end();
  Random random(seed);
  for (std::size_t p = 0; p < problems; ++p) {
    Sketch sketch(batch);
    graph(sketch, 20, random);
    sketch.end();
  }
  return batch;
}

}  // namespace gcdt::bench

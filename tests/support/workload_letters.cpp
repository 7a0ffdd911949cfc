// SPDX-License-Identifier: Apache-2.0
// The letters scene: rows of copies of a word in outlines of this project's own drawing, some densely
// subdivided, slightly turned, with vertical bars after copies and scene-long lines between rows.
#include <algorithm>
#include <cmath>

#include "workloads.hpp"

namespace gcdt::test {
namespace {

using Outline = std::vector<Point>;

/// Appends the arc of `radius` around `centre` from angle `from` to `to`, in 1/360 turns, both included.
void arc(Outline& outline, Point centre, double radius, int from, int to, int steps) {
  for (int i = 0; i <= steps; ++i) {
    const double degrees = from + static_cast<double>(to - from) * i / steps;
    const double turn = degrees / 360 - std::floor(degrees / 360);
    const Point d = direction(static_cast<std::uint32_t>(turn * 0xffffffffu));
    outline.push_back({centre[0] + radius * d[0], centre[1] + radius * d[1]});
  }
}

/// The word's outlines; a letter is 100 high and stands in a box 120 wide. `steps`: chords per arc.
std::vector<Outline> word(int steps) {
  std::vector<Outline> all;
  double left = 0;
  const auto letter = [&](std::vector<Outline> outlines) {
    for (Outline& outline : outlines) {
      for (Point& p : outline) p[0] += left;
      all.push_back(std::move(outline));
    }
    left += 120;
  };
  const Point middle{50, 50};
  Outline g, c, d, dHole, o, oHole;
  arc(g, middle, 50, 45, 359, 3 * steps);
  g.insert(g.end(), {{55, 49}, {55, 36}});
  arc(g, middle, 34, 335, 46, 3 * steps);
  arc(c, middle, 50, 45, 315, 3 * steps);
  arc(c, middle, 34, 314, 46, 3 * steps);
  d = {{0, 0}};
  arc(d, middle, 50, -90, 90, 2 * steps);
  d.push_back({0, 100});
  dHole = {{16, 16}};
  arc(dHole, middle, 34, -89, 89, 2 * steps);
  dHole.push_back({16, 84});
  arc(o, middle, 50, 0, 330, 4 * steps);
  arc(oHole, middle, 31, 10, 340, 4 * steps);
  letter({g});
  letter({c});
  letter({d, dHole});
  letter({{{42, 0}, {58, 0}, {58, 84}, {100, 84}, {100, 100}, {0, 100}, {0, 84}, {42, 84}}});
  letter(
      {{{0, 0}, {16, 0}, {16, 70}, {84, 0}, {100, 0}, {100, 100}, {84, 100}, {84, 25}, {16, 95}, {16, 100}, {0, 100}}});
  letter({o, oHole});
  letter({{{40, 0}, {60, 0}, {60, 65}, {40, 65}}, {{38, 76}, {62, 78}, {60, 100}, {41, 99}}});
  return all;
}

/// Every edge cut into `pieces`.
Outline subdivided(const Outline& outline, int pieces) {
  Outline result;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Point a = outline[i], b = outline[(i + 1) % outline.size()];
    for (int k = 0; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      result.push_back({a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t});
    }
  }
  return result;
}

struct Detail {
  int steps, pieces;
};

class Scene {
 public:
  Scene(std::size_t target, std::uint64_t seed)
      : target_(target), scale_(std::min(1.5, std::sqrt(97000.0 / static_cast<double>(target)))), random_(seed) {}

  Workload make() {
    double y = 0;
    while (size() < target_) y = row(y);
    const std::uint32_t first = static_cast<std::uint32_t>(size());
    work_.points.insert(work_.points.end(), {{-0.02, -0.02}, {1.02, -0.02}, {1.02, y + 0.02}, {-0.02, y + 0.02}});
    for (std::uint32_t k = 0; k < 4; ++k) work_.constraints.push_back({first + k, first + (k + 1) % 4});
    return shuffled_and_snapped();
  }

 private:
  static constexpr double width = 820, height = 100;  // of the word

  std::size_t size() const { return work_.points.size(); }

  void segment(Point a, Point b) {
    const std::uint32_t first = static_cast<std::uint32_t>(size());
    work_.points.push_back(a);
    work_.points.push_back(b);
    work_.constraints.push_back({first, first + 1});
  }

  /// One row of words with its bottom at `y`, and the long line above it; returns the next row's bottom.
  double row(double y) {
    const double u = random_.unit(), h = scale_ * 0.02 * (0.3 + 3 * u * u);
    double x = 0.003 * random_.unit();
    while (size() < target_) {
      const double w = h * width / height * random_.between(0.55, 0.95);
      if (x + w > 0.999) break;
      copy({x + w / 2, y + h / 2}, w, h);
      x += w;
      if (random_.below(2) == 0) {
        const double gap = 0.004 * scale_, bar = x + gap;
        segment({bar, y}, {bar + gap * random_.between(-0.2, 0.2), y + 1.03 * h});
      }
      x += 0.01 * scale_ * (1 + random_.unit());
    }
    const double gap = 0.3 * h, slant = random_.below(2) ? gap * 0.15 * random_.between(-1, 1) : 0;
    segment({-0.01, y + h + gap / 2 - slant}, {1.01, y + h + gap / 2 + slant});
    return y + h + gap;
  }

  /// A copy of the word, at most w wide and h high, slightly turned in half of all cases.
  void copy(Point centre, double w, double h) {
    const std::uint64_t dice = random_.below(1000);
    Detail detail = dice < 860 ? Detail{4, 1} : dice < 965 ? Detail{8, 4} : Detail{16, 48};
    if (detail.pieces > 10 && dense_ > target_ / 2) detail = {4, 1};
    const double spare = std::max(0.0, h - w * height / width) * 0.6;
    const double slope = random_.below(2) ? spare / w * random_.between(-1, 1) : 0;
    const double cosine = 1 / std::sqrt(1 + slope * slope), sine = slope * cosine, size = w * 0.95 / width;
    for (const Outline& outline : word(detail.steps)) {
      const std::uint32_t first = static_cast<std::uint32_t>(this->size());
      const Outline fine = subdivided(outline, detail.pieces);
      const std::uint32_t count = static_cast<std::uint32_t>(fine.size());
      for (std::uint32_t i = 0; i < count; ++i) {
        const double px = (fine[i][0] - width / 2) * size, py = (fine[i][1] - height / 2) * size;
        work_.points.push_back({centre[0] + px * cosine - py * sine, centre[1] + px * sine + py * cosine});
        work_.constraints.push_back({first + i, first + (i + 1) % count});
      }
      if (detail.pieces > 10) dense_ += count;
    }
  }

  Workload shuffled_and_snapped() {
    for (Point& p : work_.points) p = {snapped(p[0]), snapped(p[1])};
    Workload result = shuffled_vertices(work_, random_);
    shuffle(result.constraints, random_);
    return result;
  }

  Workload work_;
  std::size_t target_, dense_ = 0;
  double scale_;
  Random random_;
};

}  // namespace

Workload letters(std::size_t n, std::uint64_t seed) { return Scene(n, seed).make(); }

}  // namespace gcdt::test

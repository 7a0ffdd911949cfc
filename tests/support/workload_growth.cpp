// SPDX-License-Identifier: Apache-2.0
// Shapes that make chains of flips, long walks or many crossings, so that time may grow faster than their number of
// vertices (bench/README.md, "Growth"). Compiled without contraction to fused multiply-add.
#include <algorithm>
#include <cmath>

#include "workloads.hpp"

namespace gcdt::test {

namespace {

std::uint32_t index(std::size_t i) { return static_cast<std::uint32_t>(i); }

/// count vertices with y = `y` and x = 0, 1, ...
void add_row(Workload& work, std::size_t count, double y) {
  for (std::size_t i = 0; i < count; ++i) work.points.push_back({static_cast<double>(i), y});
}

Workload shuffled(const Workload& work, std::uint64_t seed) {
  Random random(seed);
  return shuffled_vertices(work, random);
}

}  // namespace

Workload line_and_one(std::size_t n) {
  Workload work = line(n - 1);
  work.points.insert(work.points.begin() + work.points.size() / 2,
                     {static_cast<double>(n / 3), 3.0 * static_cast<double>(n)});
  return {work.points, {}};
}

Workload parabola(std::size_t n) {
  Workload work;
  for (std::size_t i = 0; i < std::min<std::size_t>(n, 46341); ++i)
    work.points.push_back({static_cast<double>(i), static_cast<double>(i) * static_cast<double>(i)});
  Random random(5009);
  shuffle(work.points, random);
  return work;
}

Workload row(std::size_t n) {
  Workload work;
  add_row(work, n - 1, 0);
  const double half = std::floor(static_cast<double>(n) / 2);
  work.points.push_back({half, -half});
  return shuffled(work, 18001);
}

Workload row_between(std::size_t n) {
  Workload work;
  add_row(work, n - 2, 0);
  const double half = std::floor(static_cast<double>(n) / 2);
  work.points.push_back({half, -half});
  work.points.push_back({std::floor(half / 3), half});
  return shuffled(work, 18002);
}

Workload two_rows(std::size_t n) {
  Workload work;
  add_row(work, n / 2, 0);
  add_row(work, n - n / 2, std::floor(static_cast<double>(n) / 8));
  return shuffled(work, 18003);
}

Workload closed_comb(std::size_t n) {
  Workload work = comb(n);  // its last two vertices are the corners that close it
  Point& right = *(work.points.end() - 2);
  right[1] = work.points.back()[1] = -right[0];
  return shuffled(work, 18004);
}

Workload dense_border(std::size_t n) {
  const std::size_t inside = std::min<std::size_t>(50, n / 4), side = (n - inside) / 4;
  const double length = static_cast<double>(side);
  Workload work;
  for (std::size_t i = 0; i < side; ++i) work.points.push_back({static_cast<double>(i), 0});
  for (std::size_t i = 0; i < side; ++i) work.points.push_back({length, static_cast<double>(i)});
  for (std::size_t i = 0; i < side; ++i) work.points.push_back({length - static_cast<double>(i), length});
  for (std::size_t i = 0; i < side; ++i) work.points.push_back({0, length - static_cast<double>(i)});
  for (std::size_t i = 0; i < 4 * side; ++i) work.constraints.push_back({index(i), index((i + 1) % (4 * side))});
  Random random(18005);
  for (std::size_t i = 0; i < inside; ++i) {
    const double x = std::floor(length * random.between(0.1, 0.9));
    work.points.push_back({x, std::floor(length * random.between(0.1, 0.9))});
  }
  return shuffled(work, 18006);
}

Workload sunray(std::size_t n) {
  const std::size_t rays = std::max<std::size_t>(n / 10, 3);
  Random random(18007);
  Workload work{{{0.5, 0.5}}, {}};
  for (std::size_t i = 0; i < rays; ++i) {
    const Point d = direction(index((static_cast<std::uint64_t>(i) << 32) / rays));
    work.constraints.push_back({0, index(work.points.size())});
    work.points.push_back({snapped(0.5 + 0.5 * d[0]), snapped(0.5 + 0.5 * d[1])});
  }
  while (work.points.size() < n) {
    const double x = snapped(random.unit());
    work.points.push_back({x, snapped(random.unit())});
  }
  return shuffled(work, 18008);
}

Workload log_spirals(std::size_t n) {
  // 64 clusters along each of three arms; a cluster is as large as its distance from the centre allows.
  constexpr std::size_t arms = 3, places = 64;
  const double shrink = 0.85;
  Random random(18009);
  Workload work;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t place = i % (arms * places), arm = place % arms, step = place / arms;
    double radius = 0.45;
    for (std::size_t k = 0; k < step; ++k) radius *= shrink;
    const Point d = direction(index((static_cast<std::uint64_t>(arm) << 32) / arms + (std::uint64_t{step} << 28)));
    const double spread = 0.06 * radius;
    const double x = 0.5 + radius * d[0] + random.between(-spread, spread);
    work.points.push_back({x, 0.5 + radius * d[1] + random.between(-spread, spread)});
  }
  return work;
}

std::vector<std::string> growth_names() {
  return {"uniform", "row",      "row_between", "two_rows", "closed_comb", "dense_border", "spiral",    "line_and_one",
          "sunray",  "parabola", "log_spirals", "letters",  "letters_2",   "letters_3",    "letters_4", "letters_5"};
}

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
#include "batch/warmup.hpp"

#include <algorithm>

namespace gcdt {

WarmupBatch::WarmupBatch(const std::vector<std::uint32_t>& vertices) {
  constexpr std::uint32_t rings = 4;  // the first vertex of the rings
  for (std::uint32_t p = 0; p < vertices.size(); ++p) {
    const bool crosses = p % 4 == 3, only_that = p % 8 == 7;
    // The ends of a constraint, the middle between them, one end again, two rings, a line; then any other vertices.
    vertices_.insert(vertices_.end(), {{0, 0}, {1000, 600}, {500, 300}, {0, 0}});
    vertices_.insert(vertices_.end(), {{140, 740}, {260, 740}, {260, 860}, {140, 860}});
    vertices_.insert(vertices_.end(), {{180, 780}, {220, 780}, {220, 820}, {180, 820}});
    vertices_.insert(vertices_.end(), {{400, 900}, {600, 100}});
    for (std::uint32_t i = 14; i < vertices[p]; ++i)
      vertices_.push_back({double((i * 389 + p * 7) % 997), double((i * 571 + p * 13) % 991)});
    // By turns: integers, decimals, and numbers that are rounded.
    const double scales[] = {1, 0.01, 1.0 / 3};
    for (auto v = vertices_.end() - vertices[p]; v != vertices_.end(); ++v)
      for (double& x : *v) x *= scales[p % 3];
    constraints_.push_back({0, 1});
    if (crosses) constraints_.push_back({12, 13});
    if (!only_that) {
      constraints_.insert(constraints_.end(), {{3, 2}, {5, 5}});
      for (std::uint32_t i = 0; i < 8; ++i) constraints_.push_back({rings + i, rings + i / 4 * 4 + (i + 1) % 4});
    }
    vertex_offsets_.push_back(vertices_.size());
    constraint_offsets_.push_back(constraints_.size());
  }
}

BatchInput WarmupBatch::view() const {
  return {vertex_offsets_.size() - 1, Points::Type::float64, vertices_.data(),
          vertex_offsets_.data(),     constraints_.data(),   constraint_offsets_.data()};
}

// Many problems, so that each is one work-item's. A few, which have less than Tuning::one_item_vertices together. A
// single one. One that is much larger than the other, so that both go through the phases together, with too many
// vertices for one work-group to sort. Large ones that cross and are split one by one, on a decimal grid and rounded.
std::vector<std::vector<std::uint32_t>> warmup_runs(std::uint32_t compute_units, Crossing crossing) {
  constexpr std::uint32_t least_of_many = 512, large = 20000;
  const std::uint32_t many = std::max(least_of_many, 2 * compute_units);
  std::vector<std::vector<std::uint32_t>> runs = {
      std::vector<std::uint32_t>(many, 40), std::vector<std::uint32_t>(8, 40), {40}, {60, 40}, {large, 40}};
  if (crossing == Crossing::split) {
    runs.emplace_back(12, 40);
    runs.back()[7] = runs.back()[11] = large;
  }
  return runs;
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "geometries.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace gcdt::io {

bool Geometries::add(double x, double y, double height) {
  if (input_.vertices.size() == max_vertices) return false;
  input_.vertices.push_back({x, y});
  heights_.push_back(height);
  return true;
}

void Geometries::connect(bool ring) {
  if (ring && input_.vertices.size() > begin_ + 1 && input_.vertices.back() == input_.vertices[begin_]) {
    input_.vertices.pop_back();
    heights_.pop_back();
  }
  const auto end = static_cast<std::uint32_t>(input_.vertices.size());
  const std::size_t first = input_.constraints.size();
  for (std::uint32_t v = begin_; v + 1 < end; ++v) input_.constraints.push_back({v, v + 1});
  if (ring && end > begin_) input_.constraints.push_back({end - 1, begin_});
  if (ring) rings_.push_back({begin_, end, first});
}

void Geometries::finish() {
  direct_rings();
  take_heights();
}

/// Turns rings by the library's rule; a ring has as many constraints as vertices.
void Geometries::direct_rings() {
  std::vector<std::array<double, 2>> vertices;
  std::vector<std::uint64_t> offsets = {0};
  for (const Ring& ring : rings_) {
    vertices.insert(vertices.end(), input_.vertices.begin() + ring.begin, input_.vertices.begin() + ring.end);
    offsets.push_back(vertices.size());
  }
  const std::vector<Constraint> directed = ring_constraints(vertices, offsets, polygon_offsets_);
  for (std::size_t r = 0; r < rings_.size(); ++r) {
    const Ring& ring = rings_[r];
    for (std::uint32_t i = 0; i < ring.end - ring.begin; ++i) {
      const std::uint64_t from = offsets[r];
      const Constraint& c = directed[from + i];
      input_.constraints[ring.first_constraint + i] = {static_cast<std::uint32_t>(c[0] - from + ring.begin),
                                                       static_cast<std::uint32_t>(c[1] - from + ring.begin)};
    }
  }
}

/// The third numbers of positions are an attribute, if all have one.
void Geometries::take_heights() {
  const auto without = std::count_if(heights_.begin(), heights_.end(), [](double h) { return !(h - h == 0); });
  const std::size_t with = heights_.size() - static_cast<std::size_t>(without);
  if (with == 0) return;
  if (without > 0) {
    input_.notes.push_back(
        fmt::format("{} of {} positions have a third number, and not all: they are not used", with, heights_.size()));
    return;
  }
  input_.attribute_count = 1;
  input_.attributes = std::move(heights_);
  input_.heights = true;
}

}  // namespace gcdt::io

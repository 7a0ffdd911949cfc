// SPDX-License-Identifier: Apache-2.0
// What a lane runs before its part of the first batch, so that a driver that compiles kernels when they are first
// launched (PoCL: seconds) does not do so in a later one.
#pragma once

#include <array>
#include <set>
#include <vector>

#include "batch/forest.hpp"

namespace gcdt {

/// Problems that take a lane through all that others may, on all kinds of grids: of so many vertices each, 40 or more,
/// of which two are equal, with a constraint that crosses edges and has a vertex inside, one that overlaps it, one of
/// length 0, and a ring within a ring; in every fourth one that crosses the first, in every eighth only these two.
class RehearsalBatch {
 public:
  explicit RehearsalBatch(const std::vector<std::uint32_t>& vertices);
  BatchInput view() const;

 private:
  std::vector<std::array<double, 2>> vertices_;
  std::vector<Constraint> constraints_;
  std::vector<std::uint64_t> vertex_offsets_ = {0}, constraint_offsets_ = {0};
};

/// Which options a lane has rehearsed: of those that decide which kernels there are.
class Rehearsed {
 public:
  bool has(const Options& options) const { return kinds_.count(kind(options)) > 0; }
  void add(const Options& options) { kinds_.insert(kind(options)); }

 private:
  static std::array<int, 3> kind(const Options& options) {
    return {static_cast<int>(options.crossing), options.domain != Domain::hull, options.regions};
  }
  std::set<std::array<int, 3>> kinds_;
};

}  // namespace gcdt

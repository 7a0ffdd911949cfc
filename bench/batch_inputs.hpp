// SPDX-License-Identifier: Apache-2.0
// The batch of the benchmark: many problems of the size of CAD sketches (bench/README.md, "Batches").
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace gcdt::bench {

/// Problem p has the vertices [vertex_offsets[p], vertex_offsets[p + 1]), and so its constraints, which count from 0
/// in each problem.
struct SketchBatch {
  std::vector<std::array<double, 2>> vertices;
  std::vector<std::array<std::uint32_t, 2>> constraints;
  std::vector<std::uint64_t> vertex_offsets = {0}, constraint_offsets = {0};
  std::size_t size() const { return vertex_offsets.size() - 1; }
};

/// `problems` problems of 10 to 1000 vertices, their logarithms evenly spread, by turns plates with holes, curved
/// outlines, and random planar graphs. Coordinates have two decimals. Nothing crosses, no two vertices of a problem
/// are equal. The same bits on every machine.
SketchBatch sketches(std::size_t problems, std::uint64_t seed = 20000);

/// The same, but `crossing` of them, evenly spread, get the diagonals of a rectangle around all their vertices as
/// constraints, which cross; or are left out.
SketchBatch crossed_sketches(std::size_t problems, std::size_t crossing, bool left_out, std::uint64_t seed = 20000);
/// Whether problem p of so many is one of those `crossing` ones.
inline bool is_crossed(std::size_t p, std::size_t problems, std::size_t crossing) {
  return (p + 1) * crossing / problems > p * crossing / problems;
}

/// One problem of `large` vertices, uniform in the unit square, without constraints, and after it `problems` random
/// planar graphs of 20 vertices as in sketches(). The same bits on every machine.
SketchBatch one_large(std::size_t large, std::size_t problems, std::uint64_t seed = 21000);

}  // namespace gcdt::bench

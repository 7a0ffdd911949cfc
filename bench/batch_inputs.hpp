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

/// One problem of `large` vertices, uniform in the unit square, without constraints, and after it `problems` random
/// planar graphs of 20 vertices as in sketches(). The same bits on every machine.
SketchBatch one_large(std::size_t large, std::size_t problems, std::uint64_t seed = 21000);

}  // namespace gcdt::bench

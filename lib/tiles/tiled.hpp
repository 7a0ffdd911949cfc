// SPDX-License-Identifier: Apache-2.0
// One problem in tiles: each tile is a problem of a batch, and what is left between them is one more.
#pragma once

#include "batch/device_pool.hpp"
#include "tiles/cuts.hpp"

namespace gcdt::tiles {

/// What one problem in tiles has cost.
struct TiledReport {
  std::size_t tiles = 1;
  std::uint64_t seam_vertices = 0, seam_constraints = 0;
  /// Of the steps: placing vertices on the grid and sharing out the input; the tiles' calls; finding final triangles;
  /// making the seam's problem and its call; joining, with its check.
  double ms_share = 0, ms_tiles = 0, ms_final = 0, ms_seam = 0, ms_join = 0;
};

/// Triangulates one problem on the pool's devices, in canonical order: the result has the same bytes as one device
/// would give (docs/scale.md). `batch` has that problem alone. Throws what triangulate() does, and out_of_memory if a
/// tile or the seam is too large for every device.
ForestResult triangulate_tiled(DevicePool& pool, const BatchInput& batch, const Options& options, std::size_t tiles,
                               TiledReport& report);

/// The same for cuts of the caller's choice; `points` are those of the problem on their grid. For tests.
ForestResult triangulate_tiled(DevicePool& pool, const BatchInput& batch, const Options& options,
                               const std::function<Cuts(const std::vector<GridPoint>&)>& cut, TiledReport& report);

}  // namespace gcdt::tiles

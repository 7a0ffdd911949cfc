// SPDX-License-Identifier: Apache-2.0
// One problem in tiles: each tile is a problem of a batch, and what is left between them is one more.
#pragma once

#include "batch/device_pool.hpp"
#include "tiles/cuts.hpp"

namespace gcdt::tiles {

/// As pool.triangulate(), but problems are cut into options.tiles tiles; if that is 0, those that are too large for
/// every device, into as many as it takes. A problem in tiles has a result of its own, in canonical order, with the
/// bytes that one device would give (docs/scale.md).
PoolResult triangulate(DevicePool& pool, const BatchInput& batch, const Options& options);

/// One problem, the batch's first, cut where the caller wants: `cut` is given it on its grid, and makes about so many
/// `tiles`. Throws what gcdt::triangulate() does, and out_of_memory if a tile or the seam is too large for every
/// device.
ForestResult triangulate_cut(DevicePool& pool, const BatchInput& batch, const Options& options, std::size_t tiles,
                             const std::function<Cuts(const GridInput&)>& cut);

/// So many tiles that each fits the pool's largest device, with a quarter to spare for tiles that are larger than
/// others and the ends of constraints that pass; or up to twice as many, if then the input and a tile that leaves have
/// room beside a tile (spiller.hpp). Ends: a tile needs less memory than its problem.
std::size_t tiles_that_fit(const DevicePool& pool, std::uint64_t n, std::uint64_t m);

class TiledRun;

/// The box around all vertices, of which there are some. Throws coordinate_outside_grid as order() does. All ranks do.
void take_survey(GridInput& input, const Survey& surveyed, Team& team);
/// Throws index_out_of_range as cleaning does. All ranks do.
void check_ends(const GridInput& input, Team& team);

/// Adds to a result what is said of its grid. Throws vertices_coincide.
void describe(TiledRun& run, const GridInput& input, const Options& options, const TiledReport& report,
              ForestResult& joined);

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
// Which vertex comes when: levels by rank on the curve, and isolated vertices earlier (kernels/order/isolation.h).
#pragma once

#include <vector>

#include "mesh/primitives.hpp"
#include "order/isolation.h"

namespace gcdt {

/// The codes of input points, ascending, and the scan of the marks of kernel mark_first: distinct codes before each.
struct SortedCodes {
  cl_uint count;
  const runtime::Buffer<cl_ulong>& codes;
  const runtime::Buffer<cl_uint>& before;
};

struct ChosenLevels {
  device::Levels levels;
  device::DepthLevels by_depth;  ///< read if levels.tabled
};

/// The levels of vertices of which there are so many of each depth and stride (GCDT_DEPTH_COUNTS numbers), with at most
/// `coarsest` in the coarsest where their number allows.
///
/// By rank, n_j vertices come before the end of level j. Those less deep than a cut come with them, too: as many of the
/// least deep as make up a share of n_j. But where vertices are spread evenly none is isolated, and no table is wanted.
/// There, depths lie close to the median, and vertices of a level i above the finest would be i less deep if they were
/// alone. So a cut is also Tuning::isolation_margin below that. And a chain is as long as a dense row, which there is
/// only if many vertices are deeper than evenly spread ones are.
ChosenLevels choose_levels(const std::vector<cl_uint>& counts, std::uint32_t coarsest, const Tuning& tuning);

/// Of vertices on the device. Blocks.
ChosenLevels choose_levels(runtime::Runtime& runtime, const SortedCodes& sorted, std::uint32_t coarsest);

/// The levels on the device, and behind them, if levels.tabled, the table.
runtime::Buffer<device::Levels> make_levels(runtime::Runtime& runtime, Primitives& primitives,
                                            const SortedCodes& sorted, const ChosenLevels& chosen);

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/levels.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace gcdt {

namespace {

/// Of what levels are numbered by. GCDT_MAX_LEVELS of them.
constexpr unsigned level_bits = 4;
static_assert(GCDT_MAX_LEVELS <= 1 << level_bits, "a level has so many bits");

/// The number of vertices of each depth.
using Depths = std::array<cl_uint, GCDT_QUADTREE_DEPTHS>;

int median_depth(const Depths& of_depth, cl_uint n) {
  std::size_t median = 0;
  for (std::uint64_t upto = of_depth[0]; 2 * upto < n; upto += of_depth[median]) ++median;
  return static_cast<int>(median);
}

// Whether many vertices are deeper than evenly spread ones, of which one in 4^k is k deeper than log4(n).
bool has_rows(const Depths& of_depth, cl_uint n, const Tuning& tuning) {
  std::size_t depth = 0;
  for (std::uint64_t cells = 1; cells < n; cells *= 4) ++depth;
  std::uint64_t deeper = std::accumulate(of_depth.begin() + depth, of_depth.end(), std::uint64_t{0}), evenly = n;
  for (; depth < of_depth.size(); deeper -= of_depth[depth++], evenly /= 4)
    if (deeper > tuning.times_evenly * evenly + tuning.least_row) return true;
  return false;
}

constexpr std::size_t table_bytes(std::size_t n) { return 2 * n * sizeof(cl_uint); }

}  // namespace

ChosenLevels choose_levels(const std::vector<cl_uint>& counts, std::uint32_t coarsest, const Tuning& tuning) {
  Depths of_depth;
  for (unsigned depth = 0; depth < GCDT_QUADTREE_DEPTHS; ++depth) {
    const auto row = counts.begin() + GCDT_DEPTH_COUNT(depth, 0);
    of_depth[depth] = std::accumulate(row, row + GCDT_MAX_LEVELS, cl_uint{0});
  }
  const cl_uint n = std::accumulate(of_depth.begin(), of_depth.end(), cl_uint{0});
  ChosenLevels chosen = {device::make_levels(n, coarsest), {}};
  device::Levels& levels = chosen.levels;
  if (!has_rows(of_depth, n, tuning)) return chosen;
  const int median = median_depth(of_depth, n);
  cl_uint isolated = 0;
  for (unsigned j = 0; j + 1 < levels.count; ++j) {
    const int above = GCDT_STRIDE_BITS(levels.count - 1 - j) / 2;  // depths of the quadtree
    const int most = std::min(median + 1 - above - tuning.isolation_margin, static_cast<int>(GCDT_QUADTREE_DEPTHS));
    cl_uint& below = chosen.by_depth.below[j];
    for (cl_uint taken = 0; static_cast<int>(below) < most; ++below) {
      taken += of_depth[below];
      if (taken > levels.begin[j + 1] / Tuning::share_isolated) break;
      isolated = std::max(isolated, taken);
    }
  }
  if (isolated == 0) return chosen;
  levels.tabled = 1;
  std::array<cl_uint, GCDT_MAX_LEVELS> sizes = {};
  for (unsigned depth = 0; depth < GCDT_QUADTREE_DEPTHS; ++depth)
    for (unsigned strides = 0; strides < GCDT_MAX_LEVELS; ++strides)
      sizes[device::gcdt_level(levels.count, &chosen.by_depth, strides, depth)] +=
          counts[GCDT_DEPTH_COUNT(depth, strides)];
  for (unsigned j = 0; j < levels.count; ++j) levels.begin[j + 1] = levels.begin[j] + sizes[j];
  return chosen;
}

ChosenLevels choose_levels(runtime::Runtime& runtime, const SortedCodes& sorted, std::uint32_t coarsest) {
  const auto counted = runtime.filled<cl_uint>("counts of depths", GCDT_DEPTH_COUNTS, 0);
  runtime.launch("order", "count_depths", runtime::over(sorted.count), sorted.count, sorted.codes, sorted.before,
                 counted);
  std::vector<cl_uint> counts(GCDT_DEPTH_COUNTS);
  runtime.read(counted, counts.data(), counts.size());
  return choose_levels(counts, coarsest, runtime.tuning());
}

runtime::Buffer<device::Levels> make_levels(runtime::Runtime& runtime, Primitives& primitives,
                                            const SortedCodes& sorted, const ChosenLevels& chosen) {
  const device::Levels& levels = chosen.levels;
  if (!levels.tabled) return runtime.upload_one("levels", levels);
  // Keys of 64 bits, since the program that sorts them is needed in any case.
  auto keys = runtime.allocate<cl_ulong>("levels of ranks", levels.n);
  auto ranks = runtime.allocate<cl_uint>("ranks", levels.n);
  const auto by_depth = runtime.upload_one("levels of depths", chosen.by_depth);
  runtime.launch("order", "level_vertices", runtime::over(sorted.count), sorted.count, cl_uint{levels.count}, by_depth,
                 sorted.codes, sorted.before, keys, ranks);
  primitives.sort(keys, ranks, levels.n, level_bits);
  const std::size_t with_table = 1 + (table_bytes(levels.n) + sizeof(levels) - 1) / sizeof(levels);
  auto made = runtime.allocate<device::Levels>("levels", with_table);
  runtime.write(made, &levels, 1);
  runtime.launch("order", "table_levels", runtime::over(levels.n), cl_uint{levels.n}, ranks, made);
  return made;
}

}  // namespace gcdt

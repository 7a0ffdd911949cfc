// SPDX-License-Identifier: Apache-2.0
// Problems that a worker runs before it takes part in its first batch. Some drivers compile a kernel at its first
// launch, which takes PoCL seconds. The warm-up launches all kernels, so that no later batch waits for the compiler.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "batch/problems.hpp"
#include "device/tuning.hpp"

namespace gcdt {

/// Problems that reach every kernel a batch may need, on all kinds of grids. `vertices`: of each problem, 40 or more,
/// two of which are equal. Each problem has a constraint that crosses edges and has a vertex inside, one that overlaps
/// it, one of length 0, and a ring within a ring. Every fourth problem also has a constraint that crosses the first;
/// every eighth has only these two.
class WarmupBatch {
 public:
  explicit WarmupBatch(const std::vector<std::uint32_t>& vertices);
  BatchInput view() const;

 private:
  std::vector<std::array<double, 2>> vertices_;
  std::vector<Constraint> constraints_;
  std::vector<std::uint64_t> vertex_offsets_ = {0}, constraint_offsets_ = {0};
};

/// How many vertices the problems of each run of a warm-up have, on a device of so many compute units.
std::vector<std::vector<std::uint32_t>> warmup_runs(std::uint32_t compute_units, Crossing crossing);

/// While it lives, few constraints take the ways of many that are edges already, and of large meshes.
class FewAsMany {
 public:
  explicit FewAsMany(Tuning& tuning)
      : tuning_(tuning), least_existing_(tuning.least_existing), least_grouped_(tuning.least_grouped) {
    tuning_.least_existing = 0;
    tuning_.least_grouped = 0;
  }
  ~FewAsMany() {
    tuning_.least_existing = least_existing_;
    tuning_.least_grouped = least_grouped_;
  }
  FewAsMany(const FewAsMany&) = delete;
  FewAsMany& operator=(const FewAsMany&) = delete;

 private:
  Tuning& tuning_;
  const std::optional<std::uint32_t> least_existing_;
  const std::uint32_t least_grouped_;
};

/// The options that decide which kernels a warm-up launches.
using WarmupKey = std::array<int, 3>;
inline WarmupKey warmup_key(const Options& options) {
  return {static_cast<int>(options.crossing), options.domain != Domain::hull, options.regions};
}

}  // namespace gcdt

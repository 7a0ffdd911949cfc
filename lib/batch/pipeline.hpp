// SPDX-License-Identifier: Apache-2.0
// Many problems in one run on one device: a forest (kernels/common/forest.h), from and to host memory.
#pragma once

#include "batch/problems.hpp"
#include "device/upload.hpp"

namespace gcdt {

/// Host memory that the runs on a runtime use one after the other: chunks for uploads, and room for offsets. It also
/// remembers which part of the room for results (copy.hpp) the last run used.
struct Staging {
  runtime::TransferChunks chunks;
  HostArray offsets;
  std::array<double, array_slots> filled;

  explicit Staging(runtime::Runtime& runtime) : chunks(runtime::upload_chunks(runtime)) { filled.fill(0.75); }
};

/// Triangulates problems `numbers` of the batch in one run. They have at most max_vertices vertices together, with 3
/// more for each problem. Those that cross do not stop it: the result says which are refused or to be split. Throws
/// InvalidProblems, which counts in `numbers`, if the input of some is invalid, and Error if something is wrong with
/// the run.
ForestResult triangulate_forest(runtime::Runtime& runtime, Primitives& primitives, const BatchInput& batch,
                                std::vector<std::uint32_t> numbers, const Options& options, Staging& staging);

/// About how many bytes of device memory a run of so many problems, vertices and constraints needs.
std::uint64_t forest_bytes(std::uint64_t problems, std::uint64_t n, std::uint64_t m);

}  // namespace gcdt

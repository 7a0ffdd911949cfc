// SPDX-License-Identifier: Apache-2.0
// Many problems in one run on one device: a forest (kernels/common/forest.h), from and to host memory.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "batch/forest_order.hpp"
#include "device/upload.hpp"
#include "query/arrays.hpp"
#include "solve/run.hpp"

namespace gcdt {

/// A ragged batch in the caller's memory: problem p has the vertices [vertex_offsets[p], vertex_offsets[p + 1]) and
/// so its constraints, whose ends count from its own first vertex.
struct BatchInput {
  std::uint64_t problems = 0;
  Points::Type type = Points::Type::float64;
  const void* vertices = nullptr;
  const std::uint64_t* vertex_offsets = nullptr;
  const Constraint* constraints = nullptr;
  const std::uint64_t* constraint_offsets = nullptr;

  std::uint64_t n(std::uint64_t p) const { return vertex_offsets[p + 1] - vertex_offsets[p]; }
  std::uint64_t m(std::uint64_t p) const { return constraint_offsets[p + 1] - constraint_offsets[p]; }
};

/// What one run made of some problems of a batch: every problem's arrays are what it would have alone.
struct ForestResult {
  std::vector<std::uint32_t> problems;    ///< their numbers in the batch; those of `alone` last
  std::vector<Grid> grids;                ///< of each
  std::vector<RoundedTogether> together;  ///< of each; empty: none of any
  // By number.
  std::array<HostArray, array_slots> arrays;
  std::array<std::vector<std::uint64_t>, array_slots> begins;  ///< elements; P + 1, or none if there is no such array
  Statistics statistics;
  std::vector<ForestResult> alone;  ///< results of one problem each (alone.hpp)

  void add(ForestResult one) {
    problems.push_back(one.problems.at(0));
    alone.push_back(std::move(one));
  }
  std::uint64_t triangles() const {
    const auto& ends = begins[GCDT_TRIANGLES];
    std::uint64_t count = ends.empty() ? 0 : ends.back();
    for (const ForestResult& one : alone) count += one.triangles();
    return count;
  }
  /// Where the problem at that place is: in this result or one of `alone`, and its place there.
  std::pair<const ForestResult*, std::size_t> at(std::size_t place) const {
    const std::size_t joined = problems.size() - alone.size();
    return place < joined ? std::make_pair(this, place) : std::make_pair(&alone[place - joined], std::size_t{0});
  }
};

/// What runs one after the other on a runtime share on the host: the way to the device, memory for offsets, and how
/// much of the room for results (forest_copy.hpp) the last run used.
struct Staging {
  runtime::UploadChunks chunks;
  HostArray offsets;
  std::array<double, array_slots> filled;

  explicit Staging(runtime::Runtime& runtime) : chunks(runtime) { filled.fill(0.75); }
};

/// Triangulates problems `numbers` of the batch, together at most max_vertices vertices (with 3 more per problem), in
/// one run. Throws InvalidProblems (numbers count in `numbers`), if any has an error of
/// its own or crosses under Crossing::split, and Error if something is wrong with the run.
ForestResult triangulate_forest(runtime::Runtime& runtime, Primitives& primitives, const BatchInput& batch,
                                std::vector<std::uint32_t> numbers, const Options& options, Staging& staging);

/// Bytes of device memory that a run of so many problems with so many vertices and constraints needs, about.
std::uint64_t forest_bytes(std::uint64_t problems, std::uint64_t n, std::uint64_t m);

}  // namespace gcdt

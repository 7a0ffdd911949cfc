// SPDX-License-Identifier: Apache-2.0
// Batches for tests, and their parts against problems alone.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "batch/pipeline.hpp"
#include "corpus.hpp"
#include "workloads.hpp"

namespace gcdt::test {

/// Problems one after the other, as the interface takes them.
struct RaggedBatch {
  std::vector<std::array<double, 2>> vertices;
  std::vector<Constraint> constraints;
  std::vector<std::uint64_t> vertex_offsets = {0}, constraint_offsets = {0};

  explicit RaggedBatch(const std::vector<Workload>& problems);
  BatchInput view() const {
    return {vertex_offsets.size() - 1, Points::Type::float64, vertices.data(),
            vertex_offsets.data(),     constraints.data(),    constraint_offsets.data()};
  }
};

/// Those that problems of a batch may have: number and name.
std::vector<std::pair<std::int32_t, const char*>> arrays();

/// The part of the problem at that place of a run.
Triangulation part_of(const ForestResult& run, std::size_t place_in_run);

bool same_grid(const Grid& a, const Grid& b);

/// The first array that differs; empty if all bytes and the grids are equal.
std::string difference(const Triangulation& a, const Triangulation& b);

Workload problem(std::vector<std::array<double, 2>> points, std::vector<Constraint> constraints = {});

std::vector<Workload> smallest_problems();

/// The files of the corpus with one of these statuses.
std::vector<Workload> corpus(const std::set<std::string>& statuses);

std::vector<Workload> generated_problems();

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
// The problems of a batch, those that go through one run together, and what the run makes of them.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "device/host_array.hpp"
#include "query/arrays.hpp"

namespace gcdt {

/// A ragged batch in the caller's memory. Problem p has the vertices [vertex_offsets[p], vertex_offsets[p + 1]) and the
/// constraints [constraint_offsets[p], constraint_offsets[p + 1]), whose ends count from its own first vertex.
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

/// Where the problems of a run begin among all input vertices and constraints, on host and device: P + 1 elements.
struct ProblemRanges {
  std::vector<cl_uint> first_input, first_constraint;
  runtime::Buffer<cl_uint> first_input_buffer, first_constraint_buffer;
  std::uint32_t count() const { return static_cast<std::uint32_t>(first_input.size() - 1); }
};

/// Problems of a run with invalid input, by their numbers in the run, with their errors. They are found before any
/// result is made, and the others may be right.
struct InvalidProblems {
  std::vector<std::pair<std::uint32_t, Error>> errors;
};

/// Whether an error is of one problem of a batch, and says nothing of the others.
inline bool is_of_problem(Status status) {
  switch (status) {
    case Status::coordinate_not_finite:
    case Status::coordinate_outside_grid:
    case Status::index_out_of_range:
    case Status::too_many_vertices:
    case Status::constraints_cross:
    case Status::vertices_coincide:
    case Status::spill_failed:
    case Status::out_of_memory: return true;
    default: return false;
  }
}

inline bool has_seeds(const Options& options) { return !options.hole_seeds.empty() || !options.region_seeds.empty(); }

/// Seeds are of one problem. Throws invalid_argument if there are more.
inline void check_seeds(const Options& options, std::uint64_t problems) {
  if (has_seeds(options) && problems > 1)
    throw Error(Status::invalid_argument,
                "hole and region seeds are of one problem: a batch of " + std::to_string(problems) + " takes none");
}

/// What a problem in tiles has cost (lib/tiles).
struct TiledReport {
  std::uint32_t tiles = 0;  ///< 0: it was not cut
  std::uint64_t seam_vertices = 0, seam_constraints = 0;
  /// Of the steps: choosing the grid and sharing out the constraints; the tiles' runs; making the seam's problem and
  /// its run; copying what is final to its place; the rest of the result, with its check.
  double ms_share = 0, ms_tiles = 0, ms_seam = 0, ms_write = 0, ms_join = 0;
};

/// What one run made of some problems of a batch. Every problem's arrays are what it would have by itself, but of those
/// that are refused or to be split: there they mean nothing.
struct ForestResult {
  std::vector<std::uint32_t> problems;    ///< their numbers in the batch; those of `singles` last
  std::vector<Grid> grids;                ///< of each
  std::vector<RoundedTogether> together;  ///< of each; empty: none of any
  // Problems whose constraints cross, by place, ascending.
  std::vector<std::pair<std::uint32_t, Error>> refused;  ///< under Crossing::reject
  std::vector<std::uint32_t> to_split;                   ///< under Crossing::split, by single.hpp
  // By number.
  std::array<HostArray, array_slots> arrays;
  std::array<std::vector<std::uint64_t>, array_slots> begins;  ///< elements; P + 1, or none if there is no such array
  std::vector<std::uint32_t> routed;  ///< of a single: the constraints that splitting has replaced, ascending
  TiledReport tiles;                  ///< of a result of one problem
  Statistics statistics;
  std::vector<ForestResult> singles;  ///< results of one problem each (single.hpp)

  void add(ForestResult one) {
    problems.push_back(one.problems.at(0));
    singles.push_back(std::move(one));
  }
  std::uint64_t triangles() const {
    const auto& first = begins[GCDT_TRIANGLES];
    std::uint64_t count = first.empty() ? 0 : first.back();
    for (const auto& [place, error] : refused) count -= first[place + 1] - first[place];
    for (const std::uint32_t place : to_split) count -= first[place + 1] - first[place];
    for (const ForestResult& one : singles) count += one.triangles();
    return count;
  }
  /// Where the problem at that place is: in this result or one of `singles`, and its place there.
  std::pair<const ForestResult*, std::size_t> at(std::size_t place) const {
    const std::size_t joined = problems.size() - singles.size();
    return place < joined ? std::make_pair(this, place) : std::make_pair(&singles[place - joined], std::size_t{0});
  }
};

}  // namespace gcdt

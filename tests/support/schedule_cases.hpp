// SPDX-License-Identifier: Apache-2.0
// Batches whose problems are sizes alone, and workers, for tests of schedules.
#pragma once

#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "batch/schedule.hpp"

namespace gcdt::schedule_cases {

/// Problems of so many vertices and no constraints; nobody reads them.
struct Sizes {
  std::vector<std::uint64_t> vertex_offsets = {0}, constraint_offsets;

  explicit Sizes(const std::vector<std::uint64_t>& sizes) {
    for (const std::uint64_t n : sizes) vertex_offsets.push_back(vertex_offsets.back() + n);
    constraint_offsets.assign(vertex_offsets.size(), 0);
  }
  BatchInput view() const {
    return {vertex_offsets.size() - 1, Points::Type::float64, nullptr, vertex_offsets.data(), nullptr,
            constraint_offsets.data()};
  }
};

inline WorkerState worker(std::size_t device, double throughput = 0, std::uint64_t capacity = std::uint64_t{1} << 40) {
  WorkerState state;
  state.device = device;
  state.plan.capacity = state.plan.job_bytes = capacity;
  state.plan.job_weight = std::uint64_t{1} << 24;
  state.throughput = Throughput(throughput);
  return state;
}

inline ForestResult result_of(const Job& job) {
  ForestResult result;
  result.problems = job.problems;
  return result;
}

inline void finish(Schedule& schedule, std::size_t number, const std::shared_ptr<Job>& job, double milliseconds = 1) {
  schedule.finish(number, job, result_of(*job), {}, milliseconds);
}

/// Every problem has one place in the results, where its number stands, or an error.
inline void check_settled(const Schedule& schedule, std::size_t problems) {
  CHECK(schedule.unsettled() == 0);
  for (std::size_t p = 0; p < problems; ++p) {
    if (schedule.errors.count(static_cast<std::uint32_t>(p)) > 0) continue;
    const Schedule::Place place = schedule.places[p];
    REQUIRE(place.result < schedule.results.size());
    REQUIRE(place.place < schedule.results[place.result].problems.size());
    CHECK(schedule.results[place.result].problems[place.place] == p);
  }
}

/// So many problems of weight 1000 each.
inline Sizes thousands(std::size_t problems) {
  return Sizes(std::vector<std::uint64_t>(problems, 1000 - Tuning::problem_weight));
}

/// So many thousands, but for a problem less: the clock goes on while a test runs.
inline bool nearly(std::uint64_t weight, std::uint64_t thousand) {
  return weight == thousand * 1000 || weight == (thousand - 1) * 1000;
}

inline Error shortage() { return Error(Status::out_of_memory, "made up"); }

}  // namespace gcdt::schedule_cases

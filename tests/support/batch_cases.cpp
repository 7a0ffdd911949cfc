// SPDX-License-Identifier: Apache-2.0
#include "batch_cases.hpp"

namespace gcdt::test {

namespace {

/// Empty if the run has no such array.
template <class T>
Array<T> array_of(const ForestResult& forest, std::size_t place, std::int32_t number, const Array<T>&) {
  const auto slot = static_cast<std::size_t>(number);
  const auto& begins = forest.begins.at(slot);
  if (begins.empty()) return {};
  const T* all = reinterpret_cast<const T*>(forest.arrays.at(slot).bytes.get());
  return {all + begins[place], all + begins[place + 1]};
}

}  // namespace

RaggedBatch::RaggedBatch(const std::vector<Workload>& problems) {
  for (const Workload& problem : problems) {
    vertices.insert(vertices.end(), problem.points.begin(), problem.points.end());
    constraints.insert(constraints.end(), problem.constraints.begin(), problem.constraints.end());
    vertex_offsets.push_back(vertices.size());
    constraint_offsets.push_back(constraints.size());
  }
}

std::vector<std::pair<std::int32_t, const char*>> arrays() {
  return {
#define GCDT_ARRAY(number, name, ...) {number, #name},
#include <gcdt/arrays.def>
  };
}

Triangulation part_of(const ForestResult& run, std::size_t place_in_run) {
  const auto [found, place] = run.at(place_in_run);
  const ForestResult& forest = *found;
  Triangulation part;
#define GCDT_ARRAY(number, name, ...) part.name = array_of(forest, place, number, part.name);
#include <gcdt/arrays.def>
  part.statistics.grid = forest.grids[place];
  return part;
}

bool same_grid(const Grid& a, const Grid& b) {
  return a.kind == b.kind && a.origin == b.origin && a.cell_units == b.cell_units &&
         a.cell_decimals == b.cell_decimals && a.cell_exponent == b.cell_exponent && a.largest_move == b.largest_move;
}

std::string difference(const Triangulation& a, const Triangulation& b) {
  if (!same_grid(a.statistics.grid, b.statistics.grid)) return "grid";
#define GCDT_ARRAY(number, name, ...) \
  if (a.name != b.name) return #name;
#include <gcdt/arrays.def>
  return {};
}

Workload problem(std::vector<std::array<double, 2>> points, std::vector<Constraint> constraints) {
  Workload work;
  work.points = std::move(points);
  work.constraints = std::move(constraints);
  return work;
}

std::vector<Workload> smallest_problems() {
  const auto line = [] {
    Workload work;
    for (std::uint32_t i = 0; i < 40; ++i) work.points.push_back({0.5 * i, 0.25 * i});
    work.constraints = {{3, 30}, {30, 3}, {5, 5}};
    return work;
  };
  return {problem({}),
          problem({{1, 2}}),
          problem({{1, 2}, {3, 4}}, {{0, 1}}),
          problem({}),
          problem({{0, 0}, {1, 0}, {0, 1}}, {{2, 1}}),
          line(),
          problem({{7, 7}, {7, 7}, {7, 7}}, {{0, 2}}),
          problem({{0.1, 0.2}, {0.3, 0.2}, {0.3, 0.5}, {0.1, 0.5}, {0.1, 0.2}}, {{0, 2}, {4, 2}}),
          problem({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}, {3, 2}}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}}),
          problem({{1, 2}, {1, 2}}),
          problem({})};
}

std::vector<Workload> corpus(const std::set<std::string>& statuses) {
  const std::string folder = GCDT_TEST_DATA "/corpus";
  std::vector<Workload> problems;
  for (const CorpusEntry& entry : read_manifest(folder))
    if (statuses.count(entry.status) > 0) problems.push_back(read_poly(folder + "/" + entry.name));
  return problems;
}

std::vector<Workload> generated_problems() {
  std::vector<Workload> problems;
  for (const std::string& name : workload_names())
    for (const std::size_t n : {3, 17, 90, 700})
      problems.push_back(workload(name, name == "random_pslg" ? n / 10 + 2 : n));
  problems.push_back(uniform(5000));
  problems.push_back(workload("random_pslg", 90));
  return problems;
}

}  // namespace gcdt::test

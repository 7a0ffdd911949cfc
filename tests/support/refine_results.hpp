// SPDX-License-Identifier: Apache-2.0
// Refined meshes of integer inputs, and what it means that two are the same.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "refine_oracle.hpp"
#include "workloads.hpp"

namespace gcdt::test {

/// The input in a square of 2^30 cells: what is refined here must have integers.
inline Workload on_integers(Workload work) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const Point& p : work.points)
    for (const double x : p) least = std::min(least, x), most = std::max(most, x);
  for (Point& p : work.points)
    for (double& x : p) x = std::round(std::ldexp((x - least) / (most - least), 30));
  return work;
}

/// What a test refines, and how. Of integers.
struct RefineCase {
  std::string name;
  Workload work;
  Options options;
};

inline RefinedResult result_of(runtime::Runtime& runtime, const Workload& work, const Options& options) {
  Primitives primitives(runtime);
  return read_refined(runtime,
                      triangulate(runtime, primitives, source_of(runtime, work.points, work.constraints), options),
                      integers(work.points));
}

/// The triangles with all that is said of them, by coordinates.
inline std::vector<std::vector<std::int64_t>> by_coordinates(const RefinedResult& r) {
  std::vector<std::vector<std::int64_t>> all;
  for (std::size_t t = 0; t < r.triangles.size(); ++t) {
    std::vector<std::int64_t> row;
    for (int k = 0; k < 3; ++k) {
      row.push_back(r.points[r.triangles[t][k]][0]);
      row.push_back(r.points[r.triangles[t][k]][1]);
      row.push_back(r.neighbours[t][k]);
    }
    row.push_back(r.constrained[t]);
    all.push_back(row);
  }
  return all;
}

inline bool same(const RefinedResult& a, const RefinedResult& b) {
  const auto words = [](const RefinedResult& r) {
    std::vector<cl_uint> all;
    for (const cl_uint4& origin : r.origins) all.insert(all.end(), origin.s, origin.s + 4);
    return all;
  };
  return words(a) == words(b) && by_coordinates(a) == by_coordinates(b) && a.points == b.points &&
         a.triangles == b.triangles && a.pieces == b.pieces && a.sources == b.sources;
}

}  // namespace gcdt::test

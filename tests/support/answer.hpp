// SPDX-License-Identifier: Apache-2.0
// What a solver says of an input, result or error, for tests that compare two ways of going.
#pragma once

#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "workloads.hpp"

namespace gcdt::test {

struct Answer {
  Triangulation mesh;
  std::string error;  ///< none: empty
  std::vector<std::uint64_t> indices;
};

inline Answer ask(Solver& solver, const Workload& work, const Options& options = {}) {
  Answer answer;
  try {
    answer.mesh = solver.triangulate(work.points, work.constraints, options);
  } catch (const Error& error) {
    answer.error = error.what();
    answer.indices = error.indices();
  }
  return answer;
}

}  // namespace gcdt::test

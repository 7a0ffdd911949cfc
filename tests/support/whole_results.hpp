// SPDX-License-Identifier: Apache-2.0
// Whole results of the solver that all tests of a file share, and the inputs that they begin with.
#pragma once

#include <doctest/doctest.h>

#include "solver_fixture.hpp"

namespace gcdt::test {

inline Triangulation triangulated(const Workload& work, Crossing crossing = Crossing::reject) {
  Options options;
  options.crossing = crossing;
  return solver().triangulate(work.points, work.constraints, options);
}

/// The error that triangulating throws; fails the test if it throws none.
inline Error error_of(Points points, Constraints constraints = {}, const Options& options = {}) {
  try {
    solver().triangulate(points, constraints, options);
  } catch (const Error& error) {
    return error;
  }
  FAIL_CHECK("nothing was thrown");
  return Error(Status::ok, "nothing was thrown");
}

inline bool same_bytes(const Triangulation& a, const Triangulation& b) {
#define GCDT_ARRAY(number, name, ...) \
  if (a.name != b.name) return false;
#include <gcdt/arrays.def>
  return true;
}

/// A mixture of what the corpus' ideas are made of, with integer coordinates and no crossings.
inline std::vector<Workload> samples() {
  std::vector<Workload> result{grid(100),
                               lattice_circle(200),
                               collinear_runs(80),
                               comb(50),
                               nested_squares(60),
                               hub(60),
                               line_and_one(30),
                               parabola(60),
                               random_pslg(40, 8, 80, 1),
                               random_pslg(60, 30, 120, 2),
                               random_pslg(60, 1000, 200, 3)};
  return result;
}

template <class Map>
Workload moved(Workload work, Map map) {
  for (Point& p : work.points) p = map(p);
  return work;
}

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
// The proof that tests of maps ask for: crossings split, the mesh and its domain shown to be right.
#pragma once

#include <doctest/doctest.h>

#include <cmath>

#include "corpus.hpp"
#include "solver_fixture.hpp"

namespace gcdt::test {

/// Triangulated with crossings split, twice: as it is, and as what is not open to the outside. Proves both; the first.
inline Triangulation proved(const Workload& map) {
  Options options;
  options.crossing = Crossing::split;
  const Triangulation mesh = solver().triangulate(map.points, map.constraints, options);
  MeshView seen = view(mesh);
  seen.added = mesh.added_on_grid;
  CHECK(verify(map.points, map.constraints, seen, mesh.statistics.grid, Crossing::split).reason == "");
  options.domain = Domain::outer;
  const Triangulation land = solver().triangulate(map.points, map.constraints, options);
  seen = view(land);
  seen.added = land.added_on_grid;
  const RegionView said = {land.region.data(), land.depth.data(), land.winding.data()};
  CHECK(verify_domain(map.points, map.constraints, seen, said, land.statistics.grid, options).reason == "");
  CHECK(land.triangles.size() + land.statistics.triangles_removed == mesh.triangles.size());
  CHECK(mesh.statistics.grid.kind == Grid::Kind::decimal);
  CHECK(mesh.statistics.grid.largest_move == 0);
  CHECK(mesh.statistics.constraint_move <= std::sqrt(0.5) * mesh.statistics.grid.cell());
  return mesh;
}

}  // namespace gcdt::test

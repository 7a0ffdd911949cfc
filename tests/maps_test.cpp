// SPDX-License-Identifier: Apache-2.0
// Maps as people have them: crossings split, the mesh and its domain proved. With GCDT_TEST_MAPS, a folder, all .poly
// files there, too.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>

#include "corpus.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

const std::string tests = GCDT_TEST_DATA;

Workload countries() { return readPoly(tests + "/../examples/data/countries-50m.poly"); }

/// Triangulated with crossings split, twice: as it is, and as what is not open to the outside. Proves both; the first.
Triangulation proved(const Workload& map) {
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

}  // namespace

TEST_CASE("the world's countries, which are clean, need no vertex more") {
  const Triangulation mesh = proved(countries());
  CHECK(mesh.statistics.crossings == 0);
  CHECK(mesh.statistics.vertices_added == 0);
  CHECK(mesh.statistics.constraints_pieces == 78650);
}

TEST_CASE("with eight sides across the whole map, as the antimeridian makes them: 258 crossings, 255 overlaps") {
  Workload map = countries();
  for (const Segment& side : {Segment{21993, 21994},
                              {22315, 22316},
                              {24222, 24263},
                              {24249, 24250},
                              {49951, 49959},
                              {49953, 49954},
                              {73725, 73726},
                              {73981, 76518}})
    map.constraints.push_back(side);
  const Triangulation mesh = proved(map);
  CHECK(mesh.statistics.crossings == 258);
  CHECK(mesh.statistics.constraints_overlapping == 255);
  CHECK(mesh.statistics.vertices_added == 258);
}

TEST_CASE("the counties of the United States: three crossings, three overlaps") {
  const Triangulation mesh = proved(readPoly(tests + "/maps/us-counties.poly"));
  CHECK(mesh.statistics.crossings == 3);
  CHECK(mesh.statistics.constraints_overlapping == 3);
  CHECK(mesh.statistics.vertices_added == 3);
}

TEST_CASE("further maps, if a folder with some is named") {
  const char* folder = std::getenv("GCDT_TEST_MAPS");
  if (!folder) return;
  std::size_t maps = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (file.path().extension() != ".poly") continue;
    CAPTURE(file.path().string());
    CHECK(proved(readPoly(file.path().string())).triangles.size() > 0);
    ++maps;
  }
  CHECK(maps > 0);
}

// SPDX-License-Identifier: Apache-2.0
// Maps as people have them: crossings split, the mesh and its domain proved. Further maps: scripts/slow.sh.
#include "map_proof.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

const std::string tests = GCDT_TEST_DATA;

Workload countries() { return read_poly(tests + "/../examples/data/countries-50m.poly"); }

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
  const Triangulation mesh = proved(read_poly(tests + "/maps/us-counties.poly"));
  CHECK(mesh.statistics.crossings == 3);
  CHECK(mesh.statistics.constraints_overlapping == 3);
  CHECK(mesh.statistics.vertices_added == 3);
}

// SPDX-License-Identifier: Apache-2.0
// Large inputs, each verified by exact host arithmetic and within the memory promised. Prints how deep the history tree
// and how long point location became, and the times, as a table on standard output.
#include <doctest/doctest.h>

#include <cinttypes>
#include <cstdio>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "oracle.hpp"
#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

std::vector<Segment> delaunay_edges(const std::vector<Point>& points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
  using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex>>;
  std::vector<std::pair<Kernel::Point_2, std::uint32_t>> sites;
  for (std::uint32_t i = 0; i < points.size(); ++i) sites.push_back({{points[i][0], points[i][1]}, i});
  const Delaunay delaunay(sites.begin(), sites.end());
  std::vector<Segment> edges;
  for (auto e = delaunay.finite_edges_begin(); e != delaunay.finite_edges_end(); ++e)
    edges.push_back(
        {e->first->vertex(Delaunay::cw(e->second))->info(), e->first->vertex(Delaunay::ccw(e->second))->info()});
  std::sort(edges.begin(), edges.end());
  return edges;
}

void check(const char* name, const Workload& work, const Options& options = {}) {
  CAPTURE(name);
  try {
    const Triangulation mesh = solver().triangulate(work.points, work.constraints, options);
    CHECK(fault(work.points, work.constraints, mesh, options.crossing) == "");
    CHECK(mesh.triangles.size() > work.points.size() / 4);
    const Statistics& s = mesh.statistics;
    static bool headed = false;
    if (!headed)
      std::printf("%-18s %9s %8s %6s %9s %7s %7s %10s %10s %9s %9s %7s\n", "input", "n", "m", "depth", "steps/n",
                  "insert", "flip", "flips", "crossed", "core ms", "full ms", "MiB");
    headed = true;
    std::printf(
        "%-18s %9zu %8zu %6" PRIu64 " %9.2f %7" PRIu64 " %7" PRIu64 " %10" PRIu64 " %10" PRIu64 " %9.0f %9.0f %7.0f\n",
        name, work.points.size(), work.constraints.size(), s.history_depth,
        static_cast<double>(s.location_steps) / static_cast<double>(work.points.size()), s.rounds.insert, s.rounds.flip,
        s.flips, s.crossed_pairs, s.ms.core, s.ms.full, static_cast<double>(s.peak_device_bytes) / 1048576);
    std::fflush(stdout);
  } catch (const std::exception& error) {
    FAIL_CHECK(error.what());
  }
}

}  // namespace

TEST_CASE("a million uniform vertices") { check("uniform", uniform(1000000)); }
TEST_CASE("a grid of 1024 x 1024 integer points") { check("grid", grid(1048576)); }
TEST_CASE("12,288 exactly cocircular vertices") { check("lattice_circle", lattice_circle(12288)); }
TEST_CASE("100,000 nearly cocircular vertices") { check("near_circle", near_circle(100000)); }
TEST_CASE("a spiral polygon of 100,000 vertices") { check("spiral", spiral(100000)); }
TEST_CASE("letters of 98,000 vertices") { check("letters", letters(98000)); }
TEST_CASE("200,000 vertices in clusters of very different scales") { check("clusters", clusters(200000)); }
TEST_CASE("1000 nearly parallel constraints across 200,000 vertices") { check("fan", fan(200000)); }
TEST_CASE("one constraint across a million vertices") { check("star", star(1000000)); }
TEST_CASE("10,000 constraints that meet in one vertex") { check("hub", hub(20000)); }
TEST_CASE("46,341 vertices on a parabola") { check("parabola", parabola(46341)); }

TEST_CASE("a million vertices and about 150,000 short constraints") {
  const Workload work = synthetic_cons(1000000, 1, delaunay_edges);
  CHECK(work.constraints.size() > 149000);
  check("synthetic_cons_1", work);
}

TEST_CASE("a million vertices and about 150,000 long constraints") {
  const Workload work = synthetic_cons(1000000, 6, delaunay_edges);
  CHECK(work.constraints.size() > 149000);
  check("synthetic_cons_6", work);
}

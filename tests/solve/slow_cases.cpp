// SPDX-License-Identifier: Apache-2.0
// Inputs that take minutes, or that are not in the tree; scripts/slow.sh runs them by name. Prints the times of each.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "map_proof.hpp"
#include "split_graphs.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

void print(const std::string& name, const Triangulation& mesh) {
  const Statistics& s = mesh.statistics;
  std::printf(
      "%s: n %zu m %zu, crossings %zu, added %zu, triangles %zu, core %.0f full %.0f ms, device memory %.0f MiB\n",
      name.c_str(), std::size_t(s.n), std::size_t(s.m), std::size_t(s.crossings), std::size_t(s.vertices_added),
      mesh.triangles.size(), s.ms.core, s.ms.full, static_cast<double>(s.peak_device_bytes) / 1048576);
  std::fflush(stdout);
}

}  // namespace

TEST_CASE("lattice: 2000 x 2000 lines have four million crossings, all vertices, and nothing moves") {
  const graphs::Graph graph = graphs::lattice(2000, 1 << 20);
  const Triangulation mesh = graphs::split(graph);
  print("lattice", mesh);
  CHECK(mesh.statistics.crossings == 4000000);
  CHECK(mesh.statistics.vertices_added == 4000000);
  CHECK(mesh.statistics.constraint_move == 0);
  CHECK(mesh.pieces.size() == 2 * 2000 * 2001);
  CHECK(graphs::fault(graph, mesh) == "");
}

TEST_CASE("star: 10,000 lines through one pixel cross in 50 million pairs") {
  const graphs::Graph graph = graphs::star(10000, 1 << 29);
  const Triangulation mesh = graphs::split(graph);
  print("star", mesh);
  CHECK(mesh.statistics.crossings == 10000 * 9999 / 2);
  CHECK(mesh.statistics.vertices_added < 100000);
  CHECK(graphs::fault(graph, mesh) == "");
}

TEST_CASE("maps: every .poly file of the folder GCDT_TEST_MAPS") {
  const char* folder = std::getenv("GCDT_TEST_MAPS");
  REQUIRE_MESSAGE(folder != nullptr, "GCDT_TEST_MAPS names no folder");
  std::size_t maps = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (file.path().extension() != ".poly") continue;
    CAPTURE(file.path().string());
    const Workload map = read_poly(file.path().string());
    const Triangulation mesh = proved(map);
    print(file.path().filename().string(), mesh);
    CHECK(mesh.triangles.size() > 0);
    // Natural Earth's countries 1:10 million, counted on its decimals with exact arithmetic by another program.
    if (map.points.size() == 472391 && map.constraints.size() == 472592) CHECK(mesh.statistics.crossings == 48);
    ++maps;
  }
  CHECK(maps > 0);
}

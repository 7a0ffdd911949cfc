// SPDX-License-Identifier: Apache-2.0
// Constraints: what becomes of one that runs through a vertex, and of two that cross.
#include <cstdio>

#include <gcdt/gcdt.hpp>

int main() {
  //  3 ------- 2
  //  |    4    |     Vertex 4 lies exactly on the diagonals 0-2 and 1-3.
  //  0 ------- 1
  const std::vector<std::array<std::int32_t, 2>> corners = {{0, 0}, {8, 0}, {8, 6}, {0, 6}};
  const std::vector<gcdt::Constraint> diagonals = {{0, 2}, {1, 3}};

  try {
    gcdt::Solver solver;  // keeps the device and its programs for all the calls below

    // With vertex 4 the diagonals do not cross: each is split there, into two edges.
    auto points = corners;
    points.push_back({4, 3});
    const gcdt::Triangulation split = solver.triangulate(points, diagonals);
    for (std::size_t i = 0; i < split.pieces.size(); ++i)
      std::printf("edge %u-%u belongs to diagonal %u\n", split.pieces[i][0], split.pieces[i][1],
                  split.sources[split.source_offsets[i]]);
    if (split.triangles.size() != 4 || split.pieces.size() != 4) return 1;

    // Without it they cross. That is an error, which names them ...
    try {
      solver.triangulate(corners, diagonals);
      return 1;
    } catch (const gcdt::Error& error) {
      if (error.status() != gcdt::Status::constraints_cross) throw;
      std::printf("refused: %s\n", error.what());
    }

    // ... unless the later one may be dropped.
    gcdt::Options options;
    options.crossing = gcdt::Crossing::drop;
    const gcdt::Triangulation dropped = solver.triangulate(corners, diagonals, options);
    std::printf("%zu triangles, diagonal %u dropped\n", dropped.triangles.size(), dropped.dropped.at(0));
    return dropped.triangles.size() == 2 && dropped.dropped == std::vector<std::uint32_t>{1} ? 0 : 1;
  } catch (const gcdt::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

// SPDX-License-Identifier: Apache-2.0
// README's example in C++: a square with a slit in it.
#include <cstdio>
#include <gcdt/gcdt.hpp>

int main() {
  // A square with a slit in it: six vertices, five constraints.
  std::vector<std::array<double, 2>> points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}, {3, 2}};
  std::vector<gcdt::Constraint> constraints = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}};
  try {
    gcdt::Triangulation mesh = gcdt::triangulate(points, constraints);
    for (auto [a, b, c] : mesh.triangles) std::printf("%u %u %u\n", a, b, c);
  } catch (const gcdt::Error& error) {  // says what is wrong with which vertices or constraints
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

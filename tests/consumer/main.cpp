// SPDX-License-Identifier: Apache-2.0
// The smallest program that uses all of the library's headers; built in every way that docs/using.md names.
#include <cstdio>

#include <gcdt/gcdt.hpp>
#include <gcdt/verify.hpp>

int main() try {
  const std::vector<std::array<double, 2>> points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}};
  const std::vector<gcdt::Constraint> constraints = {{0, 4}};
  const gcdt::Triangulation mesh = gcdt::triangulate(points, constraints);
  gcdt::MeshView view;
  view.triangles = mesh.triangles;
  const bool valid = gcdt::verify(points, constraints, view, mesh.statistics.grid).valid;
  std::printf("gcdt %s: %zu triangles, %s\n", gcdt::version(), mesh.triangles.size(), valid ? "valid" : "wrong");
  return valid && mesh.triangles.size() == 4 ? 0 : 1;
} catch (const gcdt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

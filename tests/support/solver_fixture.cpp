// SPDX-License-Identifier: Apache-2.0
#include "solver_fixture.hpp"

#include <cstdlib>

namespace gcdt::test {

std::string test_device() {
  if (const char* chosen = std::getenv("GCDT_TEST_DEVICE")) return chosen;
  const std::vector<DeviceInfo> all = devices();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].platform.find("Portable Computing Language") != std::string::npos && all[i].is_cpu)
      return std::to_string(i);
  throw Error(Status::no_device, "the tests need PoCL (Debian and Ubuntu: pocl-opencl-icd)");
}

Solver& solver() {
  static Solver instance(test_device());
  return instance;
}

MeshView view(const Triangulation& mesh) {
  MeshView result;
  result.triangles = mesh.triangles;
  result.neighbours = mesh.neighbours.data();
  result.constrained = mesh.constrained.data();
  return result;
}

std::string fault(Points points, Constraints constraints, const Triangulation& mesh, Crossing crossing) {
  if (mesh.neighbours.size() != mesh.triangles.size() || mesh.constrained.size() != mesh.triangles.size())
    return "neighbours or flags do not match the triangles in number";
  const Verification verification = verify(points, constraints, view(mesh), mesh.statistics.grid, crossing);
  if (!verification.valid) return "not valid: " + verification.reason;
  const std::uint64_t peak = mesh.statistics.peak_device_bytes;
  if (peak > required_bytes(points.size(), constraints.size())) return "more device memory than required_bytes says";
  if (peak == 0 && !mesh.triangles.empty()) return "no device memory was counted";
  return {};
}

}  // namespace gcdt::test

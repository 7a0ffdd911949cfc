// SPDX-License-Identifier: Apache-2.0
#include "query/quality.hpp"

#include <cmath>

namespace gcdt {

using runtime::over;
using runtime::Runtime;

device::Quality measure_quality(Runtime& runtime, const Vertices& vertices, const OrderedMesh& mesh) {
  if (mesh.triangles == 0) return device::gcdt_no_quality();
  auto rows = static_cast<cl_uint>(runtime.rows_of(mesh.triangles));
  auto table = runtime.allocate<device::Quality>("quality", rows);
  runtime.launch("quality", "measure_triangles", runtime::over_large(rows), cl_uint{mesh.triangles}, mesh.corners,
                 vertices.input_vertex, vertices.points, rows, table);
  // Ends: see fewer_rows.
  for (cl_uint folded_rows; (folded_rows = runtime.fewer_rows(rows)) < rows; rows = folded_rows) {
    auto folded = runtime.allocate<device::Quality>("folded quality", folded_rows);
    runtime.launch("quality", "fold_quality", over(folded_rows), rows, table, folded_rows, folded);
    table = std::move(folded);
  }
  std::vector<device::Quality> last(rows);
  runtime.read(table, last.data(), rows);
  device::Quality all = device::gcdt_no_quality();
  for (const device::Quality& row : last) all = device::gcdt_join_quality(all, row);
  return all;
}

double degrees(std::int64_t dot, std::uint64_t area) {
  constexpr double half_turn = 180, pi = 3.14159265358979323846;
  return std::atan2(static_cast<double>(area), static_cast<double>(dot)) * (half_turn / pi);
}

}  // namespace gcdt

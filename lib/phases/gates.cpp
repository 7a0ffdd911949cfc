// SPDX-License-Identifier: Apache-2.0
#include "phases/gates.hpp"

namespace gcdt {

Gates no_gates(runtime::Runtime& runtime) { return {runtime.allocate<cl_int4>("gates", 0)}; }

bool pays_for_gates(const Plan& plan, const Mesh& mesh, std::uint64_t crossings) {
  return crossings / mesh.faces() >= plan.crossings_gated;
}

void make_gates(runtime::Runtime& runtime, const Vertices& vertices, const Mesh& mesh, Gates& gates) {
  if (gates.made) return;
  gates.at = runtime.allocate<cl_int4>("gates", 2 * std::size_t{mesh.edges()});
  runtime.launch("gates", "gates_make", runtime::over(mesh.edges()), mesh.edges(), mesh.n, vertices.points,
                 mesh.face_data, mesh.edge_faces, gates.at);
  gates.made = true;
}

}  // namespace gcdt

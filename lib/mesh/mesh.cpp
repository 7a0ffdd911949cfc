// SPDX-License-Identifier: Apache-2.0
#include "mesh/mesh.hpp"

#include "mesh/phase.hpp"

namespace gcdt {

Mesh make_mesh(runtime::Runtime& runtime, std::uint32_t n, std::uint32_t roots) {
  Mesh mesh;
  mesh.n = n;
  mesh.roots = roots;
  mesh.face_data = runtime.allocate<cl_uint4>("faces", 2 * std::size_t{mesh.faces()});
  mesh.edge_faces = runtime.allocate<cl_uint>("edge faces", 2 * std::size_t(mesh.edges()));
  mesh.edge_marks = runtime.allocate<cl_uint>("edge marks", mesh.edges());
  return mesh;
}

void clear_claims(runtime::Runtime& runtime, Mesh& mesh, std::uint32_t faces) {
  runtime.launch("mesh", "mesh_clear_claims", runtime::over(faces), faces, mesh.face_data);
  mesh.claims_below = 1;
  ++mesh.claims_cleared;
}

WorkLists make_work_lists(runtime::Runtime& runtime, std::uint32_t n, std::uint32_t roots) {
  const std::size_t edges = device::gcdt_forest_edges(n, roots);
  return {runtime.allocate<cl_uint>("work list", edges), runtime.allocate<cl_uint>("second work list", edges)};
}

unsigned bit_width(std::uint64_t value) {
  unsigned bits = 0;
  while (value >> bits) ++bits;
  return bits;
}

Stamps::Stamps(const runtime::Runtime& runtime, std::uint32_t numbers)
    : bits_(std::max(1u, bit_width(numbers > 0 ? numbers - 1 : 0))),
      last_(std::min(bits_ >= 32 ? 0u : 0xFFFFFFFFu >> bits_, runtime.tuning().most_stamps)) {}

void PhaseCounters::zero() {
  host_ = {};
  runtime_.zero(buffer_);  // a write would wait for the queue
}

const device::Counters& PhaseCounters::read() {
  runtime_.read(buffer_, &host_, 1);
  return host_;
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/fans.hpp"

#include "constrain/fan.h"

namespace gcdt {

using runtime::over;

Fans no_fans(runtime::Runtime& runtime) {
  return {runtime.allocate<cl_uint>("fans", 0), runtime.allocate<cl_uint2>("faces of fans", 0)};
}

namespace {

// `face_arrays` are those of the program's FACES_PARAMETERS (kernels/constrain/fans.h).
template <class... FaceArrays>
Fans make(runtime::Runtime& runtime, Primitives& primitives, const char* program, cl_uint n, cl_uint faces,
          PhaseCounters& counters, const FaceArrays&... face_arrays) {
  Fans fans;
  fans.made = true;
  fans.begins = runtime.filled<cl_uint>("fans", std::size_t{n} + 1, 0);
  runtime.launch(program, "fans_degrees", over(faces), faces, n, face_arrays..., fans.begins);
  runtime.launch(program, "fans_choose", over(n), n, fans.begins);
  const cl_uint count = primitives.scan_total(fans.begins, n);
  fans.faces = runtime.filled<cl_uint2>("faces of fans", count, {{GCDT_NONE, GCDT_NONE}});
  if (count == 0) return fans;
  auto offsets = runtime.allocate<cl_uint>("elements of faces", std::size_t{faces} + 1);
  runtime.launch(program, "fans_count", over(faces), faces, n, face_arrays..., fans.begins, offsets);
  primitives.exclusive_scan(offsets, offsets, faces);
  auto corners = runtime.allocate<cl_uint>("corners of elements", count);
  auto links = runtime.allocate<cl_uint2>("links", count);
  runtime.launch(program, "fans_link", over(faces), faces, n, face_arrays..., fans.begins, offsets, corners, links,
                 fans.faces, counters.buffer());
  runtime.launch(program, "fans_cut", over(count), count, face_arrays..., fans.begins, corners, fans.faces, links);
  // The first elements are not needed any more: links and faces take turns. Ends: `reach` grows. No fan is longer than
  // all of them.
  for (std::uint64_t reach = 1; reach < count; reach *= GCDT_FAN_REACH) {
    runtime.launch(program, "fans_reach", over(count), count, links, fans.faces);
    std::swap(links, fans.faces);
  }
  runtime.launch(program, "fans_place", over(count), count, face_arrays..., fans.begins, corners, links, fans.faces,
                 counters.buffer());
  return fans;
}

}  // namespace

Fans make_fans(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices, const Mesh& mesh,
               PhaseCounters& counters) {
  return make(runtime, primitives, "fans", vertices.n(), mesh.faces(), counters, mesh.face_data, mesh.edge_faces);
}

Fans make_result_fans(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices,
                      const OrderedMesh& mesh, bool by_input, PhaseCounters& counters) {
  return make(runtime, primitives, "result_fans", vertices.n(), mesh.triangles, counters, mesh.corners, mesh.neighbours,
              cl_uint{by_input}, vertices.input_vertex);
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/fans.hpp"

namespace gcdt {

using runtime::over;

Fans no_fans(runtime::Runtime& runtime) {
  return {runtime.allocate<cl_uint>("fans", 0), runtime.allocate<cl_uint2>("faces of fans", 0)};
}

Fans make_fans(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices, const Mesh& mesh,
               PhaseCounters& counters) {
  const cl_uint n = vertices.n(), faces = mesh.faces();
  Fans fans;
  fans.made = true;
  fans.begins = runtime.filled<cl_uint>("fans", std::size_t{n} + 1, 0);
  runtime.launch("fans", "fans_degrees", over(faces), faces, n, mesh.face_data, fans.begins);
  runtime.launch("fans", "fans_choose", over(n), n, fans.begins);
  const cl_uint count = primitives.scan_total(fans.begins, n);
  fans.faces = runtime.filled<cl_uint2>("faces of fans", count, {{GCDT_NONE, GCDT_NONE}});
  if (count == 0) return fans;
  auto offsets = runtime.allocate<cl_uint>("elements of faces", std::size_t{faces} + 1);
  runtime.launch("fans", "fans_count", over(faces), faces, n, mesh.face_data, fans.begins, offsets);
  primitives.exclusive_scan(offsets, offsets, faces);
  auto corners = runtime.allocate<cl_uint>("corners of elements", count);
  auto links = runtime.allocate<cl_uint2>("links", count);
  runtime.launch("fans", "fans_link", over(faces), faces, n, mesh.face_data, mesh.edge_faces, fans.begins, offsets,
                 corners, links, fans.faces, counters.buffer());
  runtime.launch("fans", "fans_cut", over(count), count, mesh.face_data, fans.begins, corners, fans.faces, links);
  // The first elements are not needed any more: links and faces take turns. Ends: no fan is longer than all of them.
  for (std::uint64_t reach = 1; reach < count; reach *= 2) {
    runtime.launch("fans", "fans_double", over(count), count, links, fans.faces);
    std::swap(links, fans.faces);
  }
  runtime.launch("fans", "fans_place", over(count), count, mesh.face_data, fans.begins, corners, links, fans.faces,
                 counters.buffer());
  return fans;
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/walk.hpp"

namespace gcdt {

namespace {
// Crossed faces are about (total weight >> shift) * factor. `walked` is not read unless `again`.
PieceParts make_parts(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                      const runtime::Buffer<cl_uint>& weights, cl_uint pieces, cl_uint shift, cl_uint factor,
                      cl_uint again, const runtime::Buffer<cl_uint2>& walked) {
  const cl_uint least = plan.least_parts, most = plan.most_parts;
  PieceParts parts;
  parts.capacity = pieces + (again ? 2 * most : most);
  parts.begins = runtime.allocate<cl_uint>("parts of pieces", std::size_t(pieces) + 1);
  runtime::Buffer<cl_uint> total = runtime.filled<cl_uint>("weight of pieces", 2, 0);
  runtime.launch("parts", "parts_total", runtime::over(pieces), pieces, weights, total);
  runtime.launch("parts", "parts_count", runtime::over(pieces), pieces, least, most, shift, factor,
                 cl_uint{plan.crossings_per_part}, weights, total, again, walked, parts.begins);
  primitives.exclusive_scan(parts.begins, parts.begins, pieces);
  return parts;
}

// Without what was walked before, buffers that are not read take its place.
void launch_first_faces(runtime::Runtime& runtime, const WalkedMesh& walked, const runtime::Buffer<cl_uint2>& ends,
                        cl_uint pieces, const PieceParts& parts, const WalkedPieces* before, cl_uint hasty,
                        cl_uint missing, const PartBegins& begins, PhaseCounters& counters) {
  const Mesh& mesh = walked.mesh;
  const History& history = walked.history;
  runtime.launch("first", "first_faces", runtime::over(parts.capacity), hasty, cl_uint{before != nullptr}, missing,
                 pieces, parts.capacity, walked.vertices.levels_buffer, history.level, mesh.n, walked.vertices.points,
                 mesh.face_data, mesh.edge_faces, history.begin, history.end, history.top, history.vertex_face,
                 history.nodes, history.shape, cl_uint{history.fans.made}, history.fans.begins, history.fans.faces,
                 ends, parts.begins, before ? before->parts : ends, before ? before->faces : parts.begins, begins.lines,
                 begins.pieces, begins.faces, counters.buffer());
}

}  // namespace

PieceParts parts_by_length(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                           const Vertices& vertices, const runtime::Buffer<cl_uint2>& ends, cl_uint pieces) {
  cl_uint root = 1;
  while (std::uint64_t(root) * root < device::gcdt_face_count(vertices.n())) ++root;
  auto lengths = runtime.allocate<cl_uint>("lengths of pieces", pieces);
  runtime.launch("parts", "parts_lengths", runtime::over(pieces), pieces, vertices.points, ends, lengths);
  return make_parts(runtime, primitives, plan, lengths, pieces, 31, root, 0, ends);
}

PieceParts parts_by_crossings(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                              const Pieces& pieces) {
  return make_parts(runtime, primitives, plan, pieces.walked.weights, pieces.count, 0, 1, 1, pieces.walked.parts);
}

PartBegins find_first_faces(runtime::Runtime& runtime, const WalkedMesh& walked, const runtime::Buffer<cl_uint2>& ends,
                            cl_uint pieces, const PieceParts& parts, const WalkedPieces* before, bool hasty,
                            PhaseCounters& counters) {
  PartBegins begins;
  begins.lines = runtime.allocate<cl_int4>("lines of pieces", pieces);
  begins.pieces = runtime.allocate<cl_uint>("pieces of parts", parts.capacity);
  begins.faces = runtime.allocate<cl_uint>("first faces of parts", parts.capacity);
  launch_first_faces(runtime, walked, ends, pieces, parts, before, cl_uint{hasty}, 0, begins, counters);
  return begins;
}

void find_missing_faces(runtime::Runtime& runtime, const WalkedMesh& walked, const runtime::Buffer<cl_uint2>& ends,
                        cl_uint pieces, const PieceParts& parts, PartBegins& begins, PhaseCounters& counters) {
  launch_first_faces(runtime, walked, ends, pieces, parts, nullptr, 0, 1, begins, counters);
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/walk.hpp"

namespace gcdt {

namespace {
// `whole`: of all weights, or more. `before`, if any, says what parts pieces have that were walked before.
PieceParts make_parts(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                      const runtime::Buffer<cl_uint>& weights, cl_uint pieces, std::uint64_t whole,
                      std::uint64_t crossings, const WalkedPieces* before) {
  const cl_uint had = before ? before->pool : 0, pool = part_pool(plan, crossings, had);
  PieceParts parts;
  parts.pool = long_part_pool(plan, pool);
  parts.capacity = pieces + parts.pool + had;
  parts.begins = runtime.allocate<cl_uint>("parts of pieces", std::size_t(pieces) + 1);
  const auto none = runtime.allocate<cl_uint2>("no parts", 0);
  runtime.launch("parts", "parts_count", runtime::over(pieces), pieces, cl_ulong{whole}, pool, parts.pool, weights,
                 cl_uint{before != nullptr}, before ? before->parts : none, parts.begins);
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

std::uint64_t total_weight(runtime::Runtime& runtime, const runtime::Buffer<cl_uint>& weights, cl_uint pieces) {
  const auto total = runtime.filled<cl_uint>("weight of pieces", 2, 0);
  runtime.launch("parts", "parts_total", runtime::over(pieces), pieces, weights, total);
  cl_uint words[2];
  runtime.read(total, words, 2);
  return wide(words[0], words[1]);
}

// Below 2^31 lengths of below 2^31, times the square root of at most 2^32 faces, by 2^31. (Each step of the loop comes
// nearer: it ends.)
std::uint64_t expected_crossings(const Vertices& vertices, std::uint64_t length) {
  std::uint64_t root = 1;
  while (root * root < device::gcdt_face_count(vertices.n())) ++root;
  return (length >> 31) * root;
}

PieceParts parts_by_length(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                           const runtime::Buffer<cl_uint>& lengths, cl_uint pieces, std::uint64_t length,
                           std::uint64_t crossings) {
  return make_parts(runtime, primitives, plan, lengths, pieces, length, crossings, nullptr);
}

PieceParts parts_by_length(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                           const Vertices& vertices, const runtime::Buffer<cl_uint2>& ends, cl_uint pieces) {
  auto lengths = runtime.allocate<cl_uint>("lengths of pieces", pieces);
  runtime.launch("parts", "parts_lengths", runtime::over(pieces), pieces, vertices.points, ends, lengths);
  const std::uint64_t length = total_weight(runtime, lengths, pieces);
  return parts_by_length(runtime, primitives, plan, lengths, pieces, length, expected_crossings(vertices, length));
}

PieceParts parts_by_crossings(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                              const Pieces& pieces) {
  const WalkedPieces& walked = pieces.walked;
  return make_parts(runtime, primitives, plan, walked.weights, pieces.count, walked.crossed, walked.crossed, &walked);
}

PartBegins find_first_faces(runtime::Runtime& runtime, const WalkedMesh& walked, const runtime::Buffer<cl_uint2>& ends,
                            cl_uint pieces, const PieceParts& parts, const WalkedPieces* before, bool hasty,
                            PhaseCounters& counters) {
  PartBegins begins;
  begins.lines = runtime.allocate<cl_int4>("lines of pieces", pieces);
  begins.pieces = runtime.filled<cl_uint>("pieces of parts", parts.capacity, GCDT_NONE);
  begins.faces = runtime.allocate<cl_uint>("first faces of parts", parts.capacity);
  runtime.launch("parts", "parts_list", runtime::over(pieces), pieces, parts.capacity, parts.begins, begins.pieces);
  launch_first_faces(runtime, walked, ends, pieces, parts, before, cl_uint{hasty}, 0, begins, counters);
  return begins;
}

// The 128 classes are so wide that they reach to nearly four times the mean of what there is room for.
runtime::Buffer<cl_uint> order_parts(runtime::Runtime& runtime, const Plan& plan, const Pieces& pieces,
                                     const PieceParts& parts, const PartBegins& begins) {
  constexpr cl_uint span = Tuning::parts_ordered_together;
  const WalkedPieces& walked = pieces.walked;
  const std::uint64_t each = walked.crossed / std::max(1u, parts.capacity);
  const bool ordered = each >= plan.crossings_ordered;
  auto order = runtime.allocate<cl_uint>("order of parts", ordered ? parts.capacity : 0);
  if (!ordered) return order;
  runtime.launch("order_parts", "order_parts", runtime.over_groups((parts.capacity - 1) / span + 1), pieces.count,
                 parts.capacity, span, static_cast<cl_uint>(each / 32 + 1), parts.begins, begins.pieces, walked.weights,
                 walked.parts, walked.passed, order);
  return order;
}

void find_missing_faces(runtime::Runtime& runtime, const WalkedMesh& walked, const runtime::Buffer<cl_uint2>& ends,
                        cl_uint pieces, const PieceParts& parts, PartBegins& begins, PhaseCounters& counters) {
  launch_first_faces(runtime, walked, ends, pieces, parts, nullptr, 0, 1, begins, counters);
}

}  // namespace gcdt

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

}  // namespace gcdt

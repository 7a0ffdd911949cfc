// SPDX-License-Identifier: Apache-2.0
// The end of a refinement: what it did, the mesh with its vertices numbered anew, and its subsegments as pieces.
#include <algorithm>
#include <cmath>

#include "phases/refine.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;

void Refiner::explain() {
  const cl_uint faces = mesh_.faces(count());
  runtime_.launch("judge", "refine_explain", over(faces), faces, mesh_.n, vertices_.points, mesh_.face_data,
                  mesh_.edge_faces, rules_buffer_, mesh_.edge_marks, origins_begin_, origins_, pieces_, sizes_, areas_,
                  capacity(), asked_, keys_, numbers_, candidates_, report_, edge_pieces_, sharp_, urgency_);
  const device::RefineReport report = read_report();
  if (report.failed) throw Error(Status::round_limit, "refine: a walk or a tour did not end");
  result_.added = added_;
  result_.on_subsegments = report.on_subsegments;
  result_.bent = report.bent;
  result_.far = report.far;
  result_.encroached = report.encroached;
  std::copy(std::begin(report.left), std::end(report.left), result_.left);
  // What is on its subsegment may be on one whose ends are not on the piece; but then one of these is bent.
  if (report.bent > 0 || origins_begin_ == 0) result_.move = farthest();
}

double Refiner::farthest() {
  const auto count = runtime_.filled<cl_uint>("vertices beside their pieces", 1, 0);
  const cl_uint origins = this->count() - origins_begin_;
  const auto moves =
      runtime_.allocate<cl_ulong2>("distances to pieces", result_.on_subsegments + (inputs_ - origins_begin_));
  runtime_.launch("renew", "refine_moves", over(origins), origins, origins_begin_, vertices_.points, origins_, pieces_,
                  count, moves);
  std::vector<cl_ulong2> all(runtime_.read_one(count));
  runtime_.read(moves, all.data(), all.size());
  double most = 0;
  for (const cl_ulong2& m : all) most = std::max(most, double(m.s[0]) / std::sqrt(double(m.s[1])));
  return most;
}

RefinedMesh Refiner::finish() {
  lists_ = {};
  for (auto* list : {&bad_, &bad_before_, &aiming_, &cavities_, &asked_, &numbers_, &ranks_, &won_}) *list = {};
  ways_ = {};
  keys_ = {};
  candidates_ = {};
  const auto given = static_cast<cl_uint>(vertices_.input_vertex.size());
  RefinedMesh refined;
  refined.added = added_;
  auto keys = runtime_.allocate<cl_ulong>("keys of added vertices", added_);
  auto numbers = runtime_.allocate<cl_uint>("added vertices", added_),
       places = runtime_.allocate<cl_uint>("places", added_);
  if (added_ > 0)
    runtime_.launch("renew", "refine_keys", over(added_), added_, inputs_, vertices_.points, keys, numbers);
  primitives_.sort(keys, numbers, added_, 62);
  keys = {};
  InputPoints joined;
  joined.n = given + added_;
  joined.type = coordinates_type(Points::Type::int32);
  joined.coordinates = runtime_.allocate<cl_ulong>("joined vertices", joined.n);
  refined.added_points = runtime_.allocate<cl_int2>("added vertices", added_);
  runtime_.launch("renew", "refine_join", over(joined.n), given, added_, inputs_, vertices_.points,
                  vertices_.input_vertex, numbers, joined.coordinates, refined.added_points, places);
  auto input_numbers = runtime_.allocate<cl_uint>("input numbers of vertices", count());
  runtime_.launch("renew", "refine_numbers", over(count()), count(), inputs_, given, vertices_.vertex_input, places,
                  input_numbers);
  const Plan plan = make_plan(runtime_, {1, joined.n, joined.n});
  refined.vertices = order(runtime_, primitives_, plan, std::move(joined), FixedGrid{}).vertices;
  refined.vertices.grid = vertices_.grid;
  refined.vertices.decimals = vertices_.decimals;
  refined.added_origins = runtime_.allocate<cl_uint4>("origins of added vertices", added_);
  if (added_ > 0)
    runtime_.launch("renew", "refine_origins", over(added_), added_, inputs_ - origins_begin_, origins_, places,
                    input_numbers, refined.added_origins);
  const cl_uint faces = mesh_.faces(count()), n = count();
  runtime_.launch("renew", "refine_rename", over(faces), faces, mesh_.n, n, input_numbers,
                  refined.vertices.input_vertex, mesh_.face_data);
  mesh_.n = n;
  refined.mesh = std::move(mesh_);
  refined.edge_pieces = std::move(edge_pieces_);
  refined.piece_count = subsegments_;
  refined.piece_ends = runtime_.allocate<cl_uint2>("pieces as they were", subsegments_);
  runtime_.launch("renew", "refine_rename_ends", over(subsegments_), subsegments_, input_numbers,
                  refined.vertices.input_vertex, pieces_, refined.piece_ends);
  refined.sharp = std::move(sharp_);
  refined.reasons = std::move(urgency_);
  return refined;
}

RefinedPieces refined_pieces(runtime::Runtime& runtime, Primitives& primitives, const RefinedMesh& refined,
                             const Pieces& pieces, bool hull) {
  const Mesh& mesh = refined.mesh;
  const cl_uint edges = mesh.edges(), bits = std::max(1u, bit_width(mesh.n));
  auto before = runtime.allocate<cl_uint>("subsegments before", std::size_t{edges} + 1);
  runtime.launch("renew", "refine_select", over(edges), edges, hull ? GCDT_NONE : cl_uint{pieces.count},
                 refined.edge_pieces, mesh.edge_marks, before);
  RefinedPieces all;
  Pieces& made = all.pieces;
  made.count = primitives.scan_total(before, edges);
  auto list = runtime.allocate<cl_uint>("subsegments", made.count);
  primitives.compact_indices(before, list, edges);
  auto keys = runtime.allocate<cl_ulong>("keys of subsegments", made.count);
  made.ends = runtime.allocate<cl_uint2>("pieces", made.count);
  made.source_offsets = runtime.allocate<cl_uint>("source offsets", std::size_t{made.count} + 1);
  all.before = runtime.allocate<cl_uint>("pieces of subsegments", made.count);
  if (made.count == 0) {
    made.sources = runtime.allocate<cl_uint>("sources of pieces", 0);
    return all;
  }
  runtime.launch("renew", "refine_piece_keys", over(made.count), made.count, bits, refined.vertices.levels_buffer,
                 mesh.face_data, mesh.edge_faces, list, keys);
  primitives.sort(keys, list, made.count, 2 * bits);
  runtime.launch("renew", "refine_pieces", over(made.count), made.count, bits, cl_uint{pieces.count},
                 refined.vertices.levels_buffer, keys, list, refined.edge_pieces, pieces.source_offsets, made.ends,
                 all.before, made.source_offsets);
  made.source_count = primitives.scan_total(made.source_offsets, made.count);
  made.sources = runtime.allocate<cl_uint>("sources of pieces", made.source_count);
  if (made.source_count > 0)
    runtime.launch("renew", "refine_sources", over(made.count), made.count, list, refined.edge_pieces,
                   pieces.source_offsets, pieces.sources, made.source_offsets, made.sources);
  return all;
}

}  // namespace gcdt

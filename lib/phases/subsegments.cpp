// SPDX-License-Identifier: Apache-2.0
#include "phases/subsegments.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

namespace {

/// What kernels that find subsegments count: edges that are pieces of their own, constrained ones that are no piece.
class Counts {
 public:
  explicit Counts(Runtime& runtime)
      : runtime_(runtime), buffer_(runtime.filled<cl_uint>("counts of subsegments", 2, 0)) {}

  const Buffer<cl_uint>& buffer() const { return buffer_; }
  std::uint32_t own() {
    cl_uint counts[2];
    runtime_.read(buffer_, counts, 2);
    if (counts[1] != 0) throw Error(Status::check_failed, "refine: a constrained edge is no piece");
    return counts[0];
  }

 private:
  Runtime& runtime_;
  Buffer<cl_uint> buffer_;
};

// An edge of its own is on the hull, of which there are at most as many as vertices, or, of an adopted mesh, any.
Subsegments find(Runtime& runtime, const Vertices& vertices, Mesh& mesh, const Pieces& pieces, bool adopted) {
  Subsegments found;
  found.pieces = runtime.allocate<cl_uint2>("pieces and hull",
                                            std::size_t{pieces.count} + (adopted ? mesh.edges() : vertices.n()));
  if (pieces.count > 0) runtime.copy(pieces.ends, found.pieces, pieces.count);
  found.edge_pieces = runtime.allocate<cl_uint>("pieces of edges", mesh.edges());
  Counts counts(runtime);
  runtime.launch("renew", "refine_subsegments", over(mesh.edges()), mesh.edges(), cl_uint{pieces.count},
                 cl_uint{adopted}, vertices.levels_buffer, mesh.n, vertices.points, mesh.face_data, mesh.edge_faces,
                 mesh.edge_marks, found.pieces, found.edge_pieces, counts.buffer());
  found.count = pieces.count + counts.own();
  return found;
}

}  // namespace

Subsegments find_subsegments(Runtime& runtime, const Vertices& vertices, Mesh& mesh, const Pieces& pieces) {
  return find(runtime, vertices, mesh, pieces, false);
}

Subsegments find_adopted_subsegments(Runtime& runtime, const Vertices& vertices, Mesh& mesh, const Pieces& pieces,
                                     const Buffer<cl_uint>& refs, const Buffer<cl_int>& kept) {
  const auto triangles = static_cast<cl_uint>(refs.size());
  runtime.launch("renew", "refine_label", over(triangles), triangles, cl_uint{0}, refs, kept, mesh.face_data);
  return find(runtime, vertices, mesh, pieces, true);
}

Subsegments find_subsegments(Runtime& runtime, const Vertices& vertices, Mesh& mesh, const Chains& chains) {
  Subsegments found;
  found.count = chains.count;
  found.pieces = runtime.allocate<cl_uint2>("pieces and hull", chains.count);
  found.sharp = runtime.allocate<cl_uint>("sharp ends of pieces", chains.count);
  found.edge_pieces = runtime.allocate<cl_uint>("pieces of edges", mesh.edges());
  runtime.copy(chains.pieces.ends, found.pieces, chains.count);
  runtime.copy(chains.sharp, found.sharp, chains.count);
  const auto links = static_cast<cl_uint>(chains.links.size());
  Counts counts(runtime);
  runtime.launch("renew", "refine_links", over(mesh.edges()), mesh.edges(), links, vertices.levels_buffer, mesh.n,
                 vertices.points, mesh.face_data, mesh.edge_faces, mesh.edge_marks, chains.links, chains.link_pieces,
                 found.edge_pieces, counts.buffer());
  found.origins =
      runtime.filled<cl_uint4>("origins of vertices", vertices.n(), {{GCDT_NONE, GCDT_NONE, GCDT_NONE, GCDT_NONE}});
  runtime.launch("renew", "refine_standing", over(links), links, vertices.points, chains.links, chains.link_pieces,
                 found.pieces, found.origins);
  counts.own();
  return found;
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/constrain.hpp"

#include <vector>

#include "constrain/chunks.h"

namespace gcdt {

using runtime::over;

namespace {

class Constraining {
 public:
  Constraining(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan, const Vertices& vertices,
               Mesh& mesh, History& history, const Pieces& pieces, PhaseCounters& counters)
      : runtime_(runtime),
        primitives_(primitives),
        walked_{plan, vertices, mesh, history},
        mesh_(mesh),
        history_(history),
        pieces_(pieces),
        counters_(counters) {}

  // The paper's figure: find all intersected triangles, prune by visibility, retriangulate, fill.
  ConstrainResult run() {
    find_near();
    list_crossed();
    if (failed()) return finish(false);
    group_crossed();
    own_vertices();
    if (failed() || !counts_agree()) return finish(false);
    find_holes();
    write_chains();
    give_slots();
    keep_boundary();
    retriangulate();
    stitch();
    counters_.read();
    return finish(true);
  }

 private:
  bool failed() { return counters_.read().failed != 0; }
  cl_uint ordered() const { return order_.size() > 0; }

  // With the counters read last. A mesh that has not changed is located in by whoever looks for what crosses.
  ConstrainResult finish(bool changed) {
    const device::Counters& c = counters_.last();
    ConstrainResult result;
    result.failed = c.failed | (counts_agree() ? 0u : GCDT_FAILED_COUNT);
    result.mesh_changed = changed;
    result.existing_edges = c.existing_edges;
    result.walked = pieces_.count - c.existing_edges;
    result.chain_vertices = c.owned_left + c.owned_right;
    result.holes = c.hexagons;
    result.symbolic_chain_vertices = c.symbolic_chain_vertices;
    std::copy(std::begin(c.pairs_of_two), std::end(c.pairs_of_two), result.pairs_of_two.begin());
    result.crossed_pairs = wide(c.pairs_low, c.pairs_high);
    result.steps = wide(c.steps_low, c.steps_high);
    if (!changed) give_history_back();
    return result;
  }

  void find_near() {
    take_claims();
    parts_ = parts_by_crossings(runtime_, primitives_, walked_.plan, pieces_);
    begins_ =
        find_first_faces(runtime_, walked_, pieces_.ends, pieces_.count, parts_, &pieces_.walked, false, counters_);
    order_ = order_parts(runtime_, walked_.plan, pieces_, parts_, begins_);
    take_gates();
    near_ = runtime_.filled<cl_uint>("nearest pieces", 2 * std::size_t{mesh_.edges()}, GCDT_NONE);
    piece_edge_ = runtime_.allocate<cl_uint>("edges of pieces", pieces_.count);
    runtime_.launch("constrain", "constrain_near", over(parts_.capacity), pieces_.count, parts_.capacity, mesh_.n,
                    walked_.vertices.points, mesh_.face_data, mesh_.edge_faces, cl_uint{gates_.made}, gates_.at,
                    mesh_.edge_marks, near_, pieces_.ends, parts_.begins, begins_.lines, begins_.pieces, begins_.faces,
                    ordered(), order_, piece_edge_, counters_.buffer());
  }

  void give_history_back() {
    if (!gates_.made) return;
    gates_ = {};
    history_ = freeze_all(runtime_, walked_.vertices, mesh_, counters_);
  }

  // They take the room of the history, which nobody needs unless this fails. (Cleaning goes by lengths, which may tell
  // too much.)
  void take_gates() {
    history_.fans = no_fans(runtime_);
    gates_ = std::move(history_.gates);
    history_.gates = no_gates(runtime_);
    if (pays_for_gates(walked_.plan, mesh_, pieces_.walked.crossed)) {
      make_gates(runtime_, walked_.vertices, mesh_, gates_);
      history_ = {};
    } else {
      gates_ = no_gates(runtime_);
    }
  }

  // One for each hexagon. Above 0: a gate says nothing else of faces that are none.
  void take_claims() {
    const std::uint64_t wanted = mesh_.faces();
    if (mesh_.claims_below + wanted > UINT32_MAX) clear_claims(runtime_, mesh_, mesh_.faces());
    claim_ = static_cast<cl_uint>(std::max<std::uint64_t>(mesh_.claims_below, 1));
    mesh_.claims_below = claim_ + wanted;
  }

  // Whether later flips look for triangles where they are, and pieces do not cross so much that they all wait for the
  // counts of a few.
  bool wants_groups() const {
    const WalkedPieces& walked = pieces_.walked;
    return mesh_.edges() >= walked_.plan.least_grouped &&
           walked.crossed <= std::uint64_t{walked_.plan.grouped_crossings} * pieces_.count;
  }

  // Crossed faces and edges, as they come, and how many are each piece's.
  void list_crossed() {
    grouped_ = wants_groups();
    const std::size_t counts = grouped_ ? std::size_t{pieces_.count} + 1 : 0;
    crossed_ = runtime_.allocate<cl_uint>("crossed faces", mesh_.faces());
    crossed_edges_ = runtime_.allocate<cl_uint>("crossed edges", mesh_.edges());
    face_ends_ = runtime_.filled<cl_uint>("slots of faces", counts, 0);
    edge_ends_ = runtime_.filled<cl_uint>("slots of edges", counts, 0);
    runtime_.launch("constrain", "constrain_crossed_faces", over(mesh_.faces()), grouped_, mesh_.faces(), claim_,
                    mesh_.face_data, near_, pieces_.ends, crossed_, face_ends_, counters_.buffer());
    runtime_.launch("constrain", "constrain_crossed_edges", over(mesh_.edges()), grouped_, mesh_.edges(),
                    mesh_.edge_marks, near_, crossed_edges_, edge_ends_, counters_.buffer());
  }

  // Crossed faces and edges piece by piece, hexagons behind all others.
  void group_crossed() {
    crossed_faces_ = counters_.last().crossed_faces;
    crossed_edge_count_ = counters_.last().crossed_edges;
    hexagons_ = counters_.last().hexagons;
    hexagon_face_ = runtime_.allocate<cl_uint>("faces of hexagons", hexagons_);
    if (hexagons_ > 0)
      runtime_.launch("constrain", "constrain_list_hexagons", over(crossed_faces_), crossed_faces_, claim_, crossed_,
                      mesh_.face_data, hexagon_face_, cl_uint{gates_.made}, gates_.at);
    if (!grouped_) return;
    primitives_.exclusive_scan(face_ends_, face_ends_, pieces_.count);
    primitives_.exclusive_scan(edge_ends_, edge_ends_, pieces_.count);
    auto faces = runtime_.allocate<cl_uint>("crossed faces by piece", crossed_faces_);
    auto edges = runtime_.allocate<cl_uint>("crossed edges by piece", crossed_edge_count_);
    runtime_.launch("slots", "slots_of_faces", over(crossed_faces_), crossed_faces_, hexagons_, claim_, mesh_.face_data,
                    near_, crossed_, face_ends_, faces);
    runtime_.launch("slots", "slots_of_edges", over(crossed_edge_count_), crossed_edge_count_, near_, crossed_edges_,
                    edge_ends_, edges);
    crossed_ = std::move(faces);
    crossed_edges_ = std::move(edges);
    face_ends_ = {};
  }

  // Beside the parts' own chunks: one for each time that another is full.
  void own_vertices() {
    chunk_capacity_ = crossed_faces_ / GCDT_CHUNK_LENGTH + parts_.capacity;
    chunk_heads_ = runtime_.allocate<cl_uint4>("chunk heads", chunk_capacity_);
    chunk_entries_ =
        runtime_.allocate<cl_uint>("chunks of owned vertices", GCDT_CHUNK_LENGTH * std::size_t{chunk_capacity_});
    starts_ = runtime_.allocate<cl_uint>("chain starts", 2 * std::size_t{parts_.capacity} + 1);
    far_ = runtime_.filled<cl_uint>("farthest cuts", 3 * std::size_t(hexagons_), GCDT_NONE);
    last_sides_ = runtime_.allocate<cl_uint2>("last sides of pieces", pieces_.count);
    runtime_.launch("constrain", "constrain_own", over(parts_.capacity), pieces_.count, parts_.capacity,
                    chunk_capacity_, mesh_.n, walked_.vertices.points, mesh_.face_data, mesh_.edge_faces,
                    cl_uint{gates_.made}, gates_.at, near_, pieces_.ends, parts_.begins, piece_edge_, begins_.lines,
                    begins_.pieces, begins_.faces, ordered(), order_, starts_, far_, chunk_heads_, chunk_entries_,
                    last_sides_, claim_, counters_.buffer());
    primitives_.exclusive_scan(starts_, starts_, 2 * std::size_t{parts_.capacity});
  }

  // As many triangles are made as were crossed, if no two pieces cross.
  bool counts_agree() const {
    const device::Counters& c = counters_.last();
    return std::uint64_t(c.owned_left) + c.owned_right + c.hexagons == c.crossed_faces;
  }

  // The mesh will change, so nobody needs the history any more.
  void find_holes() {
    history_ = {};
    left_total_ = counters_.last().owned_left, right_total_ = counters_.last().owned_right;
    right_begin_ = left_total_ + 2 * pieces_.count;
    hole_place_ = runtime_.allocate<cl_uint>("hole corners", 3 * std::size_t(hexagons_));
    if (hexagons_ > 0)
      runtime_.launch("holes", "hole_corners", over(3 * std::size_t{hexagons_}), hexagons_, pieces_.count,
                      parts_.capacity, mesh_.n, walked_.vertices.points, mesh_.face_data, mesh_.edge_faces,
                      cl_uint{gates_.made}, gates_.at, near_, pieces_.ends, parts_.begins, begins_.lines, begins_.faces,
                      starts_, far_, hexagon_face_, hole_place_, counters_.buffer());
    gates_ = {};
    order_ = {};
  }

  void write_chains() {
    length_ = right_begin_ + right_total_ + 2 * pieces_.count;
    chain_vertex_ = runtime_.allocate<cl_uint>("chain vertices", length_);
    chain_distances_ = runtime_.allocate<cl_ulong>("chain distances", length_);
    chain_piece_ = runtime_.allocate<cl_uint>("chain pieces", length_);
    chain_side_ = runtime_.allocate<cl_uint>("sides along chains", length_);
    const cl_uint taken = counters_.last().chunks;
    runtime_.launch("constrain", "constrain_chain", over(GCDT_CHUNK_LENGTH * (std::size_t{parts_.capacity} + taken)),
                    pieces_.count, taken, parts_.capacity, mesh_.n, walked_.vertices.points, mesh_.face_data,
                    mesh_.edge_faces, near_, pieces_.ends, parts_.begins, piece_edge_, begins_.lines, begins_.pieces,
                    last_sides_, starts_, chunk_heads_, chunk_entries_, chain_vertex_, chain_distances_, chain_piece_,
                    chain_side_, counters_.buffer());
    chunk_heads_ = {};
    chunk_entries_ = {};
    make_minima();
  }

  void make_minima() {
    layers_buffer_ = runtime_.allocate<device::MinimaLayers>("minima layers", 1);
    const auto above = [](cl_uint length) { return (length - 1) / GCDT_MINIMA_RADIX + 1; };
    cl_uint total = 0;
    for (cl_uint length = length_; length > GCDT_MINIMA_RADIX; length = above(length)) total += above(length);
    minima_ = runtime_.allocate<cl_ulong>("minima", total);
    cl_uint below = 0, begin = 0, made = 1;  // where the layers begin: the lowest one is the chains
    for (cl_uint length = length_; above(length) > Tuning::minima_of_group; length = above(length)) {
      const cl_uint lowest = length == length_;
      runtime_.launch("retriangulate", "retriangulate_minima", over(above(length)), above(length), length, below, begin,
                      lowest, chain_distances_, minima_);
      below = begin;
      begin += above(length);
      ++made;
    }
    runtime_.launch("retriangulate", "retriangulate_top", runtime::one_group(), length_, made, chain_distances_,
                    minima_, layers_buffer_);
  }

  // Which slots pieces have, and which are spare: all edges, if pieces have none.
  void give_slots() {
    records_ = runtime_.allocate<cl_uint4>("slots of pieces", grouped_ ? pieces_.count : 0);
    if (!grouped_) {
      std::swap(spare_, crossed_edges_);
      crossed_edges_ = runtime_.allocate<cl_uint>("crossed edges by piece", 0);
      return;
    }
    spare_ = runtime_.allocate<cl_uint>("spare slots of edges", crossed_edge_count_);
    runtime_.launch("slots", "slots_of_pieces", over(pieces_.count), pieces_.count, parts_.capacity, parts_.begins,
                    starts_, edge_ends_, records_);
    runtime_.launch("slots", "slots_spare", over(crossed_edge_count_), crossed_edge_count_, near_, records_,
                    crossed_edges_, spare_, counters_.buffer());
    edge_ends_ = {};
  }

  // Entries: the sides that stay, 3 per crossed face less two for each crossed edge, and one for each new edge, which
  // are as many as the crossed ones, but for those that retriangulate_chains makes: one for each owned vertex, less the
  // two roots at most of each piece that was walked. Half more slots keep probes short.
  void keep_boundary() {
    const std::uint64_t owned = left_total_ + right_total_,
                        roots = 2ull * (pieces_.count - counters_.last().existing_edges),
                        entries = 3ull * crossed_faces_ - crossed_edge_count_ - (owned > roots ? owned - roots : 0);
    capacity_ = cl_uint(entries + entries / 2 + 1);
    table_ = runtime_.filled<cl_uint>("table of directions", 3 * std::size_t{capacity_}, GCDT_NONE);
    runtime_.launch("stitch", "stitch_keep", over(crossed_faces_), crossed_faces_, crossed_, mesh_.face_data, near_,
                    capacity_, table_, counters_.buffer());
    near_ = {};
  }

  void retriangulate() {
    roots_ = runtime_.filled<cl_uint2>("roots of chains", pieces_.count, {{GCDT_NONE, GCDT_NONE}});
    runtime_.launch("retriangulate", "retriangulate_chains", over(length_), grouped_, length_, right_begin_,
                    pieces_.count, layers_buffer_, chain_vertex_, chain_distances_, chain_piece_, chain_side_, minima_,
                    records_, crossed_, crossed_edges_, spare_, mesh_.face_data, mesh_.edge_faces, mesh_.edge_marks,
                    roots_, counters_.buffer());
    runtime_.launch("retriangulate", "retriangulate_pieces", over(pieces_.count), grouped_, pieces_.count, roots_,
                    parts_.begins, starts_, records_, crossed_edges_, spare_, mesh_.face_data, mesh_.edge_faces,
                    mesh_.edge_marks, piece_edge_, counters_.buffer());
    if (hexagons_ > 0)
      runtime_.launch("holes", "hole_triangles", over(hexagons_), hexagons_, cl_uint(left_total_ + right_total_),
                      hole_place_, chain_vertex_, crossed_, mesh_.face_data);
  }

  void stitch() {
    runtime_.launch("stitch", "stitch_first", over(crossed_faces_), grouped_, crossed_faces_, crossed_, mesh_.face_data,
                    mesh_.edge_faces, mesh_.edge_marks, spare_, capacity_, table_, counters_.buffer());
    runtime_.launch("stitch", "stitch_second", over(crossed_faces_), crossed_faces_, crossed_, mesh_.face_data,
                    mesh_.edge_faces, capacity_, table_, counters_.buffer());
    runtime_.launch("stitch", "stitch_prove", over(crossed_faces_), crossed_faces_, crossed_, mesh_.n,
                    walked_.vertices.points, mesh_.face_data, mesh_.edge_faces, counters_.buffer());
    runtime_.launch("stitch", "stitch_mark", over(pieces_.count), pieces_.count, pieces_.ends, piece_edge_, roots_,
                    mesh_.face_data, mesh_.edge_marks, capacity_, table_, counters_.buffer());
  }

  runtime::Runtime& runtime_;
  Primitives& primitives_;
  const WalkedMesh walked_;
  Mesh& mesh_;
  History& history_;
  const Pieces& pieces_;
  PhaseCounters& counters_;
  PieceParts parts_;
  PartBegins begins_;
  Gates gates_;
  runtime::Buffer<cl_uint> near_, piece_edge_, chunk_entries_, crossed_, crossed_edges_, face_ends_, edge_ends_, spare_,
      starts_, far_, hexagon_face_, order_;
  runtime::Buffer<cl_uint2> last_sides_, roots_;
  runtime::Buffer<cl_uint4> chunk_heads_, records_;
  runtime::Buffer<cl_uint> chain_vertex_, chain_piece_, chain_side_, hole_place_, table_;
  runtime::Buffer<cl_ulong> chain_distances_, minima_;
  runtime::Buffer<device::MinimaLayers> layers_buffer_;
  cl_uint crossed_faces_ = 0, crossed_edge_count_ = 0, hexagons_ = 0, left_total_ = 0, right_total_ = 0;
  cl_uint grouped_ = 0;  // whether pieces have slots of their own (kernels/constrain/slots.cl)
  cl_uint claim_ = 1;
  cl_uint right_begin_ = 0, length_ = 0, capacity_ = 1, chunk_capacity_ = 0;
};

bool pays_to_leave_out(const Plan& plan, const Pieces& pieces) {
  const WalkedPieces& walked = pieces.walked;
  const std::uint32_t least = plan.least_existing == 0 ? 0 : std::max(plan.least_existing, pieces.count / 4);
  return walked.existing >= least;
}

/// Marks the edges that pieces are already, as far as cleaning knows. The other pieces, without their sources; the
/// faces in which their parts begin are those of `pieces`, lent.
Pieces other_than_edges(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices, const Mesh& mesh,
                        Pieces& pieces) {
  const WalkedPieces& walked = pieces.walked;
  const auto others = runtime.allocate<cl_uint>("pieces that are no edges", std::size_t{pieces.count} + 1);
  runtime.launch("constrain", "constrain_existing", over(pieces.count), pieces.count, mesh.n, vertices.points,
                 mesh.face_data, mesh.edge_faces, mesh.edge_marks, pieces.ends, walked.weights, walked.parts,
                 walked.faces, others);
  Pieces rest;
  rest.count = primitives.scan_total(others, pieces.count);
  const auto list = runtime.allocate<cl_uint>("list of other pieces", rest.count);
  primitives.compact_indices(others, list, pieces.count);
  rest.ends = runtime.allocate<cl_uint2>("other pieces", rest.count);
  rest.walked.weights = runtime.allocate<cl_uint>("weights of other pieces", rest.count);
  rest.walked.parts = runtime.allocate<cl_uint2>("parts of other pieces", rest.count);
  runtime.launch("parts", "parts_pick", over(rest.count), rest.count, list, pieces.ends, walked.weights, walked.parts,
                 rest.ends, rest.walked.weights, rest.walked.parts);
  rest.walked.crossed = walked.crossed;
  rest.walked.pool = walked.pool;
  rest.walked.faces = std::move(pieces.walked.faces);
  rest.walked.passed = std::move(pieces.walked.passed);
  return rest;
}

}  // namespace

ConstrainResult constrain(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan, const Vertices& vertices,
                          Mesh& mesh, History& history, Pieces& pieces, PhaseCounters& counters) {
  counters.zero();
  if (pieces.count == 0) return {};
  const auto enforce = [&](const Pieces& some) {
    return Constraining(runtime, primitives, plan, vertices, mesh, history, some, counters).run();
  };
  if (!pays_to_leave_out(plan, pieces)) return enforce(pieces);
  Pieces rest = other_than_edges(runtime, primitives, vertices, mesh, pieces);
  ConstrainResult result;
  if (rest.count > 0) result = enforce(rest);
  pieces.walked.faces = std::move(rest.walked.faces);
  pieces.walked.passed = std::move(rest.walked.passed);
  result.left_out = pieces.count - rest.count;
  result.existing_edges += result.left_out;
  return result;
}

}  // namespace gcdt

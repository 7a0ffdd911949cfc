// SPDX-License-Identifier: Apache-2.0
// Quality refinement on the host: rounds of judging, claiming and inserting (kernels/refine/; docs/refinement.md).
#pragma once

#include <numeric>

#include "phases/flip.hpp"
#include "phases/order.hpp"
#include "phases/output.hpp"
#include "phases/refine_rules.hpp"
#include "phases/subsegments.hpp"

namespace gcdt {

/// What a refinement did, and what it could not do.
struct RefineResult {
  std::uint64_t rounds = 0;
  std::uint32_t searches = 0;                           ///< for candidates, with those that found none
  std::uint64_t aims = 0;                               ///< of triangles, in all these searches
  std::uint32_t sweeps = 0;                             ///< over all faces, to judge them
  std::uint64_t candidates = 0;                         ///< of all rounds
  std::uint64_t added = 0;                              ///< vertices
  std::uint64_t on_subsegments = 0, bent = 0, far = 0;  ///< of these; beside their subsegments; rounded the other way
  double move = 0;  ///< how far one that this or an earlier refinement put on a piece is from it at most, in cells
  std::uint64_t flips = 0, flip_rounds = 0;
  std::uint64_t encroached = 0;              ///< sides of kept triangles that are subsegments with a corner in the lens
  std::uint64_t left[GCDT_LEFT_KINDS] = {};  ///< triangles worse than wanted, by reason
  bool complete = true;                      ///< it did not end by the limit of vertices

  std::uint64_t all_left() const { return std::accumulate(std::begin(left), std::end(left), std::uint64_t{0}); }
};

/// What comes of the mesh: as the phases before leave it, with other vertices.
struct RefinedMesh {
  Vertices vertices;  ///< input numbers of added vertices follow those of all others, in order of (x, y)
  Mesh mesh;          ///< the CDT of vertices and subsegments; labels are in its faces
  std::uint32_t added = 0;
  runtime::Buffer<cl_int2> added_points;  ///< on the grid
  /// What each was put on, in input numbers: three corners, or two ends and GCDT_NONE; and the piece as it was, or
  /// GCDT_NONE.
  runtime::Buffer<cl_uint4> added_origins;
  runtime::Buffer<cl_uint> edge_pieces;  ///< by edge: its piece as it was; edges of the hull come after those
  std::uint32_t piece_count = 0;         ///< of all these
  runtime::Buffer<cl_uint> reasons;      ///< by face: 1 + GCDT_LEFT_... of one that is worse than wanted, else 0
  runtime::Buffer<cl_uint2> piece_ends;  ///< by piece as it was, as vertices are numbered now
  runtime::Buffer<cl_uint> sharp;        ///< by piece: Subsegments::sharp
};

/// Refines one mesh.
class Refiner {
 public:
  /// `mesh` is the CDT of all `vertices` under `subsegments`, with at least one finite triangle; what it is refined to
  /// comes back from finish(). At most `most_added` vertices are added. `sizes`: with rules.sized, the wanted length at
  /// each vertex, in cells. `areas`: with rules.by_label, the largest doubled area of each label, in cells.
  Refiner(runtime::Runtime& runtime, Primitives& primitives, const device::RefineRules& rules, std::uint64_t most_added,
          Vertices vertices, Mesh mesh, Subsegments subsegments, runtime::Buffer<cl_uint> sizes,
          runtime::Buffer<cl_ulong> areas);

  /// Keeps the finite faces refs[i] (of all `count` of them) with kept[i] >= 0; all if `kept` is not allocated. Others
  /// are not refined. Called once, before run().
  void keep(const runtime::Buffer<cl_uint>& refs, const runtime::Buffer<cl_int>& kept, cl_uint count);

  /// Rounds until nothing is left to do, or the limit is reached. Throws round_limit, and cancelled.
  RefineResult run(Ticker& ticker);

  /// Numbers the vertices anew. The object is of no more use.
  RefinedMesh finish();

 private:
  void make_room(std::uint32_t capacity);
  void judge_faces();
  void find_candidates(std::uint32_t idle, Ticker& ticker);
  void wait(std::uint32_t idle);
  void aim(std::uint32_t idle);
  bool read_candidates();
  void take_settled();
  void flip_what_is_left(Ticker& ticker);
  void look_for_stars(std::uint32_t first, bool flipped);
  /// Where a work-item is a thread (kernels/refine/tail.cl).
  bool judges_by_stars() const { return runtime_.kind() == DeviceKind::threads; }
  bool is_small(std::uint32_t idle) const;
  std::uint32_t do_small_rounds(std::uint32_t& idle, Ticker& ticker);
  void take_over(const Stamps& stamps);
  bool insert_candidates(Ticker& ticker);
  void rank_candidates();
  void choose_winners();
  void keep_greatest(std::uint32_t winners, std::uint32_t most);
  void insert(std::uint32_t most);
  void settle(Ticker& ticker);
  void explain();
  double farthest();
  device::RefineReport read_report();
  cl_uint capacity() const { return static_cast<cl_uint>(keys_.size()); }
  cl_uint blocks() const { return static_cast<cl_uint>(cavities_.size() / GCDT_BLOCK); }
  cl_uint teamed() const { return runtime_.tuning().most_by_teams; }
  std::uint32_t count() const { return inputs_ + added_; }
  std::uint32_t most_left() const {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(most_added_ - added_, GCDT_NONE));
  }
  /// By place in aiming_: its candidate, if the faces of its cavity are listed. Judged is what was bad before: its
  /// memory.
  runtime::Buffer<cl_uint>& chosen() { return bad_before_; }
  /// Of a kernel that begins with the parameters of judge.h.
  template <class... Last>
  void launch_judge(const char* program, const char* kernel, runtime::Range range, const Last&... last) {
    runtime_.launch(program, kernel, range, mesh_.n, vertices_.points, mesh_.face_data, mesh_.edge_faces, rules_buffer_,
                    mesh_.edge_marks, origins_begin_, origins_, pieces_, sizes_, areas_, last...);
  }

  runtime::Runtime& runtime_;
  Primitives& primitives_;
  const device::RefineRules rules_;
  const std::uint64_t most_added_;
  Vertices vertices_;  ///< as they were, but for points, which are all that there is room for
  Mesh mesh_;          ///< its n: vertices that there is room for
  Plan plan_;
  WorkLists lists_;
  PhaseCounters counters_;
  const std::uint32_t inputs_;         ///< vertices before the refinement
  const std::uint32_t origins_begin_;  ///< the first vertex that has a word in origins_
  const bool knows_sharp_;
  std::uint32_t added_ = 0;
  const std::uint32_t subsegments_;
  runtime::Buffer<device::RefineRules> rules_buffer_;
  runtime::Buffer<cl_uint> sizes_;   ///< by vertex
  runtime::Buffer<cl_ulong> areas_;  ///< by label
  runtime::Buffer<cl_int> no_places_;
  runtime::Buffer<cl_uint2> pieces_;  ///< the pieces, then edges of the hull that are on none
  runtime::Buffer<cl_uint> sharp_;    ///< by piece
  runtime::Buffer<cl_uint> edge_pieces_;
  runtime::Buffer<cl_uint4> origins_;  ///< by vertex, from origins_begin_ on
  runtime::Buffer<cl_uint> bad_, bad_before_, aiming_, asked_, numbers_, ranks_;
  runtime::Buffer<cl_uint> urgency_;   ///< by face: wait.h; after the last round RefinedMesh::reasons
  runtime::Buffer<cl_uchar> ways_;     ///< by face: wait.h
  runtime::Buffer<cl_uint> cavities_;  ///< of candidates: candidates.h
  runtime::Buffer<cl_ulong> keys_;
  runtime::Buffer<cl_uint4> candidates_;
  runtime::Buffer<cl_uint> won_;     ///< by candidate in order
  runtime::Buffer<cl_uint> report_;  ///< a RefineReport, word by word
  bool labelled_ = false;
  bool report_begun_ = false;  ///< it is zero where a round begins from zero
  /// Whether the last insertion and its flips have not been read, and how many edges they have left if they have.
  bool unread_ = false;
  std::uint32_t edges_left_ = 0;
  /// What is known of the time when faces were judged last.
  struct Judged {
    std::uint32_t vertices = 0, bad = 0;
    /// Faces that have changed since have claim words from here on, unless claims have been cleared since.
    std::uint64_t claims = 0;
    std::uint32_t cleared = 0;
  };
  Judged judged_, judged_before_;
  device::RefineReport last_ = {};
  cl_uint stamp_ = 0, bits_ = 0;
  /// Whether what has changed since faces were judged is found by the stars of the vertices added since.
  bool finds_stars_ = false;
  /// Whether one work-item could not do the round before, which it began.
  bool was_small_ = false;
  RefineResult result_;
};

struct RefinedPieces {
  Pieces pieces;
  runtime::Buffer<cl_uint> before;  ///< by piece: that of which it is part
};

/// The subsegments of a refined mesh as pieces. `pieces` are those that were given to the refinement. With `hull` edges
/// of the hull are among them, which have no source; without, these are unconstrained from then on.
RefinedPieces refined_pieces(runtime::Runtime& runtime, Primitives& primitives, const RefinedMesh& refined,
                             const Pieces& pieces, bool hull);

}  // namespace gcdt

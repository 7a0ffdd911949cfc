// SPDX-License-Identifier: Apache-2.0
// Cleaning constraints on the mesh (kernels/constrain/clean.cl; docs/contract.md, 3).
#pragma once

#include "phases/walk.hpp"

namespace gcdt {

/// Constraints whose ends are two vertices.
struct KeptConstraints {
  cl_uint count = 0;
  runtime::Buffer<cl_uint> list;     ///< their numbers in the input, ascending or along the curve
  runtime::Buffer<cl_uint2> ends;    ///< their vertices
  runtime::Buffer<cl_uint> lengths;  ///< along the longer axis of each
  runtime::Buffer<cl_uint> places;   ///< if along the curve: the place of each in ascending order
  bool along_curve = false;
  std::uint64_t zero_length = 0;  ///< constraints whose ends are one vertex
  std::uint64_t length = 0;       ///< of all
  std::uint64_t crossings = 0;    ///< faces that all of them are expected to cross
};

struct CleanResult {
  Pieces pieces;
  std::uint64_t hits = 0;  ///< vertices found inside constraints, once per constraint
  std::uint64_t steps = 0;
  double walk_ms = 0;  ///< wall time of cutting constraints into parts and of the first walk; enforcing uses both
};

/// Copies constraints from host memory.
runtime::Buffer<cl_uint2> stage(runtime::Runtime& runtime, Constraints constraints);

/// Constraint `constraint` has an end (0 or 1) that is none of the `vertices`.
Error index_error(std::uint64_t constraint, std::uint64_t end, std::uint64_t vertices);

/// Makes one piece of each run of equal ones among `count` sorted pieces; the ends are not set. `firsts` has count + 1
/// elements and flags the first of each run. Blocks.
Pieces merge_runs(runtime::Runtime& runtime, Primitives& primitives, const runtime::Buffer<cl_uint>& firsts,
                  cl_uint count);

/// May be used several times with different selections of the same constraints.
class Cleaner {
 public:
  /// `constraints`: pairs of input points; the buffer must outlive this object.
  Cleaner(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices,
          const runtime::Buffer<cl_uint2>& constraints, std::uint32_t inputs);

  /// The constraints c with wanted[c] != 0 (all constraints if `wanted` is empty) that have a length. Throws
  /// index_out_of_range for the first constraint with an end that is no input point. Blocks. They are along the curve
  /// if that pays, and sorted along it if they may be taken in turn, or are wanted `sorted`.
  KeptConstraints keep(const Plan& plan, const std::vector<cl_uint>& wanted, bool sorted = false);
  /// Every `step`-th of the kept ones. Blocks.
  KeptConstraints every(const KeptConstraints& kept, cl_uint step);
  /// The pieces of the kept constraints, split at all vertices on them; none are made where all constraints cross fewer
  /// than `least` faces. `walked` is a mesh with all vertices, not changed since its history was made. Blocks.
  CleanResult clean(const WalkedMesh& walked, const KeptConstraints& kept, PhaseCounters& counters,
                    std::uint64_t least = 0);

 private:
  bool pays_along_curve(const Plan& plan, const KeptConstraints& kept) const;
  /// By cells of so many bits at most, in any order in each, or sorted if 0.
  void put_along_curve(KeptConstraints& kept, unsigned cell_bits);
  /// The same constraints in `along`, whose buffers are there.
  void put_in_cells(unsigned most_bits, const KeptConstraints& kept, KeptConstraints& along);
  void sort_along_curve(const KeptConstraints& kept, KeptConstraints& along);
  /// What the walks along the parts of the kept constraints leave.
  struct Found {
    PartBegins begins;
    runtime::Buffer<cl_uint> offsets;     ///< parts + 1: of each part's vertices among all
    runtime::Buffer<cl_uint> crossed;     ///< faces, by constraint
    runtime::Buffer<cl_uint> passed;      ///< edges, by part: what its walk passes
    runtime::Buffer<cl_uint> first_hits;  ///< the first vertex of each part that has some
    runtime::Buffer<cl_uint> hits;        ///< the vertices, after write_hits()
  };
  Found walk(const WalkedMesh& walked, const KeptConstraints& kept, const PieceParts& parts, PhaseCounters& counters);
  void walk_rest(const WalkedMesh& walked, const KeptConstraints& kept, const PieceParts& parts, Found& found,
                 PhaseCounters& counters);
  void write_hits(const WalkedMesh& walked, const KeptConstraints& kept, const PieceParts& parts, Found& found,
                  PhaseCounters& counters);
  void launch_walk(cl_uint task, const WalkedMesh& walked, const KeptConstraints& kept, const PieceParts& parts,
                   const Found& found, const runtime::Buffer<cl_uint>& searched, const runtime::Buffer<cl_uint>& counts,
                   PhaseCounters& counters);
  void place_pieces(const KeptConstraints& kept, const PieceParts& parts, const runtime::Buffer<cl_uint>& offsets,
                    runtime::Buffer<cl_uint>& firsts);
  Pieces merge(const Vertices& vertices, runtime::Buffer<cl_ulong> keys, runtime::Buffer<cl_uint> sources,
               const runtime::Buffer<cl_uint>& crossed, const runtime::Buffer<cl_uint2>& whole, cl_uint count,
               unsigned bits);

  runtime::Runtime& runtime_;
  Primitives& primitives_;
  const Vertices& vertices_;
  std::uint32_t inputs_ = 0;
  cl_uint count_ = 0;
  const runtime::Buffer<cl_uint2>& constraints_;
};

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// Splitting constraints that cross (kernels/constrain/split.cl, kernels/constrain/route.cl; docs/splitting.md).
#pragma once

#include "phases/crossings.hpp"
#include "phases/order.hpp"

namespace gcdt {

/// The vertices that splitting adds, in order of (x, y) on the grid; then those that refinement adds, in such an order.
struct AddedVertices {
  std::uint32_t count = 0;
  std::uint32_t crossings = 0;      ///< the first of them; the rest is of refinement
  runtime::Buffer<cl_int2> points;  ///< on the grid
  /// The least pair of constraints that cross in the vertex's pixel; of refinement GCDT_NONE twice.
  runtime::Buffer<cl_uint2> crossing;
  /// Of refinement what the vertex was put on, in input numbers: a triangle's corners, or two ends and GCDT_NONE; then
  /// the least constraint along it, or GCDT_NONE. Of crossings GCDT_NONE. Not allocated without refinement.
  runtime::Buffer<cl_uint4> origins;
};

class Splitter {
 public:
  /// `constraints`: pairs of input points, of which there are `inputs`. The buffer must outlive this object.
  Splitter(runtime::Runtime& runtime, Primitives& primitives, const runtime::Buffer<cl_uint2>& constraints,
           std::uint32_t inputs);

  /// Called once. Finds all crossings of pieces, rounds them, and marks their constraints. Returns how many pairs of
  /// constraints cross. Arguments as for CrossingPieces.
  std::uint64_t find(const WalkedMesh& walked, const Pieces& pieces, PhaseCounters& counters);

  /// Called once, after find(). Returns `vertices` and the added ones, ordered anew on the same grid. The input numbers
  /// of added vertices follow those of the input. Throws too_many_vertices.
  Vertices add(Vertices vertices);

  /// Returns the links into which the marked constraints are routed, and the other constraints as they are: pairs of
  /// input numbers, ordered by constraint, and along each constraint.
  const runtime::Buffer<cl_uint2>& route(const Plan& plan, const Vertices& vertices);

  /// Marks the constraints that own crossing pieces of links. Returns how many were not marked before.
  std::uint32_t mark(const WalkedMesh& walked, const Pieces& pieces, PhaseCounters& counters);

  /// Used instead of all the above, where only the constraints that cross are wanted: marks them and returns the marks,
  /// one word for each constraint, 0 or 1.
  const runtime::Buffer<cl_uint>& mark_crossing(const WalkedMesh& walked, const Pieces& pieces,
                                                PhaseCounters& counters);

  /// Turns the sources of pieces of links into constraints.
  void name_sources(Pieces& pieces);

  AddedVertices& added() { return added_; }
  /// One word for each constraint, 1 for those that were marked. The splitter has none then.
  runtime::Buffer<cl_uint> take_marks() { return std::move(touched_); }
  std::uint32_t marked() const { return marked_; }
  /// The largest distance of a constraint from its links, in cells, after the last route; below sqrt(1/2).
  double largest_move() const { return largest_move_; }

 private:
  std::uint32_t mark(CrossingPieces& crossing, const Pieces& pieces, bool linked);
  void gather_points(CrossingPieces& crossing, const WalkedMesh& walked, const Pieces& pieces);
  void keep_distinct(runtime::Buffer<cl_ulong> keys, runtime::Buffer<cl_uint> numbers,
                     const runtime::Buffer<cl_uint2>& named, cl_uint count);
  void measure(const runtime::Buffer<cl_ulong2>& farthest);

  runtime::Runtime& runtime_;
  Primitives& primitives_;
  const runtime::Buffer<cl_uint2>& constraints_;
  const cl_uint inputs_, count_;
  runtime::Buffer<cl_uint> touched_;  ///< 1 for each marked constraint
  std::uint32_t marked_ = 0;
  std::uint64_t pairs_ = 0;

  cl_uint distinct_ = 0;             ///< pixels with a crossing
  runtime::Buffer<cl_ulong> keys_;   ///< their centres, ascending
  runtime::Buffer<cl_uint2> least_;  ///< the least pair of constraints that cross there
  AddedVertices added_;

  runtime::Buffer<cl_uint2> links_;
  runtime::Buffer<cl_uint> owners_;  ///< the constraint of each link
  double largest_move_ = 0;
};

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// Which constraints cross (kernels/constrain/crossings.cl), and which are kept (docs/contract.md, 3).
#pragma once

#include <functional>
#include <vector>

#include "phases/walk.hpp"

namespace gcdt {

/// The pairs of pieces that cross. All are counted at once; they are listed in windows, so that memory stays bounded.
class CrossingPieces {
 public:
  /// `walked` is the mesh with all vertices, not flipped since; all arguments must outlive this object.
  /// Throws out_of_memory for 2^32 - 1 pairs or more, or if the records do not fit the device.
  CrossingPieces(runtime::Runtime& runtime, Primitives& primitives, const WalkedMesh& walked, const Pieces& pieces,
                 PhaseCounters& counters);
  cl_uint count() const { return count_; }
  /// Calls use(pairs, some) for windows of at most Tuning::pairs_split_at_once, until all pairs were listed.
  template <class Use>
  void for_windows(Use&& use) {
    auto pairs = runtime_.allocate<cl_uint2>("crossing pieces", std::min(Tuning::pairs_split_at_once, count_));
    for (cl_uint first = 0, some; first < count_; first += some) {
      some = std::min(Tuning::pairs_split_at_once, count_ - first);
      list(first, some, pairs);
      use(pairs, some);
    }
  }
  /// Writes pairs first .. first + count - 1 (piece numbers, the smaller one first) to the start of `pairs`. The order
  /// of the pairs may differ from run to run.
  void list(cl_uint first, cl_uint count, const runtime::Buffer<cl_uint2>& pairs) {
    test(1, first, first + count, pairs);
  }

 private:
  void find_records();
  void test(cl_uint emit, cl_uint first, cl_uint last, const runtime::Buffer<cl_uint2>& pairs);

  runtime::Runtime& runtime_;
  Primitives& primitives_;
  const WalkedMesh& walked_;
  const Pieces& pieces_;
  PhaseCounters& counters_;
  bool all_ = false;  ///< every piece is tested with every other one of its problem
  cl_uint rows_ = 0, count_ = 0;
  runtime::Buffer<cl_uint> starts_, records_, counts_;
};

/// Pairs of input constraints that cross, the smaller number first, ascending. Empty if none do.
/// `walked` is the mesh with all vertices, not flipped since. Throws out_of_memory if the records or
/// the pairs do not fit the device.
std::vector<Constraint> find_crossings(runtime::Runtime& runtime, Primitives& primitives, const WalkedMesh& walked,
                                       const Pieces& pieces, PhaseCounters& counters);

/// The error for constraints that cross. Its indices are all pairs, its message names the first ten. `ends(c)` are the
/// input vertices of constraint c.
Error crossings_error(const std::vector<Constraint>& crossings, const std::function<Constraint(std::uint32_t)>& ends,
                      bool rounded);

/// In input order, a constraint is dropped if and only if it crosses an earlier one that was kept.
/// Returns the dropped ones, ascending.
std::vector<std::uint32_t> drop_crossing(const std::vector<Constraint>& crossings);

}  // namespace gcdt

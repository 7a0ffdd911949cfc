// SPDX-License-Identifier: Apache-2.0
// The paper on one screen: order, insert, constrain, flip, then output and check.
#pragma once

#include "clean.hpp"
#include "constrain.hpp"
#include "flip.hpp"
#include "order.hpp"

namespace gcdt {

/// One triangulation on one device.
class Pipeline {
 public:
  Pipeline(runtime::Runtime& runtime, Primitives& primitives, Points points, Constraints constraints,
           const Options& options);
  /// Throws Error; see Solver::triangulate.
  Triangulation run();

 private:
  void insert();
  void constrain_all();
  void resolve_crossings(const ConstrainResult& first);
  [[noreturn]] void reject(const std::vector<Constraint>& crossings) const;
  void flip_all();
  void output();
  void finish_statistics();

  void clean(const std::vector<cl_uint>& wanted);
  ConstrainResult enforce();
  void count_flips(const FlipResult& flipped);

  /// Runs a step and adds its wall time, without building programs, to `ms`.
  template <class Step>
  void timed(double& ms, Step&& step);

  runtime::Runtime& runtime_;
  Primitives& primitives_;
  Points points_;
  Constraints constraints_;
  const Options& options_;
  Ticker ticker_;
  Triangulation result_;
  Statistics& statistics_ = result_.statistics;

  Vertices vertices_;
  Mesh mesh_;
  WorkLists lists_;
  History history_;
  PhaseCounters counters_;
  std::unique_ptr<Cleaner> cleaner_;
  Pieces pieces_;
  double sort_ms_ = 0, clean_ms_ = 0;
};

}  // namespace gcdt

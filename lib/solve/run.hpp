// SPDX-License-Identifier: Apache-2.0
// A triangulation in the making, of one problem or of many in one mesh, and the steps that are the same for both. Their
// sequences stand in solve/triangulate.cpp and batch/pipeline.cpp.
#pragma once

#include "device/step.hpp"
#include "phases/clean.hpp"
#include "phases/constrain.hpp"
#include "phases/enforce.hpp"
#include "phases/flip.hpp"
#include "phases/triangulation.hpp"

namespace gcdt {

/// Where steps end in what a call with as many constraints as vertices takes, roughly: only progress is told by it.
constexpr double ordered_share = 0.1, inserted_share = 0.5, constrained_share = 0.75, flipped_share = 0.9;
/// The same of the output where a refinement follows.
constexpr double ordered_before_refining = 0.93;
/// The part of the constraints' share that cleaning takes.
constexpr double cleaned_share = 0.3;

/// Owns all that a call has on the device until its result is made. Whoever writes a sequence of steps reads and
/// changes it; a step says what it releases.
struct Run {
  Run(runtime::Runtime& device, Primitives& all, const Options& wanted, std::uint64_t inputs, std::uint64_t given);

  runtime::Runtime& runtime;
  Primitives& primitives;
  const Options& options;
  const std::uint64_t n, m;           ///< vertices and constraints as given
  const std::uint64_t in_use_before;  ///< bytes on the device

  Plan plan;
  Ticker ticker;
  PhaseCounters counters;
  runtime::Buffer<cl_uint2> constraints;  ///< as given, until all are enforced
  Vertices vertices;
  Mesh mesh;
  WorkLists lists;  ///< not while constraints are enforced all at once: the nearest pieces of edges take their place
  History history;
  Pieces pieces;
  runtime::Buffer<cl_int> turns;  ///< by piece; for domains
  DeviceTriangulation result;
  Statistics& statistics = result.statistics;

  /// Runs `f` as a step: a span of the trace, whose wall time, without building programs, is added to `ms`.
  template <class F>
  void step(const char* name, double& ms, F&& f) {
    Step timed(runtime, name);
    f();
    ms += timed.end();
  }
  /// The same for a step whose progress ends at `share` of the whole, and begins where the one before ended.
  template <class F>
  void step(const char* name, double& ms, double share, F&& f) {
    ticker.enter(told_, share);
    told_ = share;
    step(name, ms, std::forward<F>(f));
  }

  /// Takes what the order phase made, and plans what follows.
  void take(OrderResult ordered);
  /// Says the plan in the log, and in the trace as a span of no length in a phase `plan`.
  void tell_plan() const;
  /// Level by level: insert, then flip, so that each level goes into a Delaunay mesh (paper, section 8). The last level
  /// is left unflipped: constraints are enforced first, and located by its history tree. A plan that grows puts
  /// vertices in one after the other, each with its flips, and constraints come to a Delaunay mesh, in which they cross
  /// fewer edges (bench/NOTES.md). Called again, makes the mesh anew, without constraints.
  void insert();
  /// Of an input without constraints.
  void no_pieces();
  /// Makes pieces of those of the constraints `given`, pairs of `inputs` input vertices, that are `wanted` (none: all).
  void clean(const runtime::Buffer<cl_uint2>& given, std::uint64_t inputs, const std::vector<cl_uint>& wanted = {});
  /// Makes the pieces edges, all at once. Releases the lists.
  ConstrainResult enforce();
  /// Both; where it pays, in turn (phases/ahead.hpp). The pieces are there if enforcing failed, too.
  ConstrainResult clean_and_enforce(const runtime::Buffer<cl_uint2>& given, std::uint64_t inputs,
                                    const std::vector<cl_uint>& wanted = {});
  /// Makes constraints pieces and edges, one after the other, by a work-item a problem (Plan::constraints).
  EnforceResult enforce_in_order(const runtime::Buffer<cl_uint>& first_constraint);
  /// Which way sources run along pieces, if regions are wanted. Releases the constraints.
  void count_turns();
  /// Makes the mesh (constrained) Delaunay.
  void flip();
  /// Labels regions, and takes triangles that are not of the domain out of `ordered`. What is returned has no regions
  /// any more, which are the result's, and all triangles in place of those that were kept, if any were taken out.
  SelectedDomain select(OrderedMesh& ordered);
  bool wants_regions() const {
    return options.regions || options.domain != Domain::hull ||
           (options.refine && !options.refine->region_areas.empty());
  }
  WalkedMesh walked() { return {plan, vertices, mesh, history}; }
  /// Releases what output does not need.
  void begin_output();
  /// Makes `ordered` the result's mesh, and input numbers of vertices.
  void number(OrderedMesh ordered);
  /// The sums of times, counters and sizes; the result is whole.
  DeviceTriangulation finish();
  /// `error` of a workspace too small for one step, with the bytes that all steps need.
  Error with_bytes_needed(const Error& error) const;

 private:
  void insert_levels();
  void grow_all();
  void need_lists();
  void count(const FlipResult& flipped);
  void count(const CleanResult& cleaned);
  void count(const ConstrainResult& enforced);
  void make_pieces(Cleaner& cleaner, const KeptConstraints& kept, bool all);
  ConstrainResult enforce_in_turn(Cleaner& cleaner, CleanResult some, KeptConstraints kept, bool all);

  double told_ = 0, sort_ms_ = 0, built_;
  std::uint64_t launches_, read_backs_;
};

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// The paper on one screen: order, insert, constrain, flip, then output and check.
#pragma once

#include "device/step.hpp"
#include "phases/clean.hpp"
#include "phases/constrain.hpp"
#include "phases/domain.hpp"
#include "phases/flip.hpp"
#include "phases/grow.hpp"
#include "phases/order.hpp"
#include "phases/output.hpp"
#include "phases/split.hpp"

namespace gcdt {

/// The input in device memory, where the pipeline finds all input.
struct DeviceInput {
  InputPoints points;
  runtime::Buffer<cl_uint2> constraints;  ///< pairs of input points
};

/// Where the input comes from. `load` is called as part of the order step; and once more at the end for a note, where
/// rounding may have put all vertices on one line. What it reads must last as long as the call.
struct InputSource {
  std::uint64_t n = 0, m = 0;  ///< vertices and constraints
  std::function<DeviceInput()> load;
};

/// What a run leaves in device memory; all numbers are input numbers.
struct DeviceTriangulation {
  OrderedMesh mesh;
  runtime::Buffer<cl_uint> representatives;  ///< one per input vertex, then per added one
  Pieces pieces;
  runtime::Buffer<cl_uint> dropped;  ///< constraints, ascending
  Regions regions;                   ///< empty unless asked for
  Vertices vertices;
  OrderedMesh hull;              ///< all triangles, where a domain has left some out
  runtime::Buffer<cl_int> kept;  ///< the place of each of them in `mesh`, or -1
  AddedVertices added;
  Statistics statistics;
};

/// One triangulation on one device; or many in one mesh, by overriding what is not the same then (forest.hpp).
class Pipeline {
 public:
  Pipeline(runtime::Runtime& runtime, Primitives& primitives, InputSource source, const Options& options);
  /// Throws Error; see gcdt_triangulate.
  DeviceTriangulation run();
  virtual ~Pipeline() = default;

 protected:
  virtual OrderResult order_points(InputPoints points);
  [[noreturn]] virtual void reject(const std::vector<Constraint>& crossings);
  virtual void output();
  /// Where enforces_by_problem() holds: cleans and enforces all constraints, sets pieces_, and leaves a constrained
  /// Delaunay mesh; or returns false, the mesh void.
  virtual bool enforce_by_problem() { return false; }
  /// Follows Crossing::split, in a mesh in which constraints could not be enforced and which has been restored.
  virtual void split_crossings();
  [[noreturn]] void fail_without_crossings(const ConstrainResult& failed) const;

  /// Runs a step and adds its wall time, without building programs, to `ms`. `phase` is its name in a trace.
  template <class F>
  void timed(const char* phase, double& ms, F&& f);

 private:
  void insert();
  void constrain_all();
  void clean_and_enforce();
  void resolve_crossings(const ConstrainResult& first);
  void drop_crossings(const std::vector<Constraint>& crossings);
  void flip_all();
  void select(OrderedMesh& ordered);
  bool wants_regions() const { return options_.regions || options_.domain != Domain::hull; }
  std::string empty_note() const;
  std::string flat_note();
  void finish_statistics();
  void run_steps();
  [[noreturn]] void ask_for_workspace(const Error& error) const;

  void clean(const std::vector<cl_uint>& wanted);
  ConstrainResult enforce();
  void need_lists();
  void count_flips(const FlipResult& flipped);

 protected:
  runtime::Runtime& runtime_;
  Primitives& primitives_;
  InputSource source_;
  runtime::Buffer<cl_uint2> constraints_;
  std::uint64_t in_use_before_;
  const Options& options_;
  Ticker ticker_;
  DeviceTriangulation result_;
  Statistics& statistics_ = result_.statistics;

  Vertices vertices_;
  Mesh mesh_;
  WorkLists lists_;
  History history_;
  PhaseCounters counters_;
  std::unique_ptr<Cleaner> cleaner_;
  Pieces pieces_;
  runtime::Buffer<cl_int> turns_;  ///< by piece; for domains
  bool by_problem_ = false;        ///< vertices and constraints go in problem by problem
  double sort_ms_ = 0;
};

template <class F>
void Pipeline::timed(const char* phase, double& ms, F&& f) {
  Step step(runtime_, phase);
  f();
  ms += step.end();
}

/// See gcdt_required_bytes (lib/solve/memory.cpp).
std::uint64_t device_bytes_needed(std::uint64_t n, std::uint64_t m, std::uint64_t crossed);

}  // namespace gcdt

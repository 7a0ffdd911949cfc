// SPDX-License-Identifier: Apache-2.0
// Which way an input goes: every choice between two ways of doing the same, made in one place before the phases begin.
// No result depends on it (docs/devices.md has the ways, docs/testing.md how tests take each of them).
#pragma once

#include <cstdint>
#include <string>

#include "device/runtime.hpp"

namespace gcdt {

struct Vertices;

/// What a plan knows of the device.
struct PlannedDevice {
  DeviceKind kind = DeviceKind::threads;
  std::uint32_t units = 1;               ///< compute units
  std::uint32_t groups = 1;              ///< of a launch at most
  std::uint64_t local_bytes = 1u << 15;  ///< local memory of a work-group
  std::uint64_t largest_buffer = UINT64_MAX;
  bool spares_programs = false;  ///< see runtime::SparedPrograms
  bool works_here = false;       ///< the calling thread does all: runtime::WorkHere
};

/// What a plan knows of the input. Of several problems, sums, but for `largest`.
struct PlannedSizes {
  std::uint32_t problems = 1;  ///< triangulations in one mesh
  std::uint32_t inputs = 0;    ///< vertices as given
  std::uint32_t vertices = 0;  ///< distinct ones on the grid; before they are known, as many as are given
  std::uint32_t largest = 0;   ///< inputs of the largest of several problems
};

struct Plan {
  /// Who does a step that work-items can share.
  enum class By {
    all,     ///< work-items of a launch share it
    one,     ///< one work-item does all of it (kernels/programs/by_one_item.cl, constrain/enforce.cl)
    each,    ///< one work-item does all of a problem: threads, problems enough to share out
    groups,  ///< one work-group does all of a problem, without launches and reads in between
  };

  bool works_here = false;  ///< the calling thread does all, as the one work-item of each launch

  // Order.
  By order = By::all;          ///< all or one
  By sort_problems = By::all;  ///< each problem's keys: all, each, or groups
  bool one_level = false;      ///< of problems; else levels as the largest problem would have alone
  std::uint32_t coarsest_level = 0;

  // Insert and flip. Growing inserts vertices one after the other with their flips; else rounds go level by level.
  bool grows = false;
  By problems = By::all;  ///< insertion and flips of problems: all, each (growing), or groups (rounds)
  std::uint32_t problems_of_launch = 0;
  std::uint32_t group_vertices = 0;  ///< so many are inserted by one work-group
  std::uint32_t group_edges = 0;     ///< so many are flipped by one work-group
  std::uint32_t group_rounds = 0;    ///< of insertion by one group in one launch at most
  std::uint32_t group_flip_rounds = 0;
  std::uint32_t rounds_before_few = 0;  ///< of a phase, before one work-group may do rounds
  std::uint32_t rounds_per_read = 0;
  std::uint32_t least_patched = 0;   ///< edges from which on flips begin within patches
  std::uint32_t patch_vertices = 0;  ///< of a patch at most
  std::uint64_t patch_bytes = 0;     ///< local memory of a patch at most
  std::uint32_t patch_rounds = 0;    ///< of a patch or district at most
  std::uint32_t least_divided = 0;   ///< edges from which on flips go on within districts
  std::uint32_t district_vertices = 0;
  std::uint32_t least_sweep = 0;   ///< edges from which on flips sweep
  std::uint32_t sweep_share = 0;   ///< and for as long as one in so many is illegal
  std::uint32_t grown_shares = 0;  ///< sequences of insertions side by side, at most

  // Constrain.
  /// All; or one, or each: one work-item enforces those of the problem, or of each, one after the other.
  By constraints = By::all;
  /// Crossed faces a constraint from which on they are cleaned in the order of the curve; and bits of the numbers of
  /// the cells of it by which they are put in order, if not by their places along it.
  std::uint32_t curve_crossings = 0;
  unsigned curve_bits = 0;
  std::uint32_t least_parts = 0, most_parts = 0;  ///< of constraints, beyond one each
  std::uint32_t crossings_per_part = 0;           ///< crossed faces of a part, about
  /// Where parts would have `crossings_of_long` faces and more, there are so many at most.
  std::uint32_t long_parts = 0, crossings_of_long = 0;
  std::uint32_t long_piece = 0;  ///< long pieces have so many times as many parts, within long_parts
  /// Crossed faces, as many times as there are faces, from which on every `step_ahead`-th constraint is cleaned and
  /// enforced ahead of the others.
  std::uint32_t crossings_ahead = 0, step_ahead = 0;
  std::uint32_t crossings_gated = 0;  ///< so many times as many, from which on walks are given gates (phases/gates.hpp)
  std::uint32_t crossings_ordered = 0;  ///< crossed faces a part from which on lanes side by side walk as far
  std::uint32_t least_existing = 0;     ///< pieces that are edges already from which on these are left out
  /// Edges of the mesh from which on pieces have slots of their own, and crossed faces of a piece up to which.
  std::uint32_t least_grouped = 0, grouped_crossings = 0;
  std::uint32_t all_pairs = 0;  ///< pieces of a problem up to which all pairs may be tested for crossings

  // Output and check.
  By output = By::all;        ///< triangles in canonical order: all, one, or each, who does the domain, too
  By number = By::all;        ///< input numbers: all or one
  By check = By::all;         ///< all or one
  bool lists_pieces = false;  ///< the check looks for pieces by their first vertex, not by bisection

  /// In words, for the trace and --stats.
  std::string text() const;
};

/// Parts beyond one a constraint, where these cross so many faces in all. `had`: so many are there already, and most
/// are kept, so that others are made as far as long_parts reach.
std::uint32_t part_pool(const Plan& plan, std::uint64_t crossings, std::uint32_t had = 0);
/// The pool that a long piece, one that would have many parts of this pool, has its share of instead; long_parts at
/// most. It only bounds what is made: few pieces are long.
std::uint32_t long_part_pool(const Plan& plan, std::uint32_t pool);

/// Whether it pays to take so many constraints in turn, which cross so many faces in all (phases/ahead.hpp).
bool pays_in_turn(const Plan& plan, const PlannedSizes& sizes, std::uint32_t constraints, std::uint64_t crossings);
/// Whether it may. `crossings`: faces that they would cross by their length (expected_crossings). Where vertices fill
/// half the width of the grid, it is four times as many.
inline bool may_pay_in_turn(const Plan& plan, const PlannedSizes& sizes, std::uint32_t constraints,
                            std::uint64_t crossings) {
  return pays_in_turn(plan, sizes, constraints, 4 * crossings);
}

Plan make_plan(const PlannedDevice& device, const Tuning& tuning, const PlannedSizes& sizes);

/// Of a runtime's device as its geometry is now.
PlannedDevice planned_device(const runtime::Runtime& runtime);
Plan make_plan(const runtime::Runtime& runtime, const PlannedSizes& sizes);
PlannedSizes sizes_of(const Vertices& vertices);
/// For a mesh of these vertices.
inline Plan make_plan(const runtime::Runtime& runtime, const Vertices& vertices) {
  return make_plan(runtime, sizes_of(vertices));
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// What becomes of constraints that could not all be enforced, because they cross: an error, the later ones dropped, or
// all split at vertices of their own (docs/contract.md, 3).
#pragma once

#include "phases/crossings.hpp"
#include "solve/run.hpp"

namespace gcdt {

/// Restores the mesh, which enforcement may have changed, and does as Options::crossing says. After: the pieces of the
/// constraints that are left are edges. Throws Status::crossing_constraints, or check_failed if none cross.
void follow_crossing_policy(Run& run, const ConstrainResult& failed);

/// The pairs of constraints that cross. The mesh is as it was before enforcement failed. Throws check_failed for none.
std::vector<Constraint> find_crossings(Run& run, const ConstrainResult& failed);

/// Drops each constraint that crosses an earlier one that is kept, and enforces the rest.
void drop_crossings(Run& run, const std::vector<Constraint>& crossings);

/// Tells the result which constraints are dropped, ascending.
void name_dropped(Run& run, const std::vector<std::uint32_t>& dropped);

/// Enforces the run's pieces again, now that none cross, in the mesh as it was before enforcement failed. Throws
/// check_failed if some cross.
void enforce_rest(Run& run);

[[noreturn]] void fail_without_crossings(const ConstrainResult& failed);

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// Which constraints cross (kernels/crossings.cl), and which are kept (contract, section 3).
#pragma once

#include <functional>
#include <vector>

#include "walk.hpp"

namespace gcdt {

/// Pairs of input constraints that cross, the smaller number first, ascending. Empty if none do.
/// `walked` is the mesh with all vertices, not flipped since. Throws out_of_memory if the records or
/// the pairs do not fit the device.
std::vector<Constraint> find_crossings(runtime::Runtime& runtime, Primitives& primitives, const WalkedMesh& walked,
                                       const Pieces& pieces, PhaseCounters& counters);

/// The error that names the first ten of the pairs; `ends(c)` are the input vertices of constraint c.
Error crossings_error(const std::vector<Constraint>& crossings, const std::function<Constraint(std::uint32_t)>& ends,
                      bool rounded);

/// In input order, a constraint is dropped if and only if it crosses an earlier one that was kept.
/// Returns the dropped ones, ascending.
std::vector<std::uint32_t> drop_crossing(const std::vector<Constraint>& crossings);

}  // namespace gcdt

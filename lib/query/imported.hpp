// SPDX-License-Identifier: Apache-2.0
// The device's proof (check.hpp) of a mesh that comes from outside.
#pragma once

#include "phases/clean.hpp"
#include "phases/order.hpp"

namespace gcdt {

/// Throws check_failed with the first fault, as check() does; what order() throws for bad vertices; and
/// index_out_of_range or invalid_argument for a constraint whose ends are no two vertices, or that occurs twice.
/// `mesh` has neighbours and flags; `constraints` are the pieces after cleaning.
void check_imported(runtime::Runtime& runtime, Primitives& primitives, Points points, Constraints constraints,
                    const MeshView& mesh, const std::optional<FixedGrid>& grid);

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// Enforcing constraints in turn, where all of them cross many faces.
#pragma once

#include "phases/constrain.hpp"

namespace gcdt {

/// As constrain(). Where it pays (Plan::crossings_ahead), every so many-th piece is enforced ahead of the others: these
/// then lie in narrow strips between edges that they cannot cross, and cross few faces. What cleaning says of `pieces`
/// is lost by that.
ConstrainResult constrain_in_turn(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                                  const Vertices& vertices, Mesh& mesh, History& history, Pieces& pieces,
                                  PhaseCounters& counters);

}  // namespace gcdt

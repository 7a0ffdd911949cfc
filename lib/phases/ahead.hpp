// SPDX-License-Identifier: Apache-2.0
// Constraints in turn: where all of them cross many faces, every so many-th is cleaned and enforced ahead of the
// others. These then lie in narrow strips between edges that they cannot cross, so that cleaning and enforcing them
// goes through few faces.
#pragma once

#include "phases/clean.hpp"
#include "phases/constrain.hpp"

namespace gcdt {

/// The pieces of every so many-th of the kept constraints, where these cross so much that it pays to enforce them
/// ahead; else none. `walked` and `counters` as for Cleaner::clean().
CleanResult clean_ahead(Cleaner& cleaner, const WalkedMesh& walked, const KeptConstraints& kept,
                        PhaseCounters& counters);

/// Enforces them, by constrain(). If nothing failed, `history` then leads to the faces of the new mesh, and
/// `kept.crossings` is what all are expected to cross there.
ConstrainResult enforce_ahead(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                              const Vertices& vertices, Mesh& mesh, History& history, Pieces& pieces,
                              KeptConstraints& kept, PhaseCounters& counters);

/// Adds what was enforced ahead to what enforcing all constraints says afterwards.
void add_ahead(const ConstrainResult& ahead, ConstrainResult& all);

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/ahead.hpp"

namespace gcdt {

// Lengths say what constraints would cross if vertices were spread evenly; what some of them do cross, counted, says
// more, and costs little.
CleanResult clean_ahead(Cleaner& cleaner, const WalkedMesh& walked, const KeptConstraints& kept,
                        PhaseCounters& counters) {
  const Plan& plan = walked.plan;
  if (!may_pay_in_turn(plan, sizes_of(walked.vertices), kept.count, kept.crossings)) return {};
  const std::uint64_t least = std::uint64_t{plan.crossings_ahead} * walked.mesh.faces() / plan.step_ahead;
  return cleaner.clean(walked, cleaner.every(kept, plan.step_ahead), counters, least);
}

// A vertex that many pieces end at has their edges then, so that walks begin with its fan. Where constraints are spread
// evenly, the others cross about as many faces as those ahead did. Parts for half of them are the best: where parts
// begin takes long to find now, as there is no tree (NOTES, "Constraints in turn").
ConstrainResult enforce_ahead(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                              const Vertices& vertices, Mesh& mesh, History& history, Pieces& pieces,
                              KeptConstraints& kept, PhaseCounters& counters) {
  const ConstrainResult ahead = constrain(runtime, primitives, plan, vertices, mesh, history, pieces, counters);
  if (ahead.failed) return ahead;
  history = freeze_all(runtime, vertices, mesh, counters);
  history.fans = make_fans(runtime, primitives, vertices, mesh, counters);
  kept.crossings = pieces.walked.crossed / 2;
  return ahead;
}

// They are edges when all are enforced.
void add_ahead(const ConstrainResult& ahead, ConstrainResult& all) {
  all.existing_edges -= ahead.walked;
  all.walked += ahead.walked;
  all.chain_vertices += ahead.chain_vertices;
  all.holes += ahead.holes;
  all.symbolic_chain_vertices += ahead.symbolic_chain_vertices;
  all.crossed_pairs += ahead.crossed_pairs;
  all.steps += ahead.steps;
  for (std::size_t i = 0; i < all.pairs_of_two.size(); ++i) all.pairs_of_two[i] += ahead.pairs_of_two[i];
}

}  // namespace gcdt

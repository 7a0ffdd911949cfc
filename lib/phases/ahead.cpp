// SPDX-License-Identifier: Apache-2.0
#include "phases/ahead.hpp"

namespace gcdt {

using runtime::over;

namespace {

bool pays(const Plan& plan, const Vertices& vertices, const Mesh& mesh, const Pieces& pieces) {
  return vertices.roots == 1 && pieces.count > plan.step_ahead &&
         pieces.walked.crossed / mesh.faces() >= plan.crossings_ahead;
}

// Pieces are sorted along the curve, so every so many-th are spread as all of them are. They are cut into parts anew:
// as few as they are, they want more parts than cleaning made of them.
Pieces chosen_of(runtime::Runtime& runtime, const Pieces& pieces, cl_uint step) {
  Pieces chosen;
  chosen.count = (pieces.count - 1) / step + 1;
  chosen.ends = runtime.allocate<cl_uint2>("pieces ahead", chosen.count);
  WalkedPieces& walked = chosen.walked;
  walked.located = false;
  walked.weights = runtime.allocate<cl_uint>("weights of pieces ahead", chosen.count);
  runtime.launch("parts", "parts_choose", over(chosen.count), chosen.count, step, pieces.ends, pieces.walked.weights,
                 chosen.ends, walked.weights);
  walked.crossed = total_weight(runtime, walked.weights, chosen.count);
  return chosen;
}

// The mesh has changed, so nobody knows where walks began, and that they are shorter.
void lighten(runtime::Runtime& runtime, Pieces& pieces, cl_uint times) {
  WalkedPieces& walked = pieces.walked;
  runtime.launch("parts", "parts_lighten", over(pieces.count), pieces.count, times, walked.weights);
  walked.parts = {};
  walked.faces = {};
  walked.located = false;
  walked.crossed /= times;
  walked.pool = 0;
}

// Pieces that were enforced ahead are edges when the rest is.
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

}  // namespace

// A vertex that many pieces end at has their edges now, so walks begin with its fan. If pieces cross, some that are
// edges already are crossed: the second time fails as it would have the first time, but in a changed mesh.
ConstrainResult constrain_in_turn(runtime::Runtime& runtime, Primitives& primitives, const Plan& plan,
                                  const Vertices& vertices, Mesh& mesh, History& history, Pieces& pieces,
                                  PhaseCounters& counters) {
  const auto enforce = [&](Pieces& some) {
    return constrain(runtime, primitives, plan, vertices, mesh, history, some, counters);
  };
  if (!pays(plan, vertices, mesh, pieces)) return enforce(pieces);
  Pieces chosen = chosen_of(runtime, pieces, plan.step_ahead);
  const ConstrainResult ahead = enforce(chosen);
  if (ahead.failed) return ahead;
  history = freeze_all(runtime, vertices, mesh, counters);
  history.fans = make_fans(runtime, primitives, vertices, mesh, counters);
  lighten(runtime, pieces, 2 * plan.step_ahead);
  ConstrainResult all = enforce(pieces);
  if (all.failed) {
    history = {};
    all.mesh_changed = true;
    return all;
  }
  add_ahead(ahead, all);
  return all;
}

}  // namespace gcdt

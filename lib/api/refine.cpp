// SPDX-License-Identifier: Apache-2.0
// The C interface: refinement of results.
#include "api/state.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

/// Of a result: its grid, its constraints and its domain are what they are.
Options read_own_options(const gcdt_options* given) {
  Options options = read_options(given);
  const bool own = options.crossing == Crossing::reject && !options.grid && options.domain == Domain::hull &&
                   !options.regions && !options.distinct && options.hole_seeds.empty() && options.region_seeds.empty();
  require(
      own,
      "a result has its grid, constraints and regions: gcdt_options.crossing, fixed_grid, domain, regions, distinct "
      "and seeds must be 0");
  require(!options.refine, "gcdt_options.refine must be null: what is wanted is an argument of its own");
  return options;
}

}  // namespace

int32_t gcdt_result_refine(gcdt_result* result, const gcdt_refinement* refine, const gcdt_options* options,
                           gcdt_result** refined) {
  return guarded_call(result, [&] {
    give_result(result->state, refined, [&] {
      Options wanted = read_own_options(options);
      wanted.refine = read_refinement(refine);
      return result->state->refine(result->data, wanted);
    });
  });
}

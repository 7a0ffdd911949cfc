// SPDX-License-Identifier: Apache-2.0
// A problem of a batch by itself, if its constraints cross and are to be split, or if it is to be refined, which a
// forest cannot do.
#pragma once

#include "batch/problems.hpp"

namespace gcdt {

/// Triangulates problem `number` of the batch as a solver would, but in canonical order whatever `options` say. The
/// result has that problem only, with the arrays of added vertices. Refinement::sizes are those of the batch's
/// vertices. Throws Error.
ForestResult triangulate_single(runtime::Runtime& runtime, Primitives& primitives, const BatchInput& batch,
                                std::uint32_t number, const Options& options);

}  // namespace gcdt

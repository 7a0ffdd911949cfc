// SPDX-License-Identifier: Apache-2.0
// A problem of a batch by itself, for what a forest cannot have: constraints that cross and are to be split.
#pragma once

#include "batch/forest.hpp"

namespace gcdt {

/// Triangulates problem `number` of the batch as a solver would, but in canonical order whatever `options` say. The
/// result has that problem only, with the arrays of added vertices. `runtime` builds for forests, before and after.
/// Throws Error.
ForestResult triangulate_alone(runtime::Runtime& runtime, Primitives& primitives, const BatchInput& batch,
                               std::uint32_t number, const Options& options);

}  // namespace gcdt

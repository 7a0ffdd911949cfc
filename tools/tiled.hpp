// SPDX-License-Identifier: Apache-2.0
// One problem on several devices, or on one that is too small for it: by a pool, in tiles.
#pragma once

#include "command.hpp"
#include "statistics.hpp"

namespace gcdt::command {

/// Whether the arguments ask for tiles, several devices, or less memory than there is.
bool wants_pool(const TriangulateArguments& arguments);

/// Triangulates on all devices that fit. Fills those statistics that a pool has, and the tiles of `measured`. Throws
/// Error.
Triangulation triangulate_on_pool(const io::Input& input, const TriangulateArguments& arguments, const Options& options,
                                  Trace trace, Measured& measured);

}  // namespace gcdt::command

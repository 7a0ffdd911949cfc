// SPDX-License-Identifier: Apache-2.0
// One problem on several devices, or on one that is too small for it: by a pool, in tiles.
#pragma once

#include <optional>

#include "command.hpp"
#include "io/mesh_arrays.hpp"
#include "statistics.hpp"

namespace gcdt::command {

/// Whether the arguments ask for tiles, several devices, or less memory than there is.
bool wants_pool(const TriangulateArguments& arguments);

/// What was made of an input. The arrays of a pool's result stay where the pool has made them.
struct Computed {
  Triangulation mesh;  ///< of a pool's without the arrays
  std::optional<BatchResult> of_pool;
  io::MeshArrays arrays() const { return of_pool ? io::MeshArrays(*of_pool, 0, mesh) : io::MeshArrays(mesh); }
};

/// Triangulates on all devices that fit. Fills those statistics that a pool has, and the tiles of `measured`. Throws
/// Error.
Computed triangulate_on_pool(const io::Input& input, const TriangulateArguments& arguments, const Options& options,
                             Trace trace, Measured& measured);

}  // namespace gcdt::command

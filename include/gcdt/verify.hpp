// SPDX-License-Identifier: Apache-2.0
// The independent proof of a result: exact host arithmetic, no device, no code shared with the pipeline.
#pragma once

#include <string>

#include <gcdt/gcdt.hpp>

namespace gcdt {

/// A mesh to be verified; triangle order and first corners are free.
struct MeshView {
  Span<std::array<std::uint32_t, 3>> triangles;
  const std::array<std::int32_t, 3>* neighbours = nullptr;  ///< one per triangle, or null: not checked
  const std::uint8_t* constrained = nullptr;                ///< one per triangle, or null: not checked
};

struct Verification {
  bool valid = false;
  std::string reason;  ///< of the first failure, naming vertices, triangles or constraints in input numbers
};

/// The grid that triangulate() chooses for `points` (or the fixed one), by host arithmetic.
/// Throws coordinate_not_finite or coordinate_outside_grid as triangulate() does.
GCDT_API Grid choose_grid(Points points, const std::optional<FixedGrid>& fixed = {});

/// Proves that `mesh` is the CDT of `points` and `constraints` on `grid`: every triangle
/// counter-clockwise, every link two-sided, the boundary closed and convex, every representative a
/// corner, every constraint of the input a chain of edges, every other edge locally Delaunay with
/// the tie rule. Under Crossing::drop it also proves that exactly the right constraints are missing.
/// Never throws on a bad mesh: an index that does not exist is a failed verification.
/// O((n + m) log n) expected; thread-safe.
GCDT_API Verification verify(Points points, Constraints constraints, const MeshView& mesh, const Grid& grid,
                             Crossing crossing = Crossing::reject);

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// The host's proof of a domain.
#pragma once

#include "proof/grid.hpp"

namespace gcdt::proof {

/// What is said of each triangle, or null: not verified. Region numbers are those of canonical order.
struct RegionView {
  const std::uint32_t *region = nullptr, *depth = nullptr;
  const std::int32_t* winding = nullptr;
};

/// As verify(), of a mesh from which options.domain has removed triangles. Takes crossing, domain and hole_seeds of
/// `options`. O((n + m) log n) for constraints that do not cross, expected, and log n times more for the worst of them
/// (complete.hpp). `steps`, if not null, is set to how many vertices, edges and triangles were looked at while
/// the whole mesh was made and seeds were located in it; all else sorts, searches sorted lists, or goes through the
/// mesh once.
Verification verify_domain(Points points, Constraints constraints, const MeshView& mesh, const RegionView& regions,
                           const Grid& grid, const Options& options, std::uint64_t* steps = nullptr);

}  // namespace gcdt::proof

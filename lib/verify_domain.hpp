// SPDX-License-Identifier: Apache-2.0
// The host's proof of a domain.
#pragma once

#include "verify_grid.hpp"

namespace gcdt::proof {

/// What is said of each triangle, or null: not verified. Region numbers are those of canonical order.
struct RegionView {
  const std::uint32_t *region = nullptr, *depth = nullptr;
  const std::int32_t* winding = nullptr;
};

/// As verify(), of a mesh from which options.domain has removed triangles. Takes crossing, domain and hole_seeds of
/// `options`.
Verification verify_domain(Points points, Constraints constraints, const MeshView& mesh, const RegionView& regions,
                           const Grid& grid, const Options& options);

}  // namespace gcdt::proof

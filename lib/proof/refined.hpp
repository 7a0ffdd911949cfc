// SPDX-License-Identifier: Apache-2.0
// The host's proof of a refined mesh, from the input and the mesh alone.
#pragma once

#include <cstdint>
#include <vector>

#include "proof/mending.hpp"

namespace gcdt::proof {

struct RefinedProof {
  std::string reason;                        ///< the first failure, or empty
  std::vector<Excuse> excuses;               ///< by triangle; empty after a failure
  std::uint64_t excused[excuse_kinds] = {};  ///< triangles
  std::uint64_t encroached = 0;              ///< if conforming: sides on chains with the corner across in their circle
  std::uint64_t refinements = 0;             ///< rows of added vertices in order of (x, y)
  std::uint64_t on_chains = 0, far = 0;      ///< added vertices on pieces, of these more than half a cell off
  double move = 0;                           ///< the largest distance of one, in cells
};

/// Proves that `mesh` is the refined domain of the input, as options.refine wants it; see gcdt_verify_refined. Takes of
/// `options` refine, crossing (not split), domain, hole_seeds and region_seeds.
RefinedProof verify_refined(Points points, Constraints constraints, const MeshView& mesh, const Grid& grid,
                            const Options& options);

}  // namespace gcdt::proof

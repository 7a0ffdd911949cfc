// SPDX-License-Identifier: Apache-2.0
// Regions and domains of a joined mesh, by the host (docs/domains.md).
#pragma once

#include "tiles/join.hpp"

namespace gcdt::tiles {

/// Labels the regions of `joined`, which covers the hull, and takes out the triangles that are not of the domain: what
/// select_domain() of phases/domain.hpp does on a device. Adds the arrays of regions, and statistics.
void select_domain(const GridInput& input, const Options& options, ForestResult& joined);

}  // namespace gcdt::tiles

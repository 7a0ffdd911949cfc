// SPDX-License-Identifier: Apache-2.0
// The oracle: CGAL's constrained Delaunay triangulation, with ties and order by docs/contract.md, 4 and 5.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace gcdt::reference {

/// The CDT's triangles in canonical order (docs/contract.md, 4 and 5): each starts with its first vertex in Z-order,
/// and they are sorted by the Z-order of their first, then second vertex. Points: distinct, in [0, 2^31 - 1].
/// Constraints may not cross; they are split at vertices on them; zero-length ones are ignored.
/// No triangles if all points are on one line. Throws std::runtime_error if a point is a duplicate.
std::vector<std::array<std::uint32_t, 3>> reference_cdt(const std::vector<std::array<std::int64_t, 2>>& points,
                                                        const std::vector<std::array<std::uint32_t, 2>>& constraints);

/// A mesh with everything that a MeshView names.
struct ReferenceMesh {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::int32_t, 3>> neighbours;
  std::vector<std::uint8_t> constrained;
};

/// As above, with neighbours and flags.
ReferenceMesh reference_mesh(const std::vector<std::array<std::int64_t, 2>>& points,
                             const std::vector<std::array<std::uint32_t, 2>>& constraints);

/// Morton code of a grid point: bit 2i is bit i of x, bit 2i + 1 is bit i of y.
std::uint64_t morton(std::array<std::int64_t, 2> point);

/// For triangles in any order and rotation: the neighbour across from each corner, or -1.
std::vector<std::array<std::int32_t, 3>> link(const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace gcdt::reference

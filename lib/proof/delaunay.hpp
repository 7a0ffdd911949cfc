// SPDX-License-Identifier: Apache-2.0
// The Delaunay triangulation of the sites, in exact host arithmetic, for the proof of domains: divide and conquer
// (Guibas and Stolfi 1985). Half-edges are numbered as in mesh.hpp.
#pragma once

#include <array>
#include <vector>

#include "proof/mesh.hpp"

namespace gcdt::proof {

/// > 0 if d is inside the circle through a, b, c (counter-clockwise), 0 on it.
Wide incircle(Vertex a, Vertex b, Vertex c, Vertex d);

/// The order that decides ties: x first.
inline bool before(Vertex a, Vertex b) { return a.key() < b.key(); }

/// Whether d is inside the circle of a, b, c (counter-clockwise) after the paraboloid over the plane was pushed down at
/// each vertex by an infinitely small length, at lesser vertices by infinitely more. Then no four vertices are
/// cocircular, and of four that were, the edge through the least is Delaunay: the rule of docs/contract.md, 4. False if
/// two vertices are the same.
bool inside_circle(const Sites& sites, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);

struct DelaunayMesh {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> twins;
};

/// Of the representatives, which are not all on one line. Takes O(n log n) whatever the sites are: they are sorted,
/// halved down to pairs, and merging two neighbouring halves looks at each edge that it makes or removes, and at those
/// along the common tangent, a constant number of times. `steps` grows by how often it looks.
DelaunayMesh delaunay(const Sites& sites, std::uint64_t& steps);

}  // namespace gcdt::proof

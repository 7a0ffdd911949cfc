// SPDX-License-Identifier: Apache-2.0
// The seam: what is left of the plane between the final triangles of all tiles, as one more problem.
#pragma once

#include "tiles/tile_mesh.hpp"

namespace gcdt::tiles {

/// An edge of a final triangle that no final triangle of its tile is across from, but the convex hull's: edge k of
/// `triangle` of `tile`.
struct BorderEdge {
  std::uint32_t tile, triangle, k;
};

/// A tile's mesh, and what of it is final.
struct SolvedTile {
  ProblemMesh mesh;
  std::vector<std::uint8_t> final;
};

/// The problem of the seam. Its constraints are, in this order: the border, each edge with the seam on its left; the
/// tiles' pieces that are not inside of final triangles; and the input constraints that no tile has.
struct Seam {
  std::vector<GridPoint> points;
  std::vector<std::uint32_t> ids;  ///< of the vertices: input numbers
  std::vector<Constraint> constraints;

  /// A tile's piece.
  struct Part {
    std::uint32_t tile, piece;
  };
  std::vector<BorderEdge> border;  ///< by tile, triangle and k
  std::vector<Part> parts;
  std::vector<std::uint32_t> open;  ///< input numbers, ascending
  std::size_t first_part() const { return border.size(); }
  std::size_t first_open() const { return border.size() + parts.size(); }
  /// The input constraints that a constraint of the seam stands for; none for the border.
  std::vector<std::uint32_t> sources_of(std::size_t constraint, const Partition& all,
                                        const std::vector<SolvedTile>& tiles) const;
};

Seam make_seam(const GridInput& input, const Partition& all, const std::vector<SolvedTile>& tiles);

/// The mesh of the seam's problem, and which of its triangles are of the seam. `border` is the number of the border
/// edge that a triangle of the seam has there, or -1; `inner`, the number of the mesh's piece that stands for input
/// constraints there, or -1.
struct SolvedSeam {
  ProblemMesh mesh;
  std::vector<std::uint8_t> kept;
  std::vector<Neighbours> border, inner;
};

/// Throws check_failed if the border does not part what is of the seam from the rest.
SolvedSeam take_seam(const Seam& seam, ProblemMesh mesh);

}  // namespace gcdt::tiles

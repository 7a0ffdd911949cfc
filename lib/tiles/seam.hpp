// SPDX-License-Identifier: Apache-2.0
// The seam: what is left of the plane between the final triangles of all tiles, as one more problem.
#pragma once

#include "tiles/tile.hpp"

namespace gcdt::tiles {

/// A view of the arrays of a result of one problem, which must outlive it.
struct ProblemMesh {
  ProblemMesh() = default;
  explicit ProblemMesh(const ForestResult& made);
  /// Throws check_failed if a number is none of a vertex, of a constraint, of a triangle: anything else may be wrong.
  void check(std::size_t vertices, std::size_t constraints) const;

  Span<Triangle> triangles;
  Span<Neighbours> neighbours;
  Span<std::uint8_t> constrained;
  Span<Constraint> pieces;
  Span<std::uint32_t> source_offsets, sources;
};

[[noreturn]] inline void throw_no_piece() {
  throw Error(Status::check_failed, "tiles: a constrained edge is no piece");
}

/// The number of a piece among some, which are in the order of their ends' codes; their number if it is not among them.
/// `point(v)`: vertex v on the grid.
template <class PointOf>
std::uint32_t piece_among(Span<Constraint> pieces, PointOf&& point, const Constraint& wanted) {
  const auto key = [&](const Constraint& ends) {
    return std::make_pair(code_of(point(ends[0])), code_of(point(ends[1])));
  };
  const auto wanted_key = key(wanted);
  const auto found = std::lower_bound(pieces.begin(), pieces.end(), wanted,
                                      [&](const Constraint& a, const Constraint&) { return key(a) < wanted_key; });
  return static_cast<std::uint32_t>((found == pieces.end() || *found != wanted ? pieces.end() : found) -
                                    pieces.begin());
}

/// The number of the piece between two vertices. Throws check_failed if there is none.
template <class PointOf>
std::uint32_t piece_between(Span<Constraint> pieces, PointOf&& point, std::uint32_t u, std::uint32_t v) {
  const bool in_order = code_of(point(u)) < code_of(point(v));
  const std::uint32_t found = piece_among(pieces, point, in_order ? Constraint{u, v} : Constraint{v, u});
  if (found == pieces.size()) throw_no_piece();
  return found;
}

/// The problem of the seam. Its vertices come tile by tile. Its constraints are, in this order: the border, each edge
/// with the seam on its left; the tiles' pieces that no final triangle has; and the input constraints that no tile has.
struct Seam {
  GridPoints points;
  std::vector<std::uint32_t> ids;     ///< of the vertices: input numbers
  std::vector<std::uint32_t> firsts;  ///< of each tile's vertices, and of all
  Array<Constraint> constraints;

  struct Border {
    std::uint32_t tile;
    BorderEdge edge;
  };
  /// A tile's piece.
  struct Part {
    std::uint32_t tile, piece;
  };
  std::vector<Border> border;  ///< by tile, triangle and k
  std::vector<Part> parts;
  std::vector<std::uint32_t> open;    ///< input numbers, ascending
  std::uint64_t tile_hull_edges = 0;  ///< edges of final triangles that are on the hull of their tile
  std::size_t first_part() const { return border.size(); }
  std::size_t first_open() const { return border.size() + parts.size(); }
  std::size_t tile_of(std::uint32_t vertex) const {
    return static_cast<std::size_t>(std::upper_bound(firsts.begin(), firsts.end(), vertex) - firsts.begin()) - 1;
  }
  /// Calls use(c) for the input constraints that a constraint of the seam stands for; none for the border.
  template <class Use>
  void for_sources(std::size_t constraint, const std::vector<SolvedTile>& tiles, Use&& use) const {
    if (constraint < first_part()) return;
    if (constraint >= first_open()) return use(open[constraint - first_open()]);
    const auto& [tile, piece] = parts[constraint - first_part()];
    for (const std::uint32_t c : tiles[tile].sources_of(piece)) use(c);
  }
  /// The same as a list.
  std::vector<std::uint32_t> sources_of(std::size_t constraint, const std::vector<SolvedTile>& tiles) const;
};

/// `open`: by ascending number.
Seam make_seam(const Cuts& cuts, const std::vector<OpenConstraint>& open, const std::vector<SolvedTile>& tiles);

/// The mesh of the seam's problem, and which of its triangles are of the seam. It is the arrays of the problem's
/// result, changed: flags tell of input constraints alone, and neighbours of triangles across the border are gone.
struct SolvedSeam {
  ProblemMesh mesh;
  std::vector<std::uint8_t> kept;  ///< by triangle

  /// In place of the number of a neighbour, where an edge of the border is between.
  static std::int32_t beyond(std::uint32_t border) { return -2 - static_cast<std::int32_t>(border); }
  /// The number of the border's edge that triangle t has across from corner k, or -1.
  std::int32_t border_at(std::size_t t, std::size_t k) const {
    const std::int32_t other = mesh.neighbours[t][k];
    return other < -1 ? -2 - other : -1;
  }
};

/// `neighbours` and `constrained` are the mesh's own arrays. Throws check_failed if numbers in the mesh name what is
/// not there, or the border does not part what is of the seam from the rest.
SolvedSeam take_seam(const Seam& seam, ProblemMesh mesh, Neighbours* neighbours, std::uint8_t* constrained);

}  // namespace gcdt::tiles

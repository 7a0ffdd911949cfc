// SPDX-License-Identifier: Apache-2.0
// One tile on one device: its mesh, what of it is final, and what the seam gets of it (docs/scale.md).
#pragma once

#include "tiles/final.hpp"
#include "tiles/share_out.hpp"
#include "tiles/tiles.h"

namespace gcdt::tiles {

/// A vertex of a tile that the seam has.
struct SeamVertex {
  std::uint32_t vertex, id;  ///< the tile's number, and the input's
  GridPoint point;
};

/// An edge of a final triangle without a final neighbour in its tile, across from corner k, counter-clockwise.
struct BorderEdge {
  std::uint32_t triangle;  ///< its number among the final ones
  std::uint32_t from, to;  ///< the tile's vertices
  std::uint32_t k_and_marks;
  std::uint32_t k() const { return k_and_marks & 3u; }
  bool is_constrained() const { return (k_and_marks & GCDT_TILE_CONSTRAINED) != 0; }
  bool is_on_hull() const { return (k_and_marks & GCDT_TILE_ON_HULL) != 0; }  ///< of the tile
};

/// A constraint that a tile has dropped, as input numbers.
struct Dropped {
  std::uint32_t number;
  Constraint ends;
};

/// What became of a tile. Vertices are numbered as in kernels/tiles/tiles.cl.
struct SolvedTile {
  std::uint32_t own = 0;  ///< vertices of its own; without any it has nothing else
  Box box{};              ///< around these
  // Until the seam's problem is made (leave_seam()).
  /// Its own vertices that are corners of triangles that are not final, or all that stand for some if it has no
  /// triangles; and those of border edges on its hull. Both ascend by number.
  std::vector<SeamVertex> vertices, hull_vertices;
  std::vector<BorderEdge> border;  ///< by triangle and k; also edges that turn out to be of the hull of all
  // Its pieces that no final triangle has, in Z-order: the seam's.
  Array<Constraint> pieces;                      ///< the tile's vertices
  Array<std::uint32_t> source_offsets, sources;  ///< input numbers; no offsets: each piece has one source
  std::vector<Dropped> dropped;                  ///< by ascending number
  std::vector<Constraint> merged;                ///< input numbers: vertices, and what stands for them
  std::vector<std::uint32_t> ends, stand_ins;    ///< open ends by input number, ascending; the tile's vertices
  std::uint64_t move_key = 0;                    ///< the greatest of its own vertices
  FinalTriangles final;                          ///< with the other pieces
  std::size_t device = 0;                        ///< of the pool: who has `final`, unless it is spilled

  Span<std::uint32_t> sources_of(std::size_t piece) const {
    if (source_offsets.empty()) return {&sources[piece], 1};
    return {sources.data() + source_offsets[piece], source_offsets[piece + 1] - std::size_t{source_offsets[piece]}};
  }
  /// Gives back what the seam's problem has been made of, and nothing else needs.
  void leave_seam() { forget(vertices), forget(hull_vertices), forget(border), forget(ends), forget(stand_ins); }
};

/// What all tiles of a run share.
struct TileTask {
  const GridInput& input;
  Staged& staged;  ///< the input's vertices, but those that were added
  const Cuts& cuts;
  bool check;
  StagedConstraints* constraints = nullptr;  ///< null: each tile's share has its own
};

/// Takes the tile's vertices from the input, triangulates them with its constraints, dropping what crosses, and finds
/// out what is final. Throws Error as triangulate() does.
SolvedTile solve_tile(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile);

}  // namespace gcdt::tiles

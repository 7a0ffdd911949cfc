// SPDX-License-Identifier: Apache-2.0
#include "tiles/seam.hpp"

#include "tiles/indices.hpp"

namespace gcdt::tiles {

namespace {

template <class T>
Span<T> view_of(const ForestResult& made, std::int32_t array) {
  const auto slot = static_cast<std::size_t>(array);
  if (made.begins[slot].empty()) return {};
  return {reinterpret_cast<const T*>(made.arrays[slot].bytes.get()),
          static_cast<std::size_t>(made.begins[slot].back())};
}

Constraint edge_of(const Triangle& t, std::uint32_t k) { return {t[(k + 1) % 3], t[(k + 2) % 3]}; }

/// What a tile gives to the seam, in the tile's numbers.
struct TileShare {
  std::vector<SeamVertex> vertices;  ///< by number
  std::vector<BorderEdge> border;    ///< but those of the hull of all
};

/// Whether all vertices of all other tiles are left of the edge of a tile's hull, or on its line: their boxes are.
bool is_hull_of_all(const std::vector<SolvedTile>& tiles, std::size_t tile, const GridPoint& a, const GridPoint& b) {
  for (std::size_t other = 0; other < tiles.size(); ++other) {
    if (other == tile || tiles[other].own == 0) continue;
    const Box& box = tiles[other].box;
    for (const std::int64_t x : {box.least[0], box.most[0]})
      for (const std::int64_t y : {box.least[1], box.most[1]})
        if (orient2d(a, b, {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)}) < 0) return false;
  }
  return true;
}

constexpr auto by_number = [](const SeamVertex& a, const SeamVertex& b) { return a.vertex < b.vertex; };

TileShare share_of(const std::vector<SolvedTile>& tiles, std::size_t t) {
  const SolvedTile& tile = tiles[t];
  TileShare share;
  std::vector<SeamVertex> ends;
  const auto end_at = [&](std::uint32_t v) {
    const auto& all = tile.hull_vertices;
    const auto found = std::lower_bound(all.begin(), all.end(), SeamVertex{v, 0, {}}, by_number);
    if (found == all.end() || found->vertex != v) refuse("an end of an edge of a tile's hull is not known");
    return *found;
  };
  for (const BorderEdge& edge : tile.border) {
    if (edge.is_on_hull()) {
      const SeamVertex from = end_at(edge.from), to = end_at(edge.to);
      if (is_hull_of_all(tiles, t, from.point, to.point)) continue;
      ends.insert(ends.end(), {from, to});
    }
    share.border.push_back(edge);
  }
  std::sort(ends.begin(), ends.end(), by_number);
  ends.erase(std::unique(ends.begin(), ends.end(), [](const auto& a, const auto& b) { return a.vertex == b.vertex; }),
             ends.end());
  std::set_union(tile.vertices.begin(), tile.vertices.end(), ends.begin(), ends.end(),
                 std::back_inserter(share.vertices), by_number);
  return share;
}

/// The seam's number of a tile's vertex, by a table of hashes a tile: searches in a list would be most of what making
/// the seam takes.
class SeamNumbers {
 public:
  SeamNumbers(const std::vector<TileShare>& shares, const std::vector<std::uint32_t>& firsts)
      : shares_(shares), firsts_(firsts), tables_(shares.size()) {
    for_each_in_threads(
        shares.size(), [&](std::size_t t) { fill(tables_[t], shares[t].vertices); }, 1);
  }
  // Ends: a table has twice as many slots as entries.
  std::uint32_t of(std::size_t tile, std::uint32_t v) const {
    const std::vector<std::uint32_t>& table = tables_[tile];
    for (std::size_t slot = slot_of(table, v); table[slot] != empty; slot = next(table, slot))
      if (shares_[tile].vertices[table[slot]].vertex == v) return firsts_[tile] + table[slot];
    throw Error(Status::check_failed, "tiles: an end of a constraint of the seam is not in the seam");
  }

 private:
  static constexpr std::uint32_t empty = ~std::uint32_t{0};

  static void fill(std::vector<std::uint32_t>& table, const std::vector<SeamVertex>& vertices) {
    std::size_t size = 2;
    while (size < 2 * vertices.size()) size *= 2;
    table.assign(size, empty);
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
      std::size_t slot = slot_of(table, vertices[i].vertex);
      while (table[slot] != empty) slot = next(table, slot);
      table[slot] = i;
    }
  }
  // Knuth's multiplicative hash, of which the high bits are the good ones.
  static std::size_t slot_of(const std::vector<std::uint32_t>& table, std::uint32_t v) {
    return (std::uint64_t{v * 2654435769u} * table.size()) >> 32;
  }
  static std::size_t next(const std::vector<std::uint32_t>& table, std::size_t slot) {
    return slot + 1 < table.size() ? slot + 1 : 0;
  }

  const std::vector<TileShare>& shares_;
  const std::vector<std::uint32_t>& firsts_;
  std::vector<std::vector<std::uint32_t>> tables_;  ///< places in a share's vertices
};

/// The pieces by their first ends, in the order of whose codes they come.
class PiecesByEnd {
 public:
  /// Ends are below `vertices`.
  PiecesByEnd(Span<Constraint> pieces, std::size_t vertices) : pieces_(pieces), ranges_(vertices, {0, 0}) {
    for (std::uint32_t i = 0, first = 0; i < pieces.size(); ++i) {
      if (pieces[i][0] != pieces[first][0]) first = i;
      ranges_[pieces[i][0]] = {first, i + 1};
    }
  }
  /// The number of the piece between two vertices; `point(v)`: vertex v on the grid. Throws check_failed if there is
  /// none.
  template <class PointOf>
  std::uint32_t between(std::uint32_t u, std::uint32_t v, PointOf&& point) const {
    for (const Constraint& ends : {Constraint{u, v}, Constraint{v, u}}) {
      const auto [first, end] = ranges_[ends[0]];
      const std::uint32_t found = first + piece_among({pieces_.data() + first, end - first}, point, ends);
      if (found < end) return found;
    }
    throw_no_piece();
  }

 private:
  Span<Constraint> pieces_;
  std::vector<std::array<std::uint32_t, 2>> ranges_;  ///< by vertex: of the pieces that begin there
};

/// The tile's vertex that stands for an end of an open constraint.
std::uint32_t stand_in(const SolvedTile& tile, std::uint32_t end) {
  const auto found = std::lower_bound(tile.ends.begin(), tile.ends.end(), end);
  if (found == tile.ends.end() || *found != end)
    throw Error(Status::check_failed, "tiles: a tile does not know the end of an open constraint");
  return tile.stand_ins[static_cast<std::size_t>(found - tile.ends.begin())];
}

/// Adds the constraints that no tile has, with those that tiles have dropped.
void add_open(Seam& seam, const Cuts& cuts, const std::vector<OpenConstraint>& open,
              const std::vector<SolvedTile>& tiles, const SeamNumbers& numbers) {
  struct Numbered {
    std::uint32_t number;
    Constraint ends;  ///< in the seam
  };
  std::vector<Numbered> all;
  for (const OpenConstraint& constraint : open) {
    Constraint ends;
    for (std::size_t end = 0; end < 2; ++end) {
      const std::size_t t = cuts.tile_of(code_of(constraint.points[end]));
      ends[end] = numbers.of(t, stand_in(tiles[t], constraint.ends[end]));
    }
    all.push_back({constraint.number, ends});
  }
  for (std::size_t t = 0; t < tiles.size(); ++t)
    for (const Dropped& constraint : tiles[t].dropped) {
      const auto number = [&](std::uint32_t end) { return numbers.of(t, stand_in(tiles[t], end)); };
      all.push_back({constraint.number, {number(constraint.ends[0]), number(constraint.ends[1])}});
    }
  std::stable_sort(all.begin(), all.end(), [](const Numbered& a, const Numbered& b) { return a.number < b.number; });
  for (const Numbered& constraint : all) {
    seam.open.push_back(constraint.number);
    seam.constraints.push_back(constraint.ends);
  }
}

}  // namespace

ProblemMesh::ProblemMesh(const ForestResult& made)
    : triangles(view_of<Triangle>(made, GCDT_TRIANGLES)),
      neighbours(view_of<Neighbours>(made, GCDT_NEIGHBOURS)),
      constrained(view_of<std::uint8_t>(made, GCDT_CONSTRAINED)),
      pieces(view_of<Constraint>(made, GCDT_PIECES)),
      source_offsets(view_of<std::uint32_t>(made, GCDT_SOURCE_OFFSETS)),
      sources(view_of<std::uint32_t>(made, GCDT_SOURCES)) {}

std::vector<std::uint32_t> Seam::sources_of(std::size_t constraint, const std::vector<SolvedTile>& tiles) const {
  std::vector<std::uint32_t> sources;
  for_sources(constraint, tiles, [&](std::uint32_t c) { sources.push_back(c); });
  return sources;
}

Seam make_seam(const Cuts& cuts, const std::vector<OpenConstraint>& open, const std::vector<SolvedTile>& tiles) {
  std::vector<TileShare> shares(tiles.size());
  for_each_in_threads(
      tiles.size(), [&](std::size_t t) { shares[t] = share_of(tiles, t); }, 1);
  Seam seam;
  std::size_t vertices = 0, border = 0, parts = 0;
  for (const TileShare& share : shares) vertices += share.vertices.size(), border += share.border.size();
  for (const SolvedTile& tile : tiles) parts += tile.pieces.size();
  seam.points.reserve(vertices), seam.ids.reserve(vertices), seam.border.reserve(border), seam.parts.reserve(parts);
  for (const TileShare& share : shares) {
    seam.firsts.push_back(static_cast<std::uint32_t>(seam.ids.size()));
    for (const SeamVertex& v : share.vertices) seam.points.push_back(v.point), seam.ids.push_back(v.id);
  }
  seam.firsts.push_back(static_cast<std::uint32_t>(seam.ids.size()));
  const SeamNumbers numbers(shares, seam.firsts);
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    for (const BorderEdge& edge : shares[t].border) seam.border.push_back({t, edge});
    for (const BorderEdge& edge : tiles[t].border) seam.tile_hull_edges += edge.is_on_hull();
  }
  for (std::uint32_t t = 0; t < tiles.size(); ++t)
    for (std::uint32_t p = 0; p < tiles[t].pieces.size(); ++p) seam.parts.push_back({t, p});
  seam.constraints.resize(seam.first_open());
  for_each_in_threads(seam.first_open(), [&](std::size_t c) {
    if (c < seam.first_part()) {
      const auto& [t, edge] = seam.border[c];
      seam.constraints[c] = {numbers.of(t, edge.to), numbers.of(t, edge.from)};
    } else {
      const auto& [t, p] = seam.parts[c - seam.first_part()];
      const Constraint& ends = tiles[t].pieces[p];
      seam.constraints[c] = {numbers.of(t, ends[0]), numbers.of(t, ends[1])};
    }
  });
  add_open(seam, cuts, open, tiles, numbers);
  return seam;
}

void ProblemMesh::check(std::size_t vertices, std::size_t constraints) const {
  const auto count = static_cast<std::int64_t>(triangles.size());
  if (neighbours.size() != triangles.size() || constrained.size() != triangles.size())
    refuse("the seam's mesh is not whole");
  check_each(triangles.size(), "a triangle of the seam has a corner or a neighbour that is not there",
             [&](std::size_t t) {
               bool fits = true;
               for (std::size_t k = 0; k < 3; ++k)
                 fits = fits && triangles[t][k] < vertices && neighbours[t][k] >= -1 && neighbours[t][k] < count;
               return fits;
             });
  check_ends_below(pieces, vertices, "the end of a piece is no vertex of the seam");
  check_offsets(source_offsets, pieces.size(), sources.size(), "the sources of a piece of the seam are not there");
  check_below(sources, constraints, "a source of a piece is no constraint of the seam");
}

SolvedSeam take_seam(const Seam& seam, ProblemMesh mesh, Neighbours* neighbours, std::uint8_t* constrained) {
  mesh.check(seam.points.size(), seam.constraints.size());
  SolvedSeam solved;
  const std::size_t count = mesh.triangles.size();
  std::vector<std::uint8_t> outside(count, 0);
  const PiecesByEnd pieces(mesh.pieces, seam.points.size());
  solved.kept.assign(count, seam.border.empty() ? 1 : 0);
  const auto point = [&](std::uint32_t v) { return seam.points[v]; };
  for_each_in_threads(count, [&](std::size_t t) {
    std::uint8_t flags = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if ((constrained[t] >> k & 1) == 0) continue;
      const Constraint edge = edge_of(mesh.triangles[t], k);
      const std::uint32_t piece = pieces.between(edge[0], edge[1], point);
      for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i) {
        const std::uint32_t source = mesh.sources[i];
        const bool is_border = source < seam.first_part();
        if (!is_border || seam.border[source].edge.is_constrained()) flags |= static_cast<std::uint8_t>(1u << k);
        if (!is_border) continue;
        neighbours[t][k] = SolvedSeam::beyond(source);
        (seam.constraints[source] == edge ? solved.kept : outside)[t] = 1;
      }
    }
    constrained[t] = flags;
  });
  std::vector<std::uint32_t> reached;
  for (std::uint32_t t = 0; t < count; ++t)
    if (solved.kept[t]) reached.push_back(t);
  // Ends: every triangle is reached once.
  while (!reached.empty()) {
    const std::uint32_t t = reached.back();
    reached.pop_back();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::int32_t other = mesh.neighbours[t][k];
      if (other < 0 || solved.kept[static_cast<std::uint32_t>(other)]) continue;
      solved.kept[static_cast<std::uint32_t>(other)] = 1;
      reached.push_back(static_cast<std::uint32_t>(other));
    }
  }
  for (std::size_t t = 0; t < count; ++t)
    if (outside[t] && solved.kept[t])
      throw Error(Status::check_failed, "tiles: the border of the final triangles is not closed in the seam");
  solved.mesh = mesh;
  return solved;
}

}  // namespace gcdt::tiles

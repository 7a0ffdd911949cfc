// SPDX-License-Identifier: Apache-2.0
#include "tiles/seam.hpp"

#include "tiles/parts.hpp"

namespace gcdt::tiles {

namespace {

Constraint edge_of(const ProblemMesh& mesh, std::uint32_t triangle, std::uint32_t k) {
  const Triangle& t = mesh.triangles[triangle];
  return {t[(k + 1) % 3], t[(k + 2) % 3]};
}

bool constrained(const ProblemMesh& mesh, std::uint32_t triangle, std::uint32_t k) {
  return (mesh.constrained[triangle] >> k & 1) != 0;
}

/// One tile's share of the seam, in the tile's numbers.
class TileShare {
 public:
  TileShare(const Partition& all, const SolvedTile& solved, std::uint32_t tile)
      : all_(all), given_(all.tiles[tile]), mesh_(solved.mesh), final_(solved.final), tile_(tile) {}

  void gather() {
    wanted_.assign(given_.own, 0);
    if (mesh_.triangles.empty()) return take_all();
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) final_[t] ? look_at_final(t) : look_at_other(t);
    std::sort(parts.begin(), parts.end());
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    list_vertices();
  }

  std::vector<std::uint32_t> vertices, parts;  ///< ascending
  std::vector<BorderEdge> border;

 private:
  /// Fewer than three vertices, or all on one line.
  void take_all() {
    for (std::uint32_t v = 0; v < given_.own; ++v) wanted_[v] = mesh_.representative[v] == v;
    for (std::uint32_t p = 0; p < mesh_.pieces.size(); ++p) parts.push_back(p);
    list_vertices();
  }

  void look_at_final(std::uint32_t t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::int32_t other = mesh_.neighbours[t][k];
      const auto [u, v] = edge_of(mesh_, t, k);
      if (other >= 0 ? final_[static_cast<std::uint32_t>(other)] != 0 : is_hull_of_all(u, v)) continue;
      border.push_back({tile_, t, k});
      wanted_[u] = wanted_[v] = 1;
      if (constrained(mesh_, t, k)) parts.push_back(piece_between(mesh_.pieces, given_.points, u, v));
    }
  }

  void look_at_other(std::uint32_t t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (const std::uint32_t v = mesh_.triangles[t][k]; v < given_.own) wanted_[v] = 1;
      if (!constrained(mesh_, t, k)) continue;
      const auto [u, v] = edge_of(mesh_, t, k);
      parts.push_back(piece_between(mesh_.pieces, given_.points, u, v));
    }
  }

  /// Whether all vertices of all other tiles are left of the edge of the tile's hull, or on its line: their boxes are.
  bool is_hull_of_all(std::uint32_t u, std::uint32_t v) const {
    const GridPoint &a = given_.points[u], &b = given_.points[v];
    for (std::uint32_t other = 0; other < all_.tiles.size(); ++other) {
      if (other == tile_ || all_.tiles[other].own == 0) continue;
      const Box& box = all_.tiles[other].box;
      for (const std::int64_t x : {box.least[0], box.most[0]})
        for (const std::int64_t y : {box.least[1], box.most[1]})
          if (orient2d(a, b, {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)}) < 0) return false;
    }
    return true;
  }

  void list_vertices() {
    for (std::uint32_t v = 0; v < given_.own; ++v)
      if (wanted_[v]) vertices.push_back(v);
  }

  const Partition& all_;
  const Tile& given_;
  const ProblemMesh& mesh_;
  const std::vector<std::uint8_t>& final_;
  std::uint32_t tile_;
  std::vector<std::uint8_t> wanted_;
};

/// The seam's number of each of a tile's vertices that are in the seam.
class SeamNumbers {
 public:
  SeamNumbers(const std::vector<TileShare>& shares) {
    std::uint32_t first = 0;
    for (const TileShare& share : shares) {
      shares_.push_back(&share.vertices);
      firsts_.push_back(first);
      first += static_cast<std::uint32_t>(share.vertices.size());
    }
  }
  std::uint32_t of(std::size_t tile, std::uint32_t v) const {
    const std::vector<std::uint32_t>& vertices = *shares_[tile];
    const auto found = std::lower_bound(vertices.begin(), vertices.end(), v);
    if (found == vertices.end() || *found != v)
      throw Error(Status::check_failed, "tiles: an end of a constraint of the seam is not in the seam");
    return firsts_[tile] + static_cast<std::uint32_t>(found - vertices.begin());
  }

 private:
  std::vector<const std::vector<std::uint32_t>*> shares_;
  std::vector<std::uint32_t> firsts_;
};

std::vector<std::uint32_t> open_constraints(const Partition& all, const std::vector<SolvedTile>& tiles) {
  std::vector<std::uint32_t> open = all.open;
  for (std::size_t t = 0; t < tiles.size(); ++t)
    for (const std::uint32_t c : tiles[t].mesh.dropped) open.push_back(all.tiles[t].constraint_ids[c]);
  std::sort(open.begin(), open.end());
  return open;
}

}  // namespace

std::vector<std::uint32_t> Seam::sources_of(std::size_t constraint, const Partition& all,
                                            const std::vector<SolvedTile>& tiles) const {
  if (constraint < first_part()) return {};
  if (constraint >= first_open()) return {open[constraint - first_open()]};
  const auto& [tile, piece] = parts[constraint - first_part()];
  const ProblemMesh& mesh = tiles[tile].mesh;
  std::vector<std::uint32_t> sources;
  for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i)
    sources.push_back(all.tiles[tile].constraint_ids[mesh.sources[i]]);
  return sources;
}

Seam make_seam(const GridInput& input, const Partition& all, const std::vector<SolvedTile>& tiles) {
  std::vector<TileShare> shares;
  for (std::uint32_t t = 0; t < tiles.size(); ++t) shares.emplace_back(all, tiles[t], t);
  for_each_in_threads(
      tiles.size(), [&](std::size_t t) { shares[t].gather(); }, 1);
  Seam seam;
  const SeamNumbers numbers(shares);
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    const Tile& given = all.tiles[t];
    for (const std::uint32_t v : shares[t].vertices) {
      seam.points.push_back(given.points[v]);
      seam.ids.push_back(given.ids[v]);
    }
    for (const BorderEdge& edge : shares[t].border) {
      const auto [u, v] = edge_of(tiles[t].mesh, edge.triangle, edge.k);
      seam.constraints.push_back({numbers.of(t, v), numbers.of(t, u)});
      seam.border.push_back(edge);
    }
  }
  for (std::uint32_t t = 0; t < tiles.size(); ++t)
    for (const std::uint32_t piece : shares[t].parts) {
      const Constraint& ends = tiles[t].mesh.pieces[piece];
      seam.constraints.push_back({numbers.of(t, ends[0]), numbers.of(t, ends[1])});
      seam.parts.push_back({t, piece});
    }
  seam.open = open_constraints(all, tiles);
  const auto number = [&](std::uint32_t end) {
    const std::size_t t = all.tile_of[end];
    return numbers.of(t, tiles[t].mesh.representative[all.place[end]]);
  };
  for (const std::uint32_t c : seam.open)
    seam.constraints.push_back({number(input.constraints[c][0]), number(input.constraints[c][1])});
  return seam;
}

SolvedSeam take_seam(const Seam& seam, ProblemMesh mesh) {
  SolvedSeam solved;
  const std::size_t count = mesh.triangles.size();
  solved.border.assign(count, {-1, -1, -1});
  solved.inner.assign(count, {-1, -1, -1});
  std::vector<std::uint8_t> outside(count, 0);
  solved.kept.assign(count, seam.border.empty() ? 1 : 0);
  std::vector<std::uint32_t> reached;
  for (std::uint32_t t = 0; t < count; ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (!constrained(mesh, t, k)) continue;
      const Constraint edge = edge_of(mesh, t, k);
      const std::uint32_t piece = piece_between(mesh.pieces, seam.points, edge[0], edge[1]);
      for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i) {
        const std::uint32_t source = mesh.sources[i];
        if (source >= seam.first_part()) {
          solved.inner[t][k] = static_cast<std::int32_t>(piece);
        } else if (solved.border[t][k] = static_cast<std::int32_t>(source); seam.constraints[source] != edge) {
          outside[t] = 1;
        } else if (!solved.kept[t]) {
          solved.kept[t] = 1;
          reached.push_back(t);
        }
      }
    }
  // Ends: every triangle is reached once.
  while (!reached.empty()) {
    const std::uint32_t t = reached.back();
    reached.pop_back();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::int32_t other = mesh.neighbours[t][k];
      if (other < 0 || solved.border[t][k] >= 0 || solved.kept[static_cast<std::uint32_t>(other)]) continue;
      solved.kept[static_cast<std::uint32_t>(other)] = 1;
      reached.push_back(static_cast<std::uint32_t>(other));
    }
  }
  for (std::size_t t = 0; t < count; ++t)
    if (outside[t] && solved.kept[t])
      throw Error(Status::check_failed, "tiles: the border of the final triangles is not closed in the seam");
  solved.mesh = std::move(mesh);
  return solved;
}

}  // namespace gcdt::tiles

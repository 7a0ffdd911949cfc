// SPDX-License-Identifier: Apache-2.0
#include "tiles/join.hpp"

#include <limits>
#include <numeric>

#include "tiles/parts.hpp"

namespace gcdt::tiles {

namespace {

using Key = std::pair<std::uint64_t, std::uint64_t>;  // of a piece: the codes of its ends

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Writes what the tiles could not know: the seam's triangles, and on both sides of the border who is across.
class SeamWriter {
 public:
  SeamWriter(const Solved& solved, const Order& order, ForestResult& result)
      : solved_(solved),
        order_(order),
        triangles_(elements_of<Triangle>(result, GCDT_TRIANGLES)),
        neighbours_(elements_of<Neighbours>(result, GCDT_NEIGHBOURS)),
        constrained_(elements_of<std::uint8_t>(result, GCDT_CONSTRAINED)) {}

  void write() {
    for_each_in_threads(solved_.between.kept.size(), [&](std::size_t t) {
      if (solved_.between.kept[t]) write_triangle(static_cast<std::uint32_t>(t));
    });
  }

 private:
  // No two of the seam's triangles are across from one side of a final triangle.
  void write_triangle(std::uint32_t t) {
    const SolvedSeam& from = solved_.between;
    const std::uint32_t place = order_.place_in_seam(t);
    constrained_[place] = from.constrained[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      triangles_[place][k] = solved_.seam.ids[from.mesh.triangles[t][k]];
      const std::int32_t other = from.mesh.neighbours[t][k], border = from.border[t][k];
      std::int32_t& neighbour = neighbours_[place][k];
      if (border >= 0) {
        const auto& [tile, edge] = solved_.seam.border[static_cast<std::size_t>(border)];
        const std::uint32_t beyond = order_.place_of_final(tile, edge.triangle);
        neighbour = static_cast<std::int32_t>(beyond);
        neighbours_[beyond][edge.k()] = static_cast<std::int32_t>(place);
      } else {
        neighbour = other < 0 ? -1 : static_cast<std::int32_t>(order_.place_in_seam(static_cast<std::uint32_t>(other)));
      }
    }
  }

  const Solved& solved_;
  const Order& order_;
  Triangle* triangles_;
  Neighbours* neighbours_;
  std::uint8_t* constrained_;
};

/// The pieces of the result, in Z-order of their ends: those that the tiles keep, and those of the seam. Both are in
/// that order, so parts of the tiles' pieces are merged with those of the seam that lie between, each by a thread.
class PieceWriter {
 public:
  explicit PieceWriter(const Solved& solved) : solved_(solved), seam_(solved.between.mesh) {}

  void write(ForestResult& result) {
    std::vector<Merged> parts;
    for (const Range& range : ranges()) parts.push_back({range, {}, {}, {}});
    for_each_in_threads(
        parts.size(), [&](std::size_t i) { merge(parts[i]); }, 1);
    std::vector<std::array<std::size_t, 2>> before(parts.size() + 1, {0, 0});  // pieces and sources
    for (std::size_t i = 0; i < parts.size(); ++i)
      before[i + 1] = {before[i][0] + parts[i].ends.size(), before[i][1] + parts[i].sources.size()};
    auto* ends = room<Constraint>(result, GCDT_PIECES, before.back()[0]);
    auto* offsets = room<std::uint32_t>(result, GCDT_SOURCE_OFFSETS, before.back()[0] + 1);
    auto* sources = room<std::uint32_t>(result, GCDT_SOURCES, before.back()[1]);
    for_each_in_threads(
        parts.size(),
        [&](std::size_t i) {
          std::copy(parts[i].ends.begin(), parts[i].ends.end(), ends + before[i][0]);
          std::copy(parts[i].sources.begin(), parts[i].sources.end(), sources + before[i][1]);
          for (std::size_t p = 0; p < parts[i].begins.size(); ++p)
            offsets[before[i][0] + p] = static_cast<std::uint32_t>(before[i][1] + parts[i].begins[p]);
        },
        1);
    offsets[before.back()[0]] = static_cast<std::uint32_t>(before.back()[1]);
  }

 private:
  /// Pieces of a tile, and pieces of the seam.
  struct Range {
    std::uint32_t tile, first, end, first_of_seam, end_of_seam;
  };
  struct Merged {
    Range range;
    std::vector<Constraint> ends;
    std::vector<std::uint32_t> begins, sources;
  };

  std::vector<Range> ranges() const {
    constexpr std::size_t of_part = 1u << 15;
    std::vector<Range> all;
    const auto pieces = static_cast<std::uint32_t>(seam_.pieces.size());
    for (std::uint32_t t = 0; t < solved_.tiles.size(); ++t) {
      const std::size_t count = solved_.tiles[t].pieces.size(), parts = count / of_part + 1;
      for (std::size_t i = 0; i < parts; ++i) {
        const auto first = static_cast<std::uint32_t>(count * i / parts),
                   end = static_cast<std::uint32_t>(count * (i + 1) / parts);
        if (first == end) continue;
        const std::uint32_t of_seam = all.empty() ? 0 : of_seam_before(solved_.tiles[t].piece_ids[first]);
        if (!all.empty()) all.back().end_of_seam = of_seam;
        all.push_back({t, first, end, of_seam, pieces});
      }
    }
    if (all.empty()) all.push_back({0, 0, 0, 0, pieces});
    return all;
  }

  /// How many pieces of the seam come before a piece of a tile.
  std::uint32_t of_seam_before(const Constraint& ends) const {
    const Key key = key_of_input(ends);
    std::uint32_t low = 0, high = static_cast<std::uint32_t>(seam_.pieces.size());
    while (low < high) {  // ends: the range halves
      const std::uint32_t middle = low + (high - low) / 2;
      (key_of_seam(middle) < key ? low : high) = key_of_seam(middle) < key ? middle + 1 : middle;
    }
    return low;
  }

  void merge(Merged& part) const {
    const Range& range = part.range;
    const SolvedTile& tile = solved_.tiles[range.tile];
    std::uint32_t next = range.first_of_seam;
    for (std::uint32_t piece = range.first; piece < range.end; ++piece) {
      if (tile.kept[piece] == 0) continue;
      if (next < range.end_of_seam) {
        const Key here = key_of_input(tile.piece_ids[piece]);
        while (next < range.end_of_seam && key_of_seam(next) < here) add_of_seam(next++, part);
      }
      part.ends.push_back(tile.piece_ids[piece]);
      part.begins.push_back(static_cast<std::uint32_t>(part.sources.size()));
      part.sources.insert(part.sources.end(), tile.sources.begin() + tile.source_offsets[piece],
                          tile.sources.begin() + tile.source_offsets[piece + 1]);
    }
    while (next < range.end_of_seam) add_of_seam(next++, part);
  }

  Key key_of_input(const Constraint& ends) const {
    return {code_of(solved_.task.input.at(ends[0])), code_of(solved_.task.input.at(ends[1]))};
  }
  Key key_of_seam(std::uint32_t piece) const {
    const Constraint& ends = seam_.pieces[piece];
    return {code_of(solved_.seam.points[ends[0]]), code_of(solved_.seam.points[ends[1]])};
  }

  void add_of_seam(std::uint32_t piece, Merged& part) const {
    const std::size_t before = part.sources.size();
    for (std::uint32_t i = seam_.source_offsets[piece]; i < seam_.source_offsets[piece + 1]; ++i)
      solved_.seam.for_sources(seam_.sources[i], solved_.tiles, [&](std::uint32_t c) { part.sources.push_back(c); });
    if (part.sources.size() == before) return;  // of the border alone
    std::sort(part.sources.begin() + static_cast<std::ptrdiff_t>(before), part.sources.end());
    const Constraint& ends = seam_.pieces[piece];
    part.ends.push_back({solved_.seam.ids[ends[0]], solved_.seam.ids[ends[1]]});
    part.begins.push_back(static_cast<std::uint32_t>(before));
  }

  const Solved& solved_;
  const ProblemMesh& seam_;
};

void write_representatives(const Solved& solved, ForestResult& result) {
  auto* representative = elements_of<std::uint32_t>(result, GCDT_REPRESENTATIVES);
  result.statistics.vertices_merged = 0;
  for (const SolvedTile& tile : solved.tiles) {
    for (const Constraint& pair : tile.merged) representative[pair[0]] = pair[1];
    result.statistics.vertices_merged += tile.merged.size();
  }
}

/// Edges of the hull of all: of the tiles' hulls those that the seam has nothing across from, and of the seam's.
std::uint64_t hull_edges(const Solved& solved) {
  std::uint64_t edges = 0;
  for (const SolvedTile& tile : solved.tiles)
    for (const BorderEdge& edge : tile.border) edges += edge.is_on_hull();
  for (std::size_t t = 0; t < solved.between.kept.size(); ++t)
    for (std::size_t k = 0; solved.between.kept[t] && k < 3; ++k) {
      const std::int32_t border = solved.between.border[t][k];
      if (border >= 0)
        edges -= solved.seam.border[static_cast<std::size_t>(border)].edge.is_on_hull();
      else
        edges += solved.between.mesh.neighbours[t][k] < 0;
    }
  return edges;
}

void check_joined(const Solved& solved, const Order& order, const ForestResult& joined) {
  const Span<Triangle> triangles = array_of<Triangle>(joined, GCDT_TRIANGLES);
  const Span<Neighbours> neighbours = array_of<Neighbours>(joined, GCDT_NEIGHBOURS);
  const Span<std::uint8_t> constrained = array_of<std::uint8_t>(joined, GCDT_CONSTRAINED);
  if (triangles.empty()) return;
  const GridInput& input = solved.task.input;
  const std::uint64_t hull = hull_edges(solved), n = input.n() - joined.statistics.vertices_merged;
  if (triangles.size() != 2 * n - 2 - hull)
    throw Error(Status::check_failed, "tiles: " + std::to_string(triangles.size()) + " triangles, of " +
                                          std::to_string(n) + " vertices, " + std::to_string(hull) + " on the hull");
  for_each_in_threads(
      solved.seam.border.size(),
      [&](std::size_t i) {
        const auto& [tile, edge] = solved.seam.border[i];
        const std::uint32_t t = order.place_of_final(tile, edge.triangle), k = edge.k();
        if ((constrained[t] >> k & 1) != 0 || neighbours[t][k] < 0) return;
        const auto other = static_cast<std::uint32_t>(neighbours[t][k]);
        unsigned back = 0;
        while (back < 3 && neighbours[other][back] != static_cast<std::int32_t>(t)) ++back;
        const auto at = [&](std::uint32_t v) { return vertex_at(input.at(v)); };
        const Triangle& here = triangles[t];
        const device::Vertex u = at(here[(k + 1) % 3]), v = at(here[(k + 2) % 3]);
        if (back == 3 || device::gcdt_must_flip(u, at(triangles[other][back]), v, at(here[k])))
          throw Error(Status::check_failed, "tiles: an edge between a tile and the seam is not locally Delaunay");
      },
      256);
}

}  // namespace

Order::Order(const Solved& solved)
    : firsts_(1, 0),
      keys_(solved.tiles.size()),
      before_(solved.tiles.size()),
      of_seam_(solved.between.kept.size(), {none, none}) {
  for (std::uint32_t t = 0; t < of_seam_.size(); ++t) {
    if (!solved.between.kept[t]) continue;
    const Triangle& corners = solved.between.mesh.triangles[t];
    const std::size_t tile = solved.seam.tile_of(corners[0]);
    of_seam_[t] = {static_cast<std::uint32_t>(tile), static_cast<std::uint32_t>(keys_[tile].size())};
    keys_[tile].push_back({code_of(solved.seam.points[corners[0]]), code_of(solved.seam.points[corners[1]])});
  }
  for (std::size_t tile = 0; tile < keys_.size(); ++tile)
    firsts_.push_back(firsts_.back() + solved.tiles[tile].final.count + static_cast<std::uint32_t>(keys_[tile].size()));
}

std::uint32_t Order::place_of_final(std::size_t tile, std::uint32_t triangle) const {
  const std::vector<std::uint32_t>& before = before_[tile];
  const auto inserted = std::upper_bound(before.begin(), before.end(), triangle) - before.begin();
  return firsts_[tile] + triangle + static_cast<std::uint32_t>(inserted);
}

std::uint32_t Order::place_in_seam(std::uint32_t triangle) const {
  const auto [tile, number] = of_seam_[triangle];
  return firsts_[tile] + before_[tile][number] + number;
}

void join(const Solved& solved, const Order& order, const std::vector<std::uint32_t>& dropped, ForestResult& result) {
  Statistics& s = result.statistics;
  SeamWriter(solved, order, result).write();
  PieceWriter(solved).write(result);
  write_representatives(solved, result);
  std::copy(dropped.begin(), dropped.end(), room<std::uint32_t>(result, GCDT_DROPPED, dropped.size()));
  s.n = solved.task.input.n();
  s.m = solved.task.input.constraints.size();
  s.triangles = order.triangles();
  s.constraints_pieces = result.begins[GCDT_PIECES].back();
  s.constraints_overlapping = result.begins[GCDT_SOURCES].back() - s.constraints_pieces;
  s.constraints_dropped = dropped.size();
  if (solved.task.check) check_joined(solved, order, result);
}

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
#include "tiles/returned.hpp"

#include <limits>

#include "tiles/indices.hpp"

namespace gcdt::tiles {

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// The seam's triangles with the places of their neighbours, and for each edge of the border the place across from it.
class TriangleWriter {
 public:
  TriangleWriter(const Solved& solved, const Order& order, std::vector<Returned>& returned)
      : solved_(solved), order_(order), returned_(returned), across_(solved.seam.border.size()) {}

  void write() {
    for (std::size_t tile = 0; tile < returned_.size(); ++tile) returned_[tile].triangles.resize(order_.of_seam(tile));
    for (Across& across : across_) across.place = none;
    for_each_in_threads(solved_.between.kept.size(), [&](std::size_t t) {
      if (solved_.between.kept[t]) write_triangle(static_cast<std::uint32_t>(t));
    });
    for (std::size_t i = 0; i < across_.size(); ++i)
      if (across_[i].place != none) returned_[solved_.seam.border[i].tile].across.push_back(across_[i]);
  }

 private:
  // No two of the seam's triangles are across from one side of a final triangle.
  void write_triangle(std::uint32_t t) {
    const SolvedSeam& from = solved_.between;
    const auto [tile, number] = order_.of_tile(t);
    SeamTriangle& made = returned_[tile].triangles[number];
    made.constrained = from.constrained[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = from.mesh.triangles[t][k];
      made.corners[k] = solved_.seam.ids[corner];
      made.points[k] = solved_.seam.points[corner];
      const std::int32_t other = from.mesh.neighbours[t][k], border = from.border[t][k];
      if (border >= 0) {
        const auto& [beyond, edge] = solved_.seam.border[static_cast<std::size_t>(border)];
        made.neighbours[k] = static_cast<std::int32_t>(order_.place_of_final(beyond, edge.triangle));
        across_[static_cast<std::size_t>(border)] = {edge.triangle, edge.k(), order_.place_in_seam(t),
                                                     solved_.seam.points[corner]};
      } else {
        made.neighbours[k] =
            other < 0 ? -1 : static_cast<std::int32_t>(order_.place_in_seam(static_cast<std::uint32_t>(other)));
      }
    }
  }

  const Solved& solved_;
  const Order& order_;
  std::vector<Returned>& returned_;
  std::vector<Across> across_;  ///< by edge of the border
};

/// Shares out the seam's pieces, which are in Z-order: so each tile's follow each other.
void write_pieces(const Solved& solved, std::vector<Returned>& returned) {
  const ProblemMesh& mesh = solved.between.mesh;
  const auto code = [&](std::uint32_t v) { return code_of(solved.seam.points[v]); };
  for (std::size_t piece = 0; piece < mesh.pieces.size(); ++piece) {
    const Constraint& ends = mesh.pieces[piece];
    Returned& to = returned[solved.seam.tile_of(ends[0])];
    const auto before = static_cast<std::ptrdiff_t>(to.sources.size());
    for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i)
      solved.seam.for_sources(mesh.sources[i], solved.tiles, [&](std::uint32_t c) { to.sources.push_back(c); });
    if (to.sources.begin() + before == to.sources.end()) continue;  // of the border alone
    std::sort(to.sources.begin() + before, to.sources.end());
    to.piece_keys.push_back({code(ends[0]), code(ends[1])});
    to.pieces.push_back({solved.seam.ids[ends[0]], solved.seam.ids[ends[1]]});
    to.source_offsets.push_back(static_cast<std::uint32_t>(before));
  }
  for (Returned& to : returned) to.source_offsets.push_back(static_cast<std::uint32_t>(to.sources.size()));
}

/// Edges of the hull of all: of the tiles' hulls those that the seam has nothing across from, and of the seam's.
std::uint64_t hull_edges(const Solved& solved) {
  std::uint64_t edges = 0;
  for (const SolvedTile& tile : solved.tiles)
    for (const BorderEdge& edge : tile.border) edges += edge.is_on_hull();
  return edges + count_in_threads(solved.between.kept.size(), [&](std::size_t t) {
           std::int64_t more = 0;  // modulo 2^64, as the sum is
           for (std::size_t k = 0; solved.between.kept[t] && k < 3; ++k) {
             const std::int32_t border = solved.between.border[t][k];
             if (border >= 0)
               more -= solved.seam.border[static_cast<std::size_t>(border)].edge.is_on_hull();
             else
               more += solved.between.mesh.neighbours[t][k] < 0;
           }
           return more;
         });
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
    if (keys_[tile].size() > 1 && keys_[tile].back() < keys_[tile].end()[-2])
      refuse("the seam's triangles are not in their order");
  }
  for (std::size_t tile = 0; tile < keys_.size(); ++tile)
    firsts_.push_back(firsts_.back() + solved.tiles[tile].final.count + static_cast<std::uint32_t>(keys_[tile].size()));
}

std::uint32_t Order::place_in_seam(std::uint32_t triangle) const {
  const auto [tile, number] = of_seam_[triangle];
  return firsts_[tile] + before_[tile][number] + number;
}

std::vector<Returned> returned_by(const Solved& solved, const Order& order) {
  std::vector<Returned> returned(solved.tiles.size());
  TriangleWriter(solved, order, returned).write();
  write_pieces(solved, returned);
  return returned;
}

void check_count(const Solved& solved, const Order& order, std::uint64_t vertices) {
  if (order.triangles() == 0) return;
  const std::uint64_t hull = hull_edges(solved);
  if (order.triangles() != 2 * vertices - 2 - hull)
    throw Error(Status::check_failed, "tiles: " + std::to_string(order.triangles()) + " triangles, of " +
                                          std::to_string(vertices) + " vertices, " + std::to_string(hull) +
                                          " on the hull");
}

}  // namespace gcdt::tiles

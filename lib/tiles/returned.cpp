// SPDX-License-Identifier: Apache-2.0
#include "tiles/returned.hpp"

#include "tiles/indices.hpp"

namespace gcdt::tiles {

namespace {

/// Triangles that are worth a thread: each takes a few misses of the caches, all over the result.
constexpr std::size_t given_by_thread = 512;

/// Keeps all for the tiles.
class Collector final : public SeamTaker {
 public:
  Collector(const Solved& solved, const Order& order, std::vector<Returned>& returned)
      : solved_(solved), returned_(returned), across_(solved.seam.border.size()) {
    for (std::size_t tile = 0; tile < returned_.size(); ++tile) returned_[tile].triangles.resize(order.of_seam(tile));
    for (Across& across : across_) across.place = GCDT_NONE;
  }
  void take(std::size_t tile, std::uint32_t number, const SeamTriangle& triangle) override {
    returned_[tile].triangles[number] = triangle;
  }
  void take(std::uint32_t border, const Across& across) override { across_[border] = across; }
  void finish() {
    for (std::size_t i = 0; i < across_.size(); ++i)
      if (across_[i].place != GCDT_NONE) returned_[solved_.seam.border[i].tile].across.push_back(across_[i]);
  }

 private:
  const Solved& solved_;
  std::vector<Returned>& returned_;
  std::vector<Across> across_;  ///< by edge of the border
};

/// The seam's triangles with the places of their neighbours, and for each edge of the border the place across from it.
class TriangleGiver {
 public:
  TriangleGiver(const Solved& solved, const Order& order, SeamTaker& to) : solved_(solved), order_(order), to_(to) {}

  void give() {
    for_each_in_threads(
        solved_.between.kept.size(),
        [&](std::size_t t) {
          if (solved_.between.kept[t]) give_triangle(static_cast<std::uint32_t>(t));
        },
        given_by_thread);
  }

 private:
  // No two of the seam's triangles are across from one side of a final triangle: take_seam() has seen to it.
  void give_triangle(std::uint32_t t) {
    const SolvedSeam& from = solved_.between;
    const auto [tile, number] = order_.of_tile(t);
    SeamTriangle made;
    made.constrained = from.mesh.constrained[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = from.mesh.triangles[t][k];
      made.corners[k] = solved_.seam.ids[corner];
      made.points[k] = solved_.seam.points[corner];
      const std::int32_t other = from.mesh.neighbours[t][k], border = from.border_at(t, k);
      if (border >= 0) {
        const auto& [beyond, edge] = solved_.seam.border[static_cast<std::size_t>(border)];
        made.neighbours[k] = static_cast<std::int32_t>(order_.place_of_final(beyond, edge.triangle));
        to_.take(static_cast<std::uint32_t>(border),
                 {edge.triangle, edge.k(), order_.place_in_seam(t), solved_.seam.points[corner]});
      } else {
        made.neighbours[k] =
            other < 0 ? -1 : static_cast<std::int32_t>(order_.place_in_seam(static_cast<std::uint32_t>(other)));
      }
    }
    to_.take(tile, number, made);
  }

  const Solved& solved_;
  const Order& order_;
  SeamTaker& to_;
};

/// Shares out the seam's pieces, which are in Z-order: so each tile's follow each other.
void write_pieces(const Solved& solved, bool with_keys, std::vector<SeamPieces>& returned) {
  const ProblemMesh& mesh = solved.between.mesh;
  const auto code = [&](std::uint32_t v) { return code_of(solved.seam.points[v]); };
  const auto for_sources = [&](std::size_t piece, const auto& use) {
    for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i)
      solved.seam.for_sources(mesh.sources[i], solved.tiles, use);
  };
  const auto tile_of = [&](std::size_t piece) { return solved.seam.tile_of(mesh.pieces[piece][0]); };
  std::vector<std::array<std::size_t, 2>> counts(returned.size(), {0, 0});  // pieces and sources: no room is for none
  for (std::size_t piece = 0; piece < mesh.pieces.size(); ++piece) {
    std::size_t sources = 0;
    for_sources(piece, [&](std::uint32_t) { ++sources; });
    auto& [pieces, of_pieces] = counts[tile_of(piece)];
    pieces += sources > 0, of_pieces += sources;
  }
  for (std::size_t tile = 0; tile < returned.size(); ++tile) {
    SeamPieces& to = returned[tile];
    if (with_keys) to.keys.reserve(counts[tile][0]);
    to.pieces.reserve(counts[tile][0]), to.source_offsets.reserve(counts[tile][0] + 1);
    to.sources.reserve(counts[tile][1]);
  }
  for (std::size_t piece = 0; piece < mesh.pieces.size(); ++piece) {
    const Constraint& ends = mesh.pieces[piece];
    SeamPieces& to = returned[tile_of(piece)];
    const auto before = static_cast<std::ptrdiff_t>(to.sources.size());
    for_sources(piece, [&](std::uint32_t c) { to.sources.push_back(c); });
    if (to.sources.begin() + before == to.sources.end()) continue;  // of the border alone
    std::sort(to.sources.begin() + before, to.sources.end());
    if (with_keys) to.keys.push_back({code(ends[0]), code(ends[1])});
    to.pieces.push_back({solved.seam.ids[ends[0]], solved.seam.ids[ends[1]]});
    to.source_offsets.push_back(static_cast<std::uint32_t>(before));
  }
  for (SeamPieces& to : returned) to.source_offsets.push_back(static_cast<std::uint32_t>(to.sources.size()));
}

/// Edges of the hull of all: of the tiles' hulls those that the seam has nothing across from, and of the seam's.
std::uint64_t hull_edges(const Solved& solved) {
  return solved.seam.tile_hull_edges + count_in_threads(solved.between.kept.size(), [&](std::size_t t) {
           std::int64_t more = 0;  // modulo 2^64, as the sum is
           for (std::size_t k = 0; solved.between.kept[t] && k < 3; ++k) {
             const std::int32_t border = solved.between.border_at(t, k);
             if (border >= 0)
               more -= solved.seam.border[static_cast<std::size_t>(border)].edge.is_on_hull();
             else
               more += solved.between.mesh.neighbours[t][k] < 0;
           }
           return more;
         });
}

}  // namespace

namespace {

using Key = std::array<std::uint64_t, 2>;
constexpr std::size_t least_blocks = 64;  ///< that are worth a thread

/// One kept triangle of the seam, then the next one. Keys are of tiles: those of one tile ascend.
void check_order(std::size_t tile, const Key& key, std::size_t next_tile, const Key& next_key) {
  if (next_tile < tile || (next_tile == tile && next_key < key)) refuse("the seam's triangles are not in their order");
}

}  // namespace

Order::Order(const Solved& solved)
    : solved_(solved),
      firsts_(1, 0),
      before_(solved.tiles.size()),
      kept_(solved.between.kept),
      firsts_of_seam_(1, 0),
      first_triangles_(solved.tiles.size(), 0) {
  // Part by part of blocks: what is kept there, tile by tile, and the keys at its ends.
  struct Part {
    std::vector<std::uint32_t> counts, firsts;
    std::size_t first_tile = 0, last_tile = 0;
    Key first_key{}, last_key{};
    std::uint32_t kept = 0;
  };
  const std::size_t blocks = (kept_.size() + of_block - 1) / of_block;
  kept_before_.resize(blocks);
  const Parts parts(blocks, least_blocks);
  std::vector<Part> all(parts.size());
  parts.run([&](std::size_t number, std::size_t first_block, std::size_t end_block) {
    Part& part = all[number];
    part.counts.assign(solved_.tiles.size(), 0), part.firsts.assign(solved_.tiles.size(), 0);
    const std::size_t end = std::min(end_block * of_block, kept_.size());
    for (std::size_t t = first_block * of_block; t < end; ++t) {
      if (t % of_block == 0) kept_before_[t / of_block] = part.kept;
      if (!kept_[t]) continue;
      const auto triangle = static_cast<std::uint32_t>(t);
      const std::size_t tile = solved_.seam.tile_of(solved_.between.mesh.triangles[t][0]);
      const Key key = key_of(triangle);
      if (part.kept++ == 0)
        part.first_tile = tile, part.first_key = key;
      else
        check_order(part.last_tile, part.last_key, tile, key);
      if (part.counts[tile]++ == 0) part.firsts[tile] = triangle;
      part.last_tile = tile, part.last_key = key;
    }
  });
  std::vector<std::uint32_t> counts(solved_.tiles.size(), 0);
  std::uint32_t kept = 0;
  const Part* last = nullptr;
  for (std::size_t number = 0; number < all.size(); ++number) {
    const Part& part = all[number];
    for (std::size_t b = blocks * number / all.size(); b < blocks * (number + 1) / all.size(); ++b)
      kept_before_[b] += kept;
    if (part.kept == 0) continue;
    if (last) check_order(last->last_tile, last->last_key, part.first_tile, part.first_key);
    last = &part;
    kept += part.kept;
    for (std::size_t tile = 0; tile < counts.size(); ++tile) {
      if (counts[tile] == 0) first_triangles_[tile] = part.firsts[tile];
      counts[tile] += part.counts[tile];
    }
  }
  for (std::size_t tile = 0; tile < counts.size(); ++tile) {
    firsts_of_seam_.push_back(firsts_of_seam_.back() + counts[tile]);
    firsts_.push_back(firsts_.back() + solved.tiles[tile].final.count + counts[tile]);
  }
}

std::array<std::uint64_t, 2> Order::key_of(std::uint32_t triangle) const {
  const Triangle& corners = solved_.between.mesh.triangles[triangle];
  return {code_of(solved_.seam.points[corners[0]]), code_of(solved_.seam.points[corners[1]])};
}

TilePlaces Order::places(std::size_t tile) const {
  const auto make_keys = [this, tile] {
    SeamKeys keys;
    keys.reserve(of_seam(tile));
    for (std::uint32_t t = first_triangles_[tile]; keys.size() < of_seam(tile); ++t)  // so many are kept from there on
      if (kept_[t]) keys.push_back(key_of(t));
    return keys;
  };
  return {firsts_[tile], of_seam(tile), make_keys};
}

/// Its number among the kept ones.
std::uint32_t Order::rank_of(std::uint32_t triangle) const {
  std::uint32_t rank = kept_before_[triangle / of_block];
  for (std::uint32_t t = triangle / of_block * of_block; t < triangle; ++t) rank += kept_[t] != 0;
  return rank;
}

std::pair<std::size_t, std::uint32_t> Order::of_tile(std::uint32_t triangle) const {
  const std::uint32_t rank = rank_of(triangle);
  const auto behind = std::upper_bound(firsts_of_seam_.begin(), firsts_of_seam_.end(), rank);
  const auto tile = static_cast<std::size_t>(behind - firsts_of_seam_.begin()) - 1;
  return {tile, rank - firsts_of_seam_[tile]};
}

std::uint32_t Order::place_in_seam(std::uint32_t triangle) const {
  const auto [tile, number] = of_tile(triangle);
  return firsts_[tile] + before_[tile][number] + number;
}

void give_back(const Solved& solved, const Order& order, SeamTaker& to) { TriangleGiver(solved, order, to).give(); }

std::vector<Returned> returned_by(const Solved& solved, const Order& order) {
  std::vector<Returned> returned(solved.tiles.size());
  Collector collector(solved, order, returned);
  give_back(solved, order, collector);
  collector.finish();
  return returned;
}

std::vector<SeamPieces> seam_pieces_by(const Solved& solved, bool with_keys) {
  std::vector<SeamPieces> pieces(solved.tiles.size());
  write_pieces(solved, with_keys, pieces);
  return pieces;
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

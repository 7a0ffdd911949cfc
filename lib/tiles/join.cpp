// SPDX-License-Identifier: Apache-2.0
#include "tiles/join.hpp"

#include <bitset>
#include <limits>
#include <numeric>

#include "tiles/parts.hpp"

namespace gcdt::tiles {

namespace {

using Key = std::pair<std::uint64_t, std::uint64_t>;  // of a triangle or a piece: the codes of its first two vertices

/// Which of a tile's triangles are final, and how many before each.
class Ranks {
 public:
  explicit Ranks(const Array<std::uint8_t>& final) : words_(final.size() / 64 + 1, 0) {
    for_each_in_threads(words_.size(), [&](std::size_t w) {
      for (std::size_t i = 64 * w; i < std::min(64 * w + 64, final.size()); ++i)
        words_[w] |= std::uint64_t{final[i]} << (i % 64);
    });
    before_.reserve(words_.size());
    for (const std::uint64_t word : words_) {
      before_.push_back(count_);
      count_ += ones(word);
    }
  }
  std::uint32_t count() const { return count_; }
  /// Final triangles before number i.
  std::uint32_t before(std::size_t i) const {
    return before_[i / 64] + ones(words_[i / 64] & ((std::uint64_t{1} << (i % 64)) - 1));
  }

 private:
  static std::uint32_t ones(std::uint64_t word) { return static_cast<std::uint32_t>(std::bitset<64>(word).count()); }
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;
  std::uint32_t count_ = 0;
};

/// Where triangles are in the result. Those of a tile come before those of the next; a triangle of the seam is among
/// those of the tile that has its first vertex.
class Order {
 public:
  explicit Order(const Solved& solved) : solved_(solved), firsts_(1, 0) {
    for (const SolvedTile& tile : solved.tiles) ranks_.emplace_back(tile.final);
    finals_before_.resize(ranks_.size());
    seam_place_.assign(solved.between.kept.size(), 0);
    std::vector<std::vector<std::uint32_t>> own(ranks_.size());
    std::vector<std::uint32_t> before(solved.between.kept.size());
    for_each_in_threads(before.size(), [&](std::size_t t) {
      const auto of_seam = static_cast<std::uint32_t>(t);
      if (solved.between.kept[t]) before[t] = finals_before(tile_of(of_seam), of_seam);
    });
    for (std::uint32_t t = 0; t < before.size(); ++t) {
      if (!solved.between.kept[t]) continue;
      const std::size_t tile = tile_of(t);
      finals_before_[tile].push_back(before[t]);
      own[tile].push_back(t);
    }
    make_buckets();
    for (std::size_t tile = 0; tile < ranks_.size(); ++tile) {
      for (std::uint32_t i = 0; i < own[tile].size(); ++i)
        seam_place_[own[tile][i]] = firsts_.back() + finals_before_[tile][i] + i;
      firsts_.push_back(firsts_.back() + ranks_[tile].count() + static_cast<std::uint32_t>(own[tile].size()));
    }
  }
  std::uint32_t triangles() const { return firsts_.back(); }
  std::uint32_t place_of_final(std::size_t tile, std::uint32_t triangle) const {
    const std::uint32_t rank = ranks_[tile].before(triangle);
    return firsts_[tile] + rank + inserted_before(tile, rank);
  }
  std::uint32_t place_in_seam(std::uint32_t triangle) const { return seam_place_[triangle]; }

 private:
  static constexpr unsigned bucket_bits = 8;

  /// How many triangles of the seam come before the final triangle of that rank.
  std::uint32_t inserted_before(std::size_t tile, std::uint32_t rank) const {
    const std::vector<std::uint32_t>&inserted = finals_before_[tile], &buckets = buckets_[tile];
    const auto first = inserted.begin() + buckets[rank >> bucket_bits],
               end = inserted.begin() + buckets[(rank >> bucket_bits) + 1];
    return static_cast<std::uint32_t>(std::upper_bound(first, end, rank) - inserted.begin());
  }
  void make_buckets() {
    buckets_.resize(ranks_.size());
    for (std::size_t tile = 0; tile < ranks_.size(); ++tile) {
      buckets_[tile].assign((ranks_[tile].count() >> bucket_bits) + 2, 0);
      for (const std::uint32_t rank : finals_before_[tile]) {
        const std::size_t next = (rank >> bucket_bits) + 1;
        if (next < buckets_[tile].size()) ++buckets_[tile][next];
      }
      std::partial_sum(buckets_[tile].begin(), buckets_[tile].end(), buckets_[tile].begin());
    }
  }

  /// The tile that has the first vertex of a triangle of the seam.
  std::size_t tile_of(std::uint32_t of_seam) const {
    return solved_.all.tile_of[solved_.seam.ids[solved_.between.mesh.triangles[of_seam][0]]];
  }
  std::uint32_t finals_before(std::size_t tile, std::uint32_t of_seam) const {
    const auto key = [](const Triangle& t, const GridPoints& points) {
      return Key(code_of(points[t[0]]), code_of(points[t[1]]));
    };
    const Key wanted = key(solved_.between.mesh.triangles[of_seam], solved_.seam.points);
    const Span<Triangle> triangles = solved_.tiles[tile].mesh.triangles;
    const auto found = std::lower_bound(
        triangles.begin(), triangles.end(), wanted,
        [&](const Triangle& t, const Key& other) { return key(t, solved_.all.tiles[tile].points) < other; });
    return ranks_[tile].before(static_cast<std::size_t>(found - triangles.begin()));
  }

  const Solved& solved_;
  std::vector<Ranks> ranks_;
  std::vector<std::uint32_t> firsts_;                      ///< of each tile, and of all
  std::vector<std::vector<std::uint32_t>> finals_before_;  ///< of each triangle of the seam, by tile
  std::vector<std::vector<std::uint32_t>> buckets_;        ///< of ranks, by tile: where in finals_before_ each begins
  std::vector<std::uint32_t> seam_place_;                  ///< by triangle of the seam
};

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// For each edge of the border, the triangle and the edge of the seam there. None where the edge turns out to be the
/// convex hull's: what is left of the plane lies in the hull of the seam's vertices, which are all its corners.
std::vector<Seam::Part> seam_sides(const Solved& solved) {
  std::vector<Seam::Part> sides(solved.seam.border.size(), {none, none});
  const SolvedSeam& between = solved.between;
  for (std::uint32_t t = 0; t < between.kept.size(); ++t)
    for (std::uint32_t k = 0; between.kept[t] && k < 3; ++k)
      if (between.border[t][k] >= 0) sides[static_cast<std::size_t>(between.border[t][k])] = {t, k};
  return sides;
}

/// Writes triangles, neighbours and flags.
class MeshWriter {
 public:
  MeshWriter(const Solved& solved, const Order& order, ForestResult& result)
      : solved_(solved), order_(order), sides_(seam_sides(solved)) {
    const std::uint32_t count = order_.triangles();
    triangles_ = room<Triangle>(result, GCDT_TRIANGLES, count);
    neighbours_ = room<Neighbours>(result, GCDT_NEIGHBOURS, count);
    constrained_ = room<std::uint8_t>(result, GCDT_CONSTRAINED, count);
  }

  void write() {
    for (std::uint32_t tile = 0; tile < solved_.tiles.size(); ++tile)
      for_each_in_threads(solved_.tiles[tile].final.size(),
                          [&](std::size_t t) { write_final(tile, static_cast<std::uint32_t>(t)); });
    for_each_in_threads(solved_.between.kept.size(),
                        [&](std::size_t t) { write_of_seam(static_cast<std::uint32_t>(t)); });
  }

 private:
  void write_final(std::uint32_t tile, std::uint32_t t) {
    const SolvedTile& from = solved_.tiles[tile];
    if (!from.final[t]) return;
    const std::uint32_t place = order_.place_of_final(tile, t);
    const Array<std::uint32_t>& ids = solved_.all.tiles[tile].ids;
    std::uint8_t flags = from.mesh.constrained[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      triangles_[place][k] = ids[from.mesh.triangles[t][k]];
      const std::int32_t other = from.mesh.neighbours[t][k];
      if (other >= 0 && from.final[static_cast<std::uint32_t>(other)]) {
        neighbours_[place][k] =
            static_cast<std::int32_t>(order_.place_of_final(tile, static_cast<std::uint32_t>(other)));
        continue;
      }
      const std::int64_t edge = border_edge({tile, t, k});
      neighbours_[place][k] = -1;
      if (edge < 0) continue;
      const auto [of_seam, side] = sides_[static_cast<std::size_t>(edge)];
      if (of_seam == none) continue;
      neighbours_[place][k] = static_cast<std::int32_t>(order_.place_in_seam(of_seam));
      if (solved_.between.inner[of_seam][side] >= 0) flags |= static_cast<std::uint8_t>(1u << k);
    }
    constrained_[place] = flags;
  }

  void write_of_seam(std::uint32_t t) {
    const SolvedSeam& from = solved_.between;
    if (!from.kept[t]) return;
    const std::uint32_t place = order_.place_in_seam(t);
    std::uint8_t flags = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      triangles_[place][k] = solved_.seam.ids[from.mesh.triangles[t][k]];
      const std::int32_t other = from.mesh.neighbours[t][k], border = from.border[t][k];
      std::int32_t& neighbour = neighbours_[place][k];
      if (border >= 0) {
        const BorderEdge& edge = solved_.seam.border[static_cast<std::size_t>(border)];
        neighbour = static_cast<std::int32_t>(order_.place_of_final(edge.tile, edge.triangle));
      } else {
        neighbour = other < 0 ? -1 : static_cast<std::int32_t>(order_.place_in_seam(static_cast<std::uint32_t>(other)));
      }
      if (from.inner[t][k] >= 0) flags |= static_cast<std::uint8_t>(1u << k);
    }
    constrained_[place] = flags;
  }

  /// Its number, or -1: the hull's edges are not of the border.
  std::int64_t border_edge(const BorderEdge& wanted) const {
    const auto key = [](const BorderEdge& e) { return std::make_tuple(e.tile, e.triangle, e.k); };
    const auto& border = solved_.seam.border;
    const auto found = std::lower_bound(border.begin(), border.end(), wanted,
                                        [&](const BorderEdge& a, const BorderEdge& b) { return key(a) < key(b); });
    return found != border.end() && key(*found) == key(wanted) ? found - border.begin() : -1;
  }

  const Solved& solved_;
  const Order& order_;
  const std::vector<Seam::Part> sides_;
  Triangle* triangles_;
  Neighbours* neighbours_;
  std::uint8_t* constrained_;
};

/// The pieces of the result, in Z-order of their ends: those of tiles inside final triangles, and those of the seam.
class PieceWriter {
 public:
  explicit PieceWriter(const Solved& solved) : solved_(solved) { offsets_.push_back(0); }

  void write(ForestResult& result) {
    std::size_t next_part = 0;
    std::uint32_t next_of_seam = 0;
    const auto& parts = solved_.seam.parts;
    const ProblemMesh& seam = solved_.between.mesh;
    for (std::uint32_t tile = 0; tile < solved_.tiles.size(); ++tile) {
      const ProblemMesh& mesh = solved_.tiles[tile].mesh;
      for (std::uint32_t piece = 0; piece < mesh.pieces.size(); ++piece) {
        if (next_part < parts.size() && parts[next_part].tile == tile && parts[next_part].piece == piece) {
          ++next_part;
          continue;
        }
        const Key here = key(mesh.pieces[piece], solved_.all.tiles[tile].points);
        while (next_of_seam < seam.pieces.size() && key(seam.pieces[next_of_seam], solved_.seam.points) < here)
          add_of_seam(next_of_seam++);
        add_of_tile(tile, piece);
      }
    }
    while (next_of_seam < seam.pieces.size()) add_of_seam(next_of_seam++);
    keep(result, GCDT_PIECES, ends_);
    keep(result, GCDT_SOURCE_OFFSETS, offsets_);
    keep(result, GCDT_SOURCES, sources_);
  }

 private:
  static Key key(const Constraint& ends, const GridPoints& points) {
    return {code_of(points[ends[0]]), code_of(points[ends[1]])};
  }

  void add_of_tile(std::uint32_t tile, std::uint32_t piece) {
    const ProblemMesh& mesh = solved_.tiles[tile].mesh;
    const Tile& given = solved_.all.tiles[tile];
    const Constraint& ends = mesh.pieces[piece];
    ends_.push_back({given.ids[ends[0]], given.ids[ends[1]]});
    for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i)
      sources_.push_back(given.constraint_ids[mesh.sources[i]]);
    offsets_.push_back(static_cast<std::uint32_t>(sources_.size()));
  }

  void add_of_seam(std::uint32_t piece) {
    const ProblemMesh& mesh = solved_.between.mesh;
    const std::size_t before = sources_.size();
    for (std::uint32_t i = mesh.source_offsets[piece]; i < mesh.source_offsets[piece + 1]; ++i)
      solved_.seam.for_sources(mesh.sources[i], solved_.all, solved_.tiles,
                               [&](std::uint32_t c) { sources_.push_back(c); });
    if (sources_.size() == before) return;  // of the border alone
    std::sort(sources_.begin() + static_cast<std::ptrdiff_t>(before), sources_.end());
    const Constraint& ends = mesh.pieces[piece];
    ends_.push_back({solved_.seam.ids[ends[0]], solved_.seam.ids[ends[1]]});
    offsets_.push_back(static_cast<std::uint32_t>(sources_.size()));
  }

  template <class T>
  static void keep(ForestResult& result, std::int32_t array, const std::vector<T>& values) {
    std::copy(values.begin(), values.end(), room<T>(result, array, values.size()));
  }

  const Solved& solved_;
  std::vector<Constraint> ends_;
  std::vector<std::uint32_t> offsets_, sources_;
};

void write_representatives(const Solved& solved, ForestResult& result) {
  const std::size_t n = solved.input.points.size();
  auto* representative = room<std::uint32_t>(result, GCDT_REPRESENTATIVES, n);
  for_each_in_threads(n, [&](std::size_t v) {
    const std::size_t tile = solved.all.tile_of[v];
    representative[v] = solved.all.tiles[tile].ids[solved.tiles[tile].mesh.representative[solved.all.place[v]]];
  });
  result.statistics.vertices_merged = count_in_threads(n, [&](std::size_t v) { return representative[v] != v; });
}

void check_joined(const Solved& solved, const Order& order, const ForestResult& joined) {
  const Span<Triangle> triangles = array_of<Triangle>(joined, GCDT_TRIANGLES);
  const Span<Neighbours> neighbours = array_of<Neighbours>(joined, GCDT_NEIGHBOURS);
  const Span<std::uint8_t> constrained = array_of<std::uint8_t>(joined, GCDT_CONSTRAINED);
  if (triangles.empty()) return;
  const std::uint64_t hull = count_in_threads(neighbours.size(), [&](std::size_t t) {
    const Neighbours& three = neighbours[t];
    return (three[0] < 0) + (three[1] < 0) + (three[2] < 0);
  });
  const std::uint64_t n = solved.input.points.size() - joined.statistics.vertices_merged;
  if (triangles.size() != 2 * n - 2 - hull)
    throw Error(Status::check_failed, "tiles: " + std::to_string(triangles.size()) + " triangles, of " +
                                          std::to_string(n) + " vertices, " + std::to_string(hull) + " on the hull");
  for (const BorderEdge& edge : solved.seam.border) {
    const std::uint32_t t = order.place_of_final(edge.tile, edge.triangle);
    if ((constrained[t] >> edge.k & 1) != 0 || neighbours[t][edge.k] < 0) continue;
    const auto other = static_cast<std::uint32_t>(neighbours[t][edge.k]);
    unsigned back = 0;
    while (back < 3 && neighbours[other][back] != static_cast<std::int32_t>(t)) ++back;
    const auto at = [&](std::uint32_t v) { return vertex_at(solved.input.points[v]); };
    const Triangle& here = triangles[t];
    const device::Vertex u = at(here[(edge.k + 1) % 3]), v = at(here[(edge.k + 2) % 3]);
    if (back == 3 || device::gcdt_must_flip(u, at(triangles[other][back]), v, at(here[edge.k])))
      throw Error(Status::check_failed, "tiles: an edge between a tile and the seam is not locally Delaunay");
  }
}

}  // namespace

ForestResult join(const Solved& solved, const std::vector<std::uint32_t>& dropped, bool check) {
  const Order order(solved);
  ForestResult result;
  Statistics& s = result.statistics;
  MeshWriter(solved, order, result).write();
  PieceWriter(solved).write(result);
  write_representatives(solved, result);
  std::copy(dropped.begin(), dropped.end(), room<std::uint32_t>(result, GCDT_DROPPED, dropped.size()));
  s.n = solved.input.points.size();
  s.m = solved.input.constraints.size();
  s.triangles = result.begins[GCDT_TRIANGLES].back();
  s.constraints_pieces = result.begins[GCDT_PIECES].back();
  s.constraints_overlapping = result.begins[GCDT_SOURCES].back() - s.constraints_pieces;
  s.constraints_dropped = dropped.size();
  if (check) check_joined(solved, order, result);
  return result;
}

}  // namespace gcdt::tiles

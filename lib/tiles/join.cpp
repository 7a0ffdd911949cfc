// SPDX-License-Identifier: Apache-2.0
#include "tiles/join.hpp"

#include "device/parts.hpp"

namespace gcdt::tiles {

namespace {

using Key = std::array<std::uint64_t, 2>;  // of a piece: the codes of its ends

/// Writes what a tile could not know: the seam's triangles among its own, and who is across at the border.
class SeamWriter {
 public:
  /// `begin`: the place in the result at which the arrays begin.
  SeamWriter(const GridInput& input, const WrittenTile& tile, std::uint32_t begin, ForestResult& result)
      : input_(input),
        tile_(tile),
        first_(tile.first - begin),
        triangles_(elements_of<Triangle>(result, GCDT_TRIANGLES)),
        neighbours_(elements_of<Neighbours>(result, GCDT_NEIGHBOURS)),
        constrained_(elements_of<std::uint8_t>(result, GCDT_CONSTRAINED)) {}

  void write() {
    const Returned& seam = tile_.seam;
    for_each_in_threads(seam.triangles.size(), [&](std::size_t i) {
      const std::size_t at = first_ + tile_.before[i] + i;
      triangles_[at] = seam.triangles[i].corners;
      neighbours_[at] = seam.triangles[i].neighbours;
      constrained_[at] = static_cast<std::uint8_t>(seam.triangles[i].constrained);
    });
    for_each_in_threads(seam.across.size(), [&](std::size_t i) {
      const Across& across = seam.across[i];
      neighbours_[at_final(across)][across.k] = static_cast<std::int32_t>(across.place);
    });
  }

  void check() const {
    for_each_in_threads(
        tile_.seam.across.size(),
        [&](std::size_t i) {
          const Across& across = tile_.seam.across[i];
          const std::size_t t = at_final(across);
          if ((constrained_[t] >> across.k & 1) != 0) return;
          const auto at = [&](std::uint32_t turn) {
            return vertex_at(input_.at(triangles_[t][(across.k + turn) % 3]));
          };
          if (device::gcdt_must_flip(at(1), vertex_at(across.apex), at(2), at(0)))
            throw Error(Status::check_failed, "tiles: an edge between a tile and the seam is not locally Delaunay");
        },
        256);
  }

 private:
  std::size_t at_final(const Across& across) const { return place_of_final(tile_.before, first_, across.triangle); }

  const GridInput& input_;
  const WrittenTile& tile_;
  const std::uint32_t first_;
  Triangle* triangles_;
  Neighbours* neighbours_;
  std::uint8_t* constrained_;
};

/// The pieces of the result, in Z-order of their ends: those that the tiles keep, and those of the seam. Both are in
/// that order, so parts of a tile's pieces are merged with those of the seam that lie between, each by a thread.
class PieceWriter {
 public:
  PieceWriter(const GridInput& input, const std::vector<WrittenTile>& tiles) : input_(input), tiles_(tiles) {}

  void write(ForestResult& result) {
    std::vector<Merged> parts;
    for (const WrittenTile& tile : tiles_)
      for (const Range& range : ranges(tile)) parts.push_back({range, {}, {}, {}});
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
  /// Pieces of a tile, and pieces of the seam that begin there.
  struct Range {
    const WrittenTile* from;
    std::size_t first, end, first_of_seam, end_of_seam;
  };
  struct Merged {
    Range range;
    std::vector<Constraint> ends;
    std::vector<std::uint32_t> begins, sources;
  };

  std::vector<Range> ranges(const WrittenTile& tile) const {
    constexpr std::size_t of_part = 1u << 10;
    const std::size_t count = tile.tile.pieces.size(), parts = count / of_part + 1;
    std::vector<Range> all;
    for (std::size_t i = 0; i < parts; ++i) {
      const std::size_t first = count * i / parts, end = count * (i + 1) / parts;
      const std::size_t of_seam = i == 0 ? 0 : of_seam_before(tile, tile.tile.piece_ids[first]);
      if (!all.empty()) all.back().end_of_seam = of_seam;
      all.push_back({&tile, first, end, of_seam, tile.seam.pieces.size()});
    }
    return all;
  }

  /// How many pieces of the seam come before a piece of the tile.
  std::size_t of_seam_before(const WrittenTile& tile, const Constraint& ends) const {
    const auto& keys = tile.seam.piece_keys;
    return static_cast<std::size_t>(std::lower_bound(keys.begin(), keys.end(), key_of(ends)) - keys.begin());
  }

  void merge(Merged& part) const {
    const Range& range = part.range;
    const SolvedTile& tile = range.from->tile;
    const Returned& seam = range.from->seam;
    std::size_t next = range.first_of_seam;
    for (std::size_t piece = range.first; piece < range.end; ++piece) {
      if (tile.kept[piece] == 0) continue;
      if (next < range.end_of_seam) {
        const Key here = key_of(tile.piece_ids[piece]);
        while (next < range.end_of_seam && seam.piece_keys[next] < here) add_of_seam(seam, next++, part);
      }
      part.ends.push_back(tile.piece_ids[piece]);
      part.begins.push_back(static_cast<std::uint32_t>(part.sources.size()));
      part.sources.insert(part.sources.end(), tile.sources.begin() + tile.source_offsets[piece],
                          tile.sources.begin() + tile.source_offsets[piece + 1]);
    }
    while (next < range.end_of_seam) add_of_seam(seam, next++, part);
  }

  Key key_of(const Constraint& ends) const { return {code_of(input_.at(ends[0])), code_of(input_.at(ends[1]))}; }

  static void add_of_seam(const Returned& seam, std::size_t piece, Merged& part) {
    part.ends.push_back(seam.pieces[piece]);
    part.begins.push_back(static_cast<std::uint32_t>(part.sources.size()));
    part.sources.insert(part.sources.end(), seam.sources.begin() + seam.source_offsets[piece],
                        seam.sources.begin() + seam.source_offsets[piece + 1]);
  }

  const GridInput& input_;
  const std::vector<WrittenTile>& tiles_;
};

}  // namespace

void join(const GridInput& input, const std::vector<WrittenTile>& tiles, bool check, ForestResult& result) {
  for (const WrittenTile& tile : tiles) {
    SeamWriter writer(input, tile, tiles.front().first, result);
    writer.write();
    if (check) writer.check();
  }
  PieceWriter(input, tiles).write(result);
}

}  // namespace gcdt::tiles

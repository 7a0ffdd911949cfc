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

  /// What the tile was told.
  void write(bool check) const {
    const Returned& seam = tile_.seam;
    for_each_in_threads(seam.triangles.size(),
                        [&](std::size_t i) { write(static_cast<std::uint32_t>(i), seam.triangles[i]); });
    for_each_in_threads(
        seam.across.size(), [&](std::size_t i) { write(seam.across[i], check); }, 256);
  }

  void write(std::uint32_t number, const SeamTriangle& triangle) const {
    const std::size_t at = first_ + tile_.before[number] + number;
    triangles_[at] = triangle.corners;
    neighbours_[at] = triangle.neighbours;
    constrained_[at] = static_cast<std::uint8_t>(triangle.constrained);
  }

  void write(const Across& across, bool check) const {
    const std::size_t t = at_final(across);
    neighbours_[t][across.k] = static_cast<std::int32_t>(across.place);
    if (!check || (constrained_[t] >> across.k & 1) != 0) return;
    const auto at = [&](std::uint32_t turn) { return vertex_at(input_.at(triangles_[t][(across.k + turn) % 3])); };
    if (device::gcdt_must_flip(at(1), vertex_at(across.apex), at(2), at(0)))
      throw Error(Status::check_failed, "tiles: an edge between a tile and the seam is not locally Delaunay");
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

/// Writes what it is given.
class Joiner final : public SeamTaker {
 public:
  Joiner(const std::vector<SeamWriter>& tiles, const std::vector<Seam::Border>& border, bool check)
      : tiles_(tiles), border_(border), check_(check) {}
  void take(std::size_t tile, std::uint32_t number, const SeamTriangle& triangle) override {
    tiles_[tile].write(number, triangle);
  }
  void take(std::uint32_t border, const Across& across) override { tiles_[border_[border].tile].write(across, check_); }

 private:
  const std::vector<SeamWriter>& tiles_;
  const std::vector<Seam::Border>& border_;
  const bool check_;
};

/// The pieces of the result, in Z-order of their ends: those that the tiles keep, and those of the seam. Both are in
/// that order, so parts of a tile's pieces are merged with those of the seam that lie between, each by a thread.
class PieceWriter {
 public:
  PieceWriter(const GridInput& input, const std::vector<WrittenTile>& tiles) : input_(input), tiles_(tiles) {}

  void write(ForestResult& result) {
    std::vector<Range> parts;
    for (const WrittenTile& tile : tiles_)
      for (const Range& range : ranges(tile)) parts.push_back(range);
    std::vector<Counts> before(parts.size() + 1, Counts{0, 0});
    for_each_in_threads(
        parts.size(), [&](std::size_t i) { before[i + 1] = counts_of(parts[i]); }, 1);
    for (std::size_t i = 0; i < parts.size(); ++i)
      before[i + 1] = {before[i][0] + before[i + 1][0], before[i][1] + before[i + 1][1]};
    const Target to = {room<Constraint>(result, GCDT_PIECES, before.back()[0]),
                       room<std::uint32_t>(result, GCDT_SOURCE_OFFSETS, before.back()[0] + 1),
                       room<std::uint32_t>(result, GCDT_SOURCES, before.back()[1])};
    for_each_in_threads(
        parts.size(), [&](std::size_t i) { merge(parts[i], before[i], to); }, 1);
    to.offsets[before.back()[0]] = static_cast<std::uint32_t>(before.back()[1]);
  }

 private:
  using Counts = std::array<std::size_t, 2>;  ///< pieces and sources
  /// Pieces of a tile, and pieces of the seam that begin there.
  struct Range {
    const WrittenTile* from;
    std::size_t first, end, first_of_seam, end_of_seam;
  };
  struct Target {
    Constraint* ends;
    std::uint32_t *offsets, *sources;
    void add(const Constraint& piece, Span<std::uint32_t> from, Counts& at) const {
      ends[at[0]] = piece;
      offsets[at[0]++] = static_cast<std::uint32_t>(at[1]);
      for (const std::uint32_t c : from) sources[at[1]++] = c;
    }
  };

  std::vector<Range> ranges(const WrittenTile& tile) const {
    constexpr std::size_t of_part = 1u << 10;
    const std::size_t count = tile.tile.pieces.size(), parts = count / of_part + 1;
    std::vector<Range> all;
    for (std::size_t i = 0; i < parts; ++i) {
      const std::size_t first = count * i / parts, end = count * (i + 1) / parts;
      const std::size_t of_seam = i == 0 ? 0 : of_seam_before(tile, first);
      if (!all.empty()) all.back().end_of_seam = of_seam;
      all.push_back({&tile, first, end, of_seam, tile.seam.pieces.size()});
    }
    return all;
  }

  /// How many pieces of the seam come before the tile's kept pieces from `first` on: all, if there are none. Ends: the
  /// tile has finitely many, and the range halves.
  std::size_t of_seam_before(const WrittenTile& tile, std::size_t first) const {
    while (first < tile.tile.pieces.size() && tile.tile.kept[first] == 0) ++first;
    std::size_t least = 0, end = tile.seam.pieces.size();
    if (first == tile.tile.pieces.size()) return end;
    const Key here = key_of(tile.tile.pieces[first]);
    while (least < end) {
      const std::size_t middle = least + (end - least) / 2;
      if (key_of_seam(tile.seam, middle) < here)
        least = middle + 1;
      else
        end = middle;
    }
    return least;
  }

  static Counts counts_of(const Range& range) {
    const SolvedTile& tile = range.from->tile;
    const auto& offsets = range.from->seam.source_offsets;
    Counts counts = {range.end_of_seam - range.first_of_seam,
                     std::size_t{offsets[range.end_of_seam]} - offsets[range.first_of_seam]};
    for (std::size_t piece = range.first; piece < range.end; ++piece)
      if (tile.kept[piece] != 0) ++counts[0], counts[1] += tile.sources_of(piece).size();
    return counts;
  }

  /// `at`: how many pieces and sources come before the range.
  void merge(const Range& range, Counts at, const Target& to) const {
    const SolvedTile& tile = range.from->tile;
    const Returned& seam = range.from->seam;
    std::size_t next = range.first_of_seam;
    const auto add_of_seam = [&] {
      const std::uint32_t begin = seam.source_offsets[next], end = seam.source_offsets[next + 1];
      to.add(seam.pieces[next++], {seam.sources.data() + begin, end - begin}, at);
    };
    for (std::size_t piece = range.first; piece < range.end; ++piece) {
      if (tile.kept[piece] == 0) continue;
      if (next < range.end_of_seam) {
        const Key here = key_of(tile.pieces[piece]);
        while (next < range.end_of_seam && key_of_seam(seam, next) < here) add_of_seam();
      }
      to.add(tile.pieces[piece], tile.sources_of(piece), at);
    }
    while (next < range.end_of_seam) add_of_seam();
  }

  Key key_of_seam(const Returned& seam, std::size_t piece) const {
    return seam.piece_keys.empty() ? key_of(seam.pieces[piece]) : seam.piece_keys[piece];
  }
  Key key_of(const Constraint& ends) const { return {code_of(input_.at(ends[0])), code_of(input_.at(ends[1]))}; }

  const GridInput& input_;
  const std::vector<WrittenTile>& tiles_;
};

}  // namespace

void join(const GridInput& input, const std::vector<WrittenTile>& tiles, bool check, ForestResult& result,
          const std::vector<Seam::Border>& border, const std::function<void(SeamTaker& to)>& give) {
  std::vector<SeamWriter> writers;
  for (const WrittenTile& tile : tiles) {
    writers.emplace_back(input, tile, tiles.front().first, result);
    writers.back().write(check);
  }
  if (give) {
    Joiner joiner(writers, border, check);
    give(joiner);
  }
  PieceWriter(input, tiles).write(result);
}

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
#include "tiles/join.hpp"

#include "device/parts.hpp"

namespace gcdt::tiles {

namespace {

using Key = SeamKeys::value_type;  // of a piece: the codes of its ends

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

/// The pieces of the result that begin in one tile, in Z-order of their ends: the tile's own, and the seam's among
/// them.
class PieceWriter {
 public:
  PieceWriter(const GridInput& input, const WrittenTile& tile)
      : input_(input), pieces_(tile.pieces), seam_(pieces_.of_seam), to_(pieces_.to), final_(tile.tile.final.pieces) {}

  void write() {
    if (pieces_.are_written) return write_of_seam();
    own_ = final_.is_spilled() ? final_.take(input_.n(), input_.constraints.count) : HostPieces{};
    merge();
  }

 private:
  /// The seam's alone. What the device says of the tile's is within bounds (FinalPieces::write()).
  void write_of_seam() const {
    for_each_in_threads(seam_.pieces.size(), [&](std::size_t i) {
      add_of_seam(i, pieces_.before.pieces[i] + i, pieces_.before.sources[i] + seam_.source_offsets[i]);
    });
  }

  /// Parts of the tile's pieces are merged with those of the seam that lie between, each by a thread.
  void merge() const {
    constexpr std::size_t of_part = 1u << 10;
    const std::size_t count = own_.ends.size(), parts = count / of_part + 1;
    for_each_in_threads(
        parts,
        [&](std::size_t part) {
          const std::size_t first = count * part / parts, end = count * (part + 1) / parts;
          merge(first, end, part == 0 ? 0 : of_seam_before(first),
                part + 1 == parts ? seam_.pieces.size() : of_seam_before(end));
        },
        1);
  }

  void merge(std::size_t first, std::size_t end, std::size_t first_of_seam, std::size_t end_of_seam) const {
    std::size_t next = first_of_seam;
    const auto place_sources = [&](std::size_t piece) { return own_.offset(piece) + seam_.source_offsets[next]; };
    for (std::size_t piece = first; piece < end; ++piece) {
      if (next < end_of_seam) {
        const Key here = key_of(own_.ends[piece]);
        for (; next < end_of_seam && key_of_seam(next) < here; ++next)
          add_of_seam(next, piece + next, place_sources(piece));
      }
      add(piece + next, place_sources(piece), own_.ends[piece], own_.sources_of(piece));
    }
    for (; next < end_of_seam; ++next) add_of_seam(next, end + next, place_sources(end));
  }

  /// How many pieces of the seam come before the tile's from `first` on. Ends: the range halves.
  std::size_t of_seam_before(std::size_t first) const {
    std::size_t least = 0, end = seam_.pieces.size();
    const Key here = key_of(own_.ends[first]);
    while (least < end) {
      const std::size_t middle = least + (end - least) / 2;
      if (key_of_seam(middle) < here)
        least = middle + 1;
      else
        end = middle;
    }
    return least;
  }

  void add_of_seam(std::size_t number, std::size_t at, std::size_t at_source) const {
    const std::uint32_t begin = seam_.source_offsets[number], end = seam_.source_offsets[number + 1];
    add(at, at_source, seam_.pieces[number], {seam_.sources.data() + begin, end - begin});
  }
  void add(std::size_t at, std::size_t at_source, const Constraint& ends, Span<std::uint32_t> sources) const {
    to_.ends[at] = ends;
    to_.offsets[at] = to_.first_source + static_cast<std::uint32_t>(at_source);
    std::copy(sources.begin(), sources.end(), to_.sources + at_source);
  }

  Key key_of_seam(std::size_t piece) const {
    return seam_.keys.empty() ? key_of(seam_.pieces[piece]) : seam_.keys[piece];
  }
  Key key_of(const Constraint& ends) const { return {code_of(input_.at(ends[0])), code_of(input_.at(ends[1]))}; }

  const GridInput& input_;
  const TilePieces& pieces_;
  const SeamPieces& seam_;
  const PieceBerth to_;
  FinalPieces& final_;
  HostPieces own_;
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
  for (const WrittenTile& tile : tiles) PieceWriter(input, tile).write();
}

void make_room_for_pieces(const std::vector<SolvedTile>& tiles, std::size_t first_tile, std::vector<TilePieces>& pieces,
                          ForestResult& result) {
  std::size_t count = 0, sources = 0;
  std::vector<std::array<std::size_t, 2>> firsts;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const FinalPieces& own = tiles[first_tile + i].final.pieces;
    firsts.push_back({count, sources});
    count += own.count + pieces[i].of_seam.pieces.size();
    sources += own.source_count + pieces[i].of_seam.sources.size();
  }
  auto* ends = room<Constraint>(result, GCDT_PIECES, count);
  auto* offsets = room<std::uint32_t>(result, GCDT_SOURCE_OFFSETS, count + 1);
  auto* all_sources = room<std::uint32_t>(result, GCDT_SOURCES, sources);
  offsets[count] = static_cast<std::uint32_t>(sources);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto [first, first_source] = firsts[i];
    pieces[i].to = {ends + first, offsets + first, all_sources + first_source,
                    static_cast<std::uint32_t>(first_source)};
  }
}

SeamKeys keys_of(const GridInput& input, const SeamPieces& pieces) {
  if (!pieces.keys.empty()) return pieces.keys;
  SeamKeys keys(pieces.pieces.size());
  for_each_in_threads(keys.size(), [&](std::size_t i) {
    const Constraint& ends = pieces.pieces[i];
    keys[i] = {code_of(input.at(ends[0])), code_of(input.at(ends[1]))};
  });
  return keys;
}

}  // namespace gcdt::tiles

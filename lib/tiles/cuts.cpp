// SPDX-License-Identifier: Apache-2.0
#include "tiles/cuts.hpp"

#include <algorithm>
#include <limits>

#include "device/parts.hpp"

namespace gcdt::tiles {

namespace {

// A tile's share of n points is off by about sqrt(1 / sample) of n, half the slack of two tiles.
constexpr std::size_t sample_size = 1u << 14;

/// Puts the sample's codes at which the tiles between `first` and `end` begin where they are in its order; those of
/// these two are there already. A sort would order all the others, too. Ends: both halves have fewer tiles.
template <class BeginOf>
void select_cuts(std::vector<std::uint64_t>& sample, std::size_t first, std::size_t end, BeginOf&& begin_of) {
  if (end - first < 2) return;
  const std::size_t middle = first + (end - first) / 2;
  const auto at = [&](std::size_t place) { return sample.begin() + static_cast<std::ptrdiff_t>(place); };
  const std::size_t from = first == 0 ? 0 : begin_of(first) + 1;
  if (begin_of(middle) >= from && begin_of(middle) < begin_of(end))
    std::nth_element(at(from), at(begin_of(middle)), at(begin_of(end)));
  select_cuts(sample, first, middle, begin_of);
  select_cuts(sample, middle, end, begin_of);
}

/// The code c that ends in most zeros, of those with low < c <= high.
std::uint64_t roundest(std::uint64_t low, std::uint64_t high) {
  std::uint64_t zeros = 0;
  // Ends: a number without any bit is not above `low`.
  for (std::uint64_t more = 1; (high & ~more) > low; more = more << 1 | 1) zeros = more;
  return high & ~zeros;
}

/// Of codes in the sample's parts between even cuts, the cut that is best for tile t.
template <class BeginOf>
std::uint64_t best_cut(std::vector<std::uint64_t>& sample, std::size_t tile, std::size_t tiles, BeginOf&& begin_of) {
  const auto at = [&](std::size_t place) { return sample.begin() + static_cast<std::ptrdiff_t>(place); };
  const std::size_t begin = begin_of(tile), slack = slack_of_cut(sample.size(), tiles);
  const std::uint64_t even = sample[begin];
  if (slack == 0) return even;
  // Both are within the parts beside the cut, which have several times as many.
  std::nth_element(at(begin_of(tile - 1)), at(begin - slack), at(begin));
  std::nth_element(at(begin), at(begin + slack), at(begin_of(tile + 1)));
  const std::uint64_t low = sample[begin - slack], high = sample[begin + slack];
  return low < even ? roundest(low, high) : even;
}

}  // namespace

std::size_t Cuts::tile_of(std::uint64_t code) const {
  return static_cast<std::size_t>(std::upper_bound(first_codes_.begin(), first_codes_.end(), code) -
                                  first_codes_.begin());
}

std::array<std::size_t, 2> Cuts::tiles_of(const Box& box) const {
  const auto tile_at = [&](const std::array<std::int64_t, 2>& corner) {
    return tile_of(code_of({static_cast<std::int32_t>(corner[0]), static_cast<std::int32_t>(corner[1])}));
  };
  return {tile_at(box.least), tile_at(box.most)};
}

std::array<std::uint64_t, 2> Cuts::codes_of(std::size_t tile) const {
  const std::uint64_t first = tile == 0 ? 0 : first_codes_[tile - 1];
  if (tile == first_codes_.size()) return {first, std::numeric_limits<std::uint64_t>::max()};
  if (first_codes_[tile] == 0) return {1, 0};
  return {first, first_codes_[tile] - 1};
}

// Codes of the same leading bits are a box. Ends: the blocks, of which the range is made, grow until none twice as
// large begins where one ends, then shrink.
std::optional<Box> Cuts::box_of(std::size_t tile) const {
  constexpr std::uint64_t last_code = (std::uint64_t{1} << GCDT_MORTON_BITS) - 1;
  const auto [first, last_of_tile] = codes_of(tile);
  const std::uint64_t last = std::min(last_of_tile, last_code);
  std::optional<Box> box;
  for (std::uint64_t begin = first; begin <= last;) {
    std::uint64_t beyond = 0;  // the block's codes begin .. begin + beyond
    // Ends: `beyond` gets a bit more each time, up to that of `last`.
    while ((begin & (beyond << 1 | 1)) == 0 && (beyond << 1 | 1) <= last - begin) beyond = beyond << 1 | 1;
    const GridPoint least = point_of(begin), most = point_of(begin + beyond);
    if (!box) box = Box{{least[0], least[1]}, {most[0], most[1]}};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      box->least[axis] = std::min<std::int64_t>(box->least[axis], least[axis]);
      box->most[axis] = std::max<std::int64_t>(box->most[axis], most[axis]);
    }
    begin += beyond + 1;
  }
  return box;
}

Cuts even_cuts(const GridInput& input, std::size_t tiles, Team& team) {
  const std::size_t n = input.given.count, count = std::min(n, std::max(sample_size, 256 * tiles));
  // Vertex n i / count is the sample's number i, and a rank has those from `first` on.
  const auto first_of = [&](std::uint64_t vertex) { return n == 0 ? 0 : (vertex * count + n - 1) / n; };
  const std::size_t first = first_of(input.given.first), end = first_of(input.given.first + input.given.points.size());
  std::vector<std::uint64_t> sample(end - first);
  for_each_in_threads(sample.size(), [&](std::size_t i) { sample[i] = code_of(input.at(n * (first + i) / count)); });
  gather(team, sample);
  std::vector<std::uint64_t> first_codes;
  if (team.is_first() && count > 0) {
    const auto begin_of = [&](std::size_t tile) { return count * tile / tiles; };
    select_cuts(sample, 0, tiles, begin_of);
    for (std::size_t t = 1; t < tiles; ++t) first_codes.push_back(best_cut(sample, t, tiles, begin_of));
  } else if (team.is_first()) {
    first_codes.assign(tiles - 1, 0);
  }
  broadcast(team, first_codes);
  return Cuts(std::move(first_codes));
}

}  // namespace gcdt::tiles

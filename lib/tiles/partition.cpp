// SPDX-License-Identifier: Apache-2.0
#include "tiles/partition.hpp"

#include <algorithm>
#include <limits>

#include "device/parts.hpp"

namespace gcdt::tiles {

namespace {

/// A tile's part of all constraints is off by about sqrt(1 / sample).
constexpr std::size_t constraints_sampled = std::size_t{1} << 12;
/// Of those, a thread looks at so many: each takes a few misses of the caches.
constexpr std::size_t count_of_sample_thread = 512;

constexpr std::uint16_t open_constraint = std::numeric_limits<std::uint16_t>::max();

Role role_of(const std::vector<Role>& roles, std::size_t constraint) {
  return roles.empty() ? Role::any : roles[constraint];
}

Box box_between(const GridPoint& a, const GridPoint& b) {
  Box box{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    box.least[axis] = std::min(a[axis], b[axis]);
    box.most[axis] = std::max(a[axis], b[axis]);
  }
  return box;
}

/// How many elements of each tile come before each part: a counting sort by parts, which keeps the order within a tile.
/// A part's thread counts in an array of its own making: one that lies beside another thread's would go to and fro
/// between their caches with each element.
class Places {
 public:
  Places(const Parts& parts, std::size_t tiles) : tiles_(tiles), counts_(parts.size()) {}
  void set(std::size_t part, std::vector<std::size_t> counts) { counts_[part] = std::move(counts); }
  /// When those are places: where the part writes its next of each tile.
  std::vector<std::size_t> take(std::size_t part) const { return counts_[part]; }
  /// Turns counts into places; returns the elements of each tile.
  std::vector<std::size_t> add_up() {
    std::vector<std::size_t> all(tiles_, 0);
    for (std::vector<std::size_t>& part : counts_)
      for (std::size_t t = 0; t < all.size(); ++t) {
        const std::size_t count = part[t];
        part[t] = all[t];
        all[t] += count;
      }
    return all;
  }

 private:
  std::size_t tiles_;
  std::vector<std::vector<std::size_t>> counts_;
};

/// The tile that has all of the constraint, or open_constraint.
std::uint16_t tile_of_constraint(const GridInput& input, const Cuts& cuts, std::size_t c) {
  const GridPoint a = input.end_of(c, 0), b = input.end_of(c, 1);
  const std::size_t t = cuts.tile_of(code_of(a));
  if (cuts.tile_of(code_of(b)) != t) return open_constraint;
  const auto [first, last] = cuts.tiles_of(box_between(a, b));
  return first == t && last == t ? static_cast<std::uint16_t>(t) : open_constraint;
}

void share_constraints(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles, Partition& made) {
  const GivenConstraints& constraints = input.constraints;
  const Parts parts(constraints.size());
  Places places(parts, cuts.tiles());
  Array<std::uint16_t> tile_of(constraints.size());
  std::vector<std::vector<OpenConstraint>> open(parts.size());
  const auto left_out = [&](std::size_t c) { return role_of(roles, c) == Role::out; };
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    std::vector<std::size_t> counts(cuts.tiles(), 0);
    std::vector<OpenConstraint> passing;
    for (std::size_t c = first; c < end; ++c) {
      if (left_out(c)) continue;
      tile_of[c] = role_of(roles, c) == Role::wide ? open_constraint : tile_of_constraint(input, cuts, c);
      if (tile_of[c] == open_constraint)
        passing.push_back(
            {static_cast<std::uint32_t>(c), constraints.ends[c], {input.end_of(c, 0), input.end_of(c, 1)}});
      else
        ++counts[tile_of[c]];
    }
    places.set(part, std::move(counts));
    open[part] = std::move(passing);
  });
  for (const auto& some : open) made.open.insert(made.open.end(), some.begin(), some.end());
  const std::vector<std::size_t> counts = places.add_up();
  for (std::size_t t = 0; t < cuts.tiles(); ++t) {
    made.tiles[t].constraints.resize(counts[t]);
    made.tiles[t].constraint_ids.resize(counts[t]);
  }
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    std::vector<std::size_t> next = places.take(part);
    for (std::size_t c = first; c < end; ++c) {
      if (left_out(c) || tile_of[c] == open_constraint) continue;
      Share& tile = made.tiles[tile_of[c]];
      const std::size_t at = next[tile_of[c]]++;
      tile.constraints[at] = constraints.ends[c];
      tile.constraint_ids[at] = constraints.number_of(c);
    }
  });
}

/// Open constraints by tile through which they may pass, with their ends. They have their places as numbers, and get
/// their numbers.
void share_open(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles, Partition& made) {
  for (OpenConstraint& open : made.open) {
    const bool wide = role_of(roles, open.number) == Role::wide;
    open.number = input.constraints.number_of(open.number);
    const Constraint& ends = open.ends;
    const std::array<GridPoint, 2>& points = open.points;
    Box box = box_between(points[0], points[1]);
    for (std::size_t axis = 0; axis < 2; ++axis) {  // a route is less than one cell away
      box.least[axis] = std::max<std::int64_t>(box.least[axis] - 1, 0);
      box.most[axis] = std::min<std::int64_t>(box.most[axis] + 1, GCDT_GRID_LAST);
    }
    const auto [first, last] = cuts.tiles_of(box);
    for (std::size_t t = first; t <= last; ++t) {
      Share& tile = made.tiles[t];
      tile.passages.push_back({ends[0], ends[1], wide});
      for (std::size_t end = 0; end < 2; ++end)
        if (cuts.tile_of(code_of(points[end])) == t)
          tile.open_ends.push_back(ends[end]);
        else
          tile.foreign.push_back({ends[end], points[end]});
    }
  }
  for_each_in_threads(
      cuts.tiles(),
      [&](std::size_t t) {
        sort_unique(made.tiles[t].foreign);
        sort_unique(made.tiles[t].open_ends);
      },
      1);
}

/// Mixes the bits of a number (splitmix64).
std::uint64_t mixed(std::uint64_t number) {
  number += 0x9E3779B97F4A7C15u;
  number = (number ^ number >> 30) * 0xBF58476D1CE4E5B9u;
  number = (number ^ number >> 27) * 0x94D049BB133111EBu;
  return number ^ number >> 31;
}

}  // namespace

// From a sample, of those that have both ends in one tile. One of each of so many parts that follow each other, and not
// at the same place in each: maps may have a pattern of any length. Tiles that have about as many are said to have the
// same number, since the largest are solved first, and what comes in another order than it lies in the result waits in
// memory of its own when it leaves a device (docs/scale.md, T7).
std::vector<std::uint64_t> expected_constraints(const GridInput& input, const Cuts& cuts) {
  const std::size_t m = input.constraints.size(), count = std::min(m, constraints_sampled);
  std::vector<std::uint64_t> expected(cuts.tiles(), 0);
  if (count == 0) return expected;
  std::vector<std::uint16_t> tile_of(count);
  for_each_in_threads(
      count,
      [&](std::size_t i) {
        const std::size_t first = m * i / count, end = m * (i + 1) / count, c = first + mixed(i) % (end - first);
        const std::size_t t = cuts.tile_of(code_of(input.end_of(c, 0)));
        const bool is_own = cuts.tile_of(code_of(input.end_of(c, 1))) == t;
        tile_of[i] = is_own ? static_cast<std::uint16_t>(t) : open_constraint;
      },
      count_of_sample_thread);
  for (const std::uint16_t t : tile_of)
    if (t != open_constraint) ++expected[t];
  const std::size_t even = m / cuts.tiles();
  for (std::uint64_t& own : expected) {
    own = m * own / count;
    if (own > even - even / 4 && own < even + even / 4) own = even;
  }
  return expected;
}

Partition partition_open(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles,
                         std::vector<OpenConstraint> open, const std::vector<std::uint64_t>& expected) {
  Partition made;
  made.tiles.resize(cuts.tiles());
  made.open = std::move(open);
  for (std::size_t t = 0; t < cuts.tiles(); ++t) made.tiles[t].expected = expected[t];
  share_open(input, cuts, roles, made);
  return made;
}

Partition partition(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles) {
  Partition made;
  made.tiles.resize(cuts.tiles());
  share_constraints(input, cuts, roles, made);
  share_open(input, cuts, roles, made);
  return made;
}

bool has_good_ends(const GridInput& input, std::size_t threads) {
  const std::uint64_t n = input.n();
  const Constraints ends = input.constraints.ends;
  const Parts parts(ends.size(), std::max<std::size_t>(4096, ends.size() / threads + 1));
  std::vector<char> good(parts.size(), 1);
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    std::uint32_t most = 0;
    for (std::size_t c = first; c < end; ++c) most = std::max({most, ends[c][0], ends[c][1]});
    good[part] = first == end || most < n;
  });
  return std::all_of(good.begin(), good.end(), [](char one) { return one != 0; });
}

std::uint64_t first_bad_end(const GridInput& input) {
  const std::uint64_t n = input.n();
  for (std::size_t c = 0; c < input.constraints.size(); ++c)
    for (std::size_t end = 0; end < 2; ++end)
      if (input.constraints.ends[c][end] >= n) return 2 * (input.constraints.first + c) + end;
  return std::numeric_limits<std::uint64_t>::max();
}

void sort_unique(std::vector<Foreign>& vertices) {
  std::sort(vertices.begin(), vertices.end(), [](const Foreign& a, const Foreign& b) { return a.vertex < b.vertex; });
  const auto same = [](const Foreign& a, const Foreign& b) { return a.vertex == b.vertex; };
  vertices.erase(std::unique(vertices.begin(), vertices.end(), same), vertices.end());
}

void sort_unique(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
#include "tiles/partition.hpp"

#include <limits>

#include "phases/clean.hpp"
#include "tiles/parts.hpp"

namespace gcdt::tiles {

namespace {

constexpr std::uint16_t open_constraint = std::numeric_limits<std::uint16_t>::max();

Box no_box() {
  const std::int64_t most = std::numeric_limits<std::int64_t>::max();
  return {{most, most}, {-1, -1}};
}

void extend(Box& box, const GridPoint& p) {
  for (int axis = 0; axis < 2; ++axis) {
    box.least[axis] = std::min<std::int64_t>(box.least[axis], p[axis]);
    box.most[axis] = std::max<std::int64_t>(box.most[axis], p[axis]);
  }
}

Box box_of(const GridInput& input, const Constraint& c) {
  Box box = no_box();
  for (const std::uint32_t end : c) extend(box, input.points[end]);
  return box;
}

Role role_of(const std::vector<Role>& roles, std::size_t constraint) {
  return roles.empty() ? Role::any : roles[constraint];
}

/// How many elements of each tile come before each part, and where a part writes its next: a counting sort by parts,
/// which keeps the order within a tile.
class Places {
 public:
  Places(const Parts& parts, std::size_t tiles) : counts_(parts.size(), std::vector<std::size_t>(tiles, 0)) {}
  std::size_t& next(std::size_t part, std::size_t tile) { return counts_[part][tile]; }
  /// Turns counts into places; returns the elements of each tile.
  std::vector<std::size_t> add_up() {
    std::vector<std::size_t> all(counts_[0].size(), 0);
    for (std::vector<std::size_t>& part : counts_)
      for (std::size_t t = 0; t < all.size(); ++t) {
        const std::size_t count = part[t];
        part[t] = all[t];
        all[t] += count;
      }
    return all;
  }

 private:
  std::vector<std::vector<std::size_t>> counts_;
};

void share_vertices(const GridInput& input, const Cuts& cuts, Partition& made) {
  const std::vector<GridPoint>& points = input.points;
  const Parts parts(points.size());
  Places places(parts, cuts.tiles());
  made.tile_of.resize(points.size());
  made.place.resize(points.size());
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    for (std::size_t v = first; v < end; ++v) {
      const std::size_t t = cuts.tile_of(code_of(points[v]));
      made.tile_of[v] = static_cast<std::uint16_t>(t);
      ++places.next(part, t);
    }
  });
  const std::vector<std::size_t> counts = places.add_up();
  for (std::size_t t = 0; t < cuts.tiles(); ++t) {
    made.tiles[t].own = static_cast<std::uint32_t>(counts[t]);
    made.tiles[t].points.resize(counts[t]);
    made.tiles[t].ids.resize(counts[t]);
  }
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    for (std::size_t v = first; v < end; ++v) {
      const std::size_t t = made.tile_of[v], at = places.next(part, t)++;
      made.tiles[t].points[at] = points[v];
      made.tiles[t].ids[at] = static_cast<std::uint32_t>(v);
      made.place[v] = static_cast<std::uint32_t>(at);
    }
  });
  made.box = no_box();
  for (Tile& tile : made.tiles) {
    tile.box = no_box();
    for (const GridPoint& p : tile.points) extend(tile.box, p);
    if (tile.own == 0) continue;
    for (int axis = 0; axis < 2; ++axis) {
      made.box.least[axis] = std::min(made.box.least[axis], tile.box.least[axis]);
      made.box.most[axis] = std::max(made.box.most[axis], tile.box.most[axis]);
    }
  }
}

void check_ends(const GridInput& input) {
  const std::size_t n = input.points.size();
  for (std::size_t c = 0; c < input.constraints.size(); ++c)
    for (std::size_t end = 0; end < 2; ++end)
      if (input.constraints[c][end] >= n) throw index_error(c, end, n);
}

/// The tile that has all of the constraint, or open_constraint.
std::uint16_t tile_of_constraint(const GridInput& input, const Cuts& cuts, const Partition& made, const Constraint& c) {
  const std::uint16_t t = made.tile_of[c[0]];
  if (made.tile_of[c[1]] != t) return open_constraint;
  const auto [first, last] = cuts.tiles_of(box_of(input, c));
  return first == t && last == t ? t : open_constraint;
}

void share_constraints(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles, Partition& made) {
  const Constraints constraints = input.constraints;
  const Parts parts(constraints.size());
  Places places(parts, cuts.tiles());
  std::vector<std::uint16_t> tile_of(constraints.size());
  std::vector<std::vector<std::uint32_t>> open(parts.size());
  const auto left_out = [&](std::size_t c) { return role_of(roles, c) == Role::out; };
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    for (std::size_t c = first; c < end; ++c) {
      if (left_out(c)) continue;
      tile_of[c] =
          role_of(roles, c) == Role::wide ? open_constraint : tile_of_constraint(input, cuts, made, constraints[c]);
      if (tile_of[c] == open_constraint)
        open[part].push_back(static_cast<std::uint32_t>(c));
      else
        ++places.next(part, tile_of[c]);
    }
  });
  for (const auto& some : open) made.open.insert(made.open.end(), some.begin(), some.end());
  const std::vector<std::size_t> counts = places.add_up();
  for (std::size_t t = 0; t < cuts.tiles(); ++t) {
    made.tiles[t].constraints.resize(counts[t]);
    made.tiles[t].constraint_ids.resize(counts[t]);
  }
  parts.run([&](std::size_t part, std::size_t first, std::size_t end) {
    for (std::size_t c = first; c < end; ++c) {
      if (left_out(c) || tile_of[c] == open_constraint) continue;
      Tile& tile = made.tiles[tile_of[c]];
      const std::size_t at = places.next(part, tile_of[c])++;
      tile.constraints[at] = {made.place[constraints[c][0]], made.place[constraints[c][1]]};
      tile.constraint_ids[at] = static_cast<std::uint32_t>(c);
    }
  });
}

/// Open constraints by tile through which they may pass, and the ends that these tiles lack.
void share_open(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles, Partition& made) {
  std::vector<std::vector<std::uint32_t>> passing(cuts.tiles());
  for (const std::uint32_t c : made.open) {
    Box box = box_of(input, input.constraints[c]);
    for (int axis = 0; axis < 2; ++axis) {  // a route is less than one cell away
      box.least[axis] = std::max<std::int64_t>(box.least[axis] - 1, 0);
      box.most[axis] = std::min<std::int64_t>(box.most[axis] + 1, GCDT_GRID_LAST);
    }
    const auto [first, last] = cuts.tiles_of(box);
    for (std::size_t t = first; t <= last; ++t)
      if (made.tiles[t].own > 0) passing[t].push_back(c);
  }
  for_each_in_threads(
      cuts.tiles(),
      [&](std::size_t t) {
        Tile& tile = made.tiles[t];
        std::vector<std::uint32_t> others;
        for (const std::uint32_t c : passing[t])
          for (const std::uint32_t end : input.constraints[c])
            if (made.tile_of[end] != t) others.push_back(end);
        std::sort(others.begin(), others.end());
        others.erase(std::unique(others.begin(), others.end()), others.end());
        for (const std::uint32_t v : others) {
          tile.points.push_back(input.points[v]);
          tile.ids.push_back(v);
        }
        const auto vertex = [&](std::uint32_t end) {
          if (made.tile_of[end] == t) return made.place[end];
          const auto found = std::lower_bound(others.begin(), others.end(), end);
          return tile.own + static_cast<std::uint32_t>(found - others.begin());
        };
        for (const std::uint32_t c : passing[t])
          tile.passages.push_back(
              {vertex(input.constraints[c][0]), vertex(input.constraints[c][1]), role_of(roles, c) == Role::wide});
      },
      1);
}

}  // namespace

Partition partition(const GridInput& input, const Cuts& cuts, const std::vector<Role>& roles) {
  Partition made;
  made.tiles.resize(cuts.tiles());
  share_vertices(input, cuts, made);
  check_ends(input);
  share_constraints(input, cuts, roles, made);
  share_open(input, cuts, roles, made);
  return made;
}

}  // namespace gcdt::tiles

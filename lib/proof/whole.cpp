// SPDX-License-Identifier: Apache-2.0
#include "proof/whole.hpp"

#include <numeric>

#include "proof/locate.hpp"
#include "proof/pixels.hpp"

namespace gcdt::proof {

namespace {

/// 0 to `count` - 1 in random order, in which few edges are crossed (Completion).
std::vector<std::uint32_t> shuffled(std::size_t count) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::minstd_rand random;
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

}  // namespace

std::string Rebuilt::run() {
  const std::string reason = crossing == Crossing::split ? insert_split() : insert_whole();
  if (reason.empty()) mesh->sort();
  return reason;
}

bool Rebuilt::insert(const Path& path) {
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    if (!mesh->constrain(path[i], path[i + 1])) return false;
  return true;
}

/// In random order, unless some are to be dropped: then in that of the input, which decides, whatever steps that
/// takes.
std::string Rebuilt::insert_whole() {
  std::vector<char> there(constraints.size());
  std::string reason = insert_ordered(shuffled(constraints.size()), there);
  if (!reason.empty() && crossing == Crossing::drop) {
    std::vector<std::uint32_t> order(constraints.size());
    std::iota(order.begin(), order.end(), 0u);
    insert_ordered(order, there);
    reason.clear();
  }
  for (std::size_t c = 0; c < constraints.size(); ++c)
    if (there[c]) paths.push_back({end(c, 0), end(c, 1)});
  return reason;
}

/// Marks those that do not cross earlier ones; names another one.
std::string Rebuilt::insert_ordered(const std::vector<std::uint32_t>& order, std::vector<char>& there) {
  mesh.emplace(sites, steps);
  std::string reason;
  for (const std::uint32_t c : order) {
    there[c] = end(c, 0) != end(c, 1) && mesh->constrain(end(c, 0), end(c, 1));
    if (!there[c] && end(c, 0) != end(c, 1))
      reason = say("constraint ", c, " (", end(c, 0), "-", end(c, 1), ") crosses another one");
  }
  return reason;
}

/// Routed constraints first; then those left straight that cross one are routed too. Ends: each round but the last
/// routes another.
std::string Rebuilt::insert_split() {
  const PixelTree tree(sites);
  const std::vector<Segment> segments = distinct_segments(sites, constraints);
  std::vector<bool> routed;
  if (auto reason = find_crossing(sites, tree, inputs, segments, routed); !reason.empty()) return reason;
  const auto path_of = [&](std::size_t s, std::uint32_t a, std::uint32_t b) {
    return routed[s] ? tree.along(a, b) : Path{a, b};
  };
  const std::vector<std::uint32_t> order = shuffled(segments.size());
  for (bool more = true; more;) {
    more = false;
    mesh.emplace(sites, steps);
    for (const bool now : {true, false})
      for (const std::uint32_t s : order) {
        if (routed[s] != now || insert(path_of(s, segments[s].a, segments[s].b))) continue;
        if (now) return say("the routes of constraint ", segments[s].constraint, " and of another one cross");
        routed[s] = more = true;
      }
  }
  const auto number_of = [&](std::uint32_t a, std::uint32_t b) {
    const auto less = [](const Segment& s, const std::array<std::uint32_t, 2>& ends) {
      return std::array{s.a, s.b} < ends;
    };
    return std::lower_bound(segments.begin(), segments.end(), std::array{std::min(a, b), std::max(a, b)}, less) -
           segments.begin();
  };
  for (std::size_t c = 0; c < constraints.size(); ++c)
    if (end(c, 0) != end(c, 1))
      paths.push_back(path_of(std::size_t(number_of(end(c, 0), end(c, 1))), end(c, 0), end(c, 1)));
  return {};
}
Flood::Flood(const Completion& mesh, const Mesh& proved, const std::vector<Path>& paths)
    : region(mesh.triangles().size(), none), mesh_(mesh) {
  for (std::uint32_t t = 0; t < region.size(); ++t)
    if (region[t] == none) fill(t, count++);
  turns_.assign(3 * region.size(), 0);
  for (const Path& path : paths)
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
      for (std::uint32_t v = path[i]; v != path[i + 1];) {
        const Mesh::Exit exit = proved.leave(v, path[i + 1]);
        const std::int32_t along = proved.from(exit.half_edge) == v ? 1 : -1;
        turns_[exit.half_edge] += along;
        if (mesh.twin(exit.half_edge) != none) turns_[mesh.twin(exit.half_edge)] -= along;
        v = exit.end;
      }
  search();
}

void Flood::fill(std::uint32_t first, std::uint32_t number) {
  std::vector<std::uint32_t> stack{first};
  region[first] = number;
  while (!stack.empty()) {
    const std::uint32_t t = stack.back();
    stack.pop_back();
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (mesh_.constrained(h) || mesh_.twin(h) == none || region[mesh_.twin(h) / 3] != none) continue;
      region[mesh_.twin(h) / 3] = number;
      stack.push_back(mesh_.twin(h) / 3);
    }
  }
}

/// Level by level from outside. A region's entry is the least half-edge that leads there from the level before:
/// the one on the near side, or in the hull the region's own. turns_[h]: how much more is on the left of h than
/// on its right.
void Flood::search() {
  depth.assign(count, none);
  winding.assign(count, 0);
  std::vector<std::vector<std::uint32_t>> borders(count);
  std::vector<std::uint32_t> entry(count, none), level;
  for (std::uint32_t h = 0; h < turns_.size(); ++h) {
    const std::uint32_t r = region[h / 3];
    if (mesh_.twin(h) != none) {
      if (mesh_.constrained(h) && region[mesh_.twin(h) / 3] != r) borders[r].push_back(h);
    } else if (mesh_.constrained(h)) {
      entry[r] = std::min(entry[r], h);
    } else if (depth[r] != 0) {
      depth[r] = 0;
      level.push_back(r);
    }
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t r = 0; r < count; ++r)
    if (entry[r] != none && depth[r] == none) found.push_back(r);
  for (std::uint32_t d = 0; d == 0 || !level.empty(); ++d) {
    for (const std::uint32_t r : level)
      for (const std::uint32_t h : borders[r]) {
        const std::uint32_t beyond = region[mesh_.twin(h) / 3];
        if (depth[beyond] != none) continue;
        if (entry[beyond] == none) found.push_back(beyond);
        entry[beyond] = std::min(entry[beyond], h);
      }
    for (const std::uint32_t r : found) {
      const std::uint32_t h = entry[r];
      depth[r] = d + 1;
      winding[r] = mesh_.twin(h) == none ? turns_[h] : winding[region[h / 3]] - turns_[h];
    }
    level.swap(found);
    found.clear();
  }
}

std::vector<std::uint32_t> seeded(const Sites& sites, const Completion& mesh, const Flood& flood, const Grid& grid,
                                  const std::vector<std::array<double, 2>>& seeds, std::uint64_t& steps) {
  std::vector<std::uint32_t> seed_of(flood.count, none), on_grid;
  std::vector<Vertex> places;
  for (std::uint32_t i = 0; i < seeds.size(); ++i)
    if (Vertex at; place_seed(seeds[i], grid, at)) places.push_back(at), on_grid.push_back(i);
  const std::vector<std::uint32_t> triangles = least_triangles(sites, mesh, places, steps);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (triangles[i] != none) {
      std::uint32_t& seed = seed_of[flood.region[triangles[i]]];
      seed = std::min(seed, on_grid[i]);
    }
  return seed_of;
}

namespace {

/// The regions with a hole seed.
std::vector<char> holed(const Sites& sites, const Completion& mesh, const Flood& flood, const Grid& grid,
                        const std::vector<std::array<double, 2>>& seeds, std::uint64_t& steps) {
  const std::vector<std::uint32_t> seed_of = seeded(sites, mesh, flood, grid, seeds, steps);
  std::vector<char> holes;
  for (const std::uint32_t seed : seed_of) holes.push_back(seed != none);
  return holes;
}

}  // namespace

std::vector<char> chosen(const Sites& sites, const Completion& mesh, const Flood& flood, const Grid& grid,
                         const Options& options, std::uint64_t& steps) {
  const bool by_holes = options.domain == Domain::holes || options.domain == Domain::outer_holes;
  const bool by_outer = options.domain == Domain::outer || options.domain == Domain::outer_holes;
  const auto holes =
      by_holes ? holed(sites, mesh, flood, grid, options.hole_seeds, steps) : std::vector<char>(flood.count);
  std::vector<char> keep(mesh.triangles().size());
  for (std::uint32_t t = 0; t < keep.size(); ++t) {
    const std::uint32_t r = flood.region[t];
    keep[t] = !holes[r] && !(by_outer && flood.depth[r] == 0) &&
              !(options.domain == Domain::even_odd && flood.winding[r] % 2 == 0) &&
              !(options.domain == Domain::nonzero && flood.winding[r] == 0);
  }
  return keep;
}

}  // namespace gcdt::proof

// SPDX-License-Identifier: Apache-2.0
// The host's proof of a domain: the whole mesh is made once more, by another algorithm, and proved as any mesh is;
// its regions are flooded one by one; what they leave must be the mesh that is to be verified.
#include "proof/domain.hpp"

#include <algorithm>
#include <numeric>

#include "proof/complete.hpp"
#include "proof/locate.hpp"
#include "proof/pixels.hpp"

namespace gcdt::proof {

namespace {

/// Vertices of the mesh, all representatives; between each and the next runs a straight chain of edges.
using Path = std::vector<std::uint32_t>;

/// The whole mesh, and the path of each constraint that is in it, from its first end to its second.
struct Rebuilt {
  const Sites& sites;
  const std::uint32_t inputs;
  const Constraints constraints;
  const Crossing crossing;
  std::uint64_t& steps;
  std::optional<Completion> mesh = {};
  std::vector<Path> paths = {};

  /// Returns the first failure.
  std::string run() {
    const std::string reason = crossing == Crossing::split ? insert_split() : insert_whole();
    if (reason.empty()) mesh->sort();
    return reason;
  }

  std::uint32_t end(std::size_t c, int k) const { return sites.representative[constraints[c][k]]; }

  bool insert(const Path& path) {
    for (std::size_t i = 0; i + 1 < path.size(); ++i)
      if (!mesh->constrain(path[i], path[i + 1])) return false;
    return true;
  }

  /// 0 to `count` - 1 in random order, in which few edges are crossed (Completion).
  static std::vector<std::uint32_t> shuffled(std::size_t count) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::minstd_rand random;
    std::shuffle(order.begin(), order.end(), random);
    return order;
  }

  /// In random order, unless some are to be dropped: then in that of the input, which decides, whatever steps that
  /// takes.
  std::string insert_whole() {
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
  std::string insert_ordered(const std::vector<std::uint32_t>& order, std::vector<char>& there) {
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
  std::string insert_split() {
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
};

/// The regions of a complete mesh in canonical order, with depths and windings.
class Flood {
 public:
  /// `proved`: the same mesh, half-edge by half-edge, after prove_topology().
  Flood(const Completion& mesh, const Mesh& proved, const std::vector<Path>& paths)
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

  std::vector<std::uint32_t> region, depth;  ///< by triangle; by region
  std::vector<std::int32_t> winding;         ///< by region
  std::uint32_t count = 0;

 private:
  void fill(std::uint32_t first, std::uint32_t number) {
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
  void search() {
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

  const Completion& mesh_;
  std::vector<std::int32_t> turns_;
};

/// The regions with a hole seed: that of the least triangle that holds it, border included.
std::vector<char> holed(const Sites& sites, const Completion& mesh, const Flood& flood, const Grid& grid,
                        const std::vector<std::array<double, 2>>& seeds, std::uint64_t& steps) {
  std::vector<char> holes(flood.count, 0);
  std::vector<Vertex> places;
  for (const auto& seed : seeds)
    if (Vertex at; place_seed(seed, grid, at)) places.push_back(at);
  for (const std::uint32_t t : least_triangles(sites, mesh, std::move(places), steps)) holes[flood.region[t]] = 1;
  return holes;
}

/// The triangle with its least corner first: a key that does not depend on the first corner.
std::array<std::uint32_t, 3> key_of(std::array<std::uint32_t, 3> corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

/// The mesh that is given, against the one that is right.
class Comparison {
 public:
  Comparison(const Completion& mesh, const Flood& flood, const std::vector<char>& keep, const MeshView& view)
      : mesh_(mesh), flood_(flood), view_(view), given_of_(mesh.triangles().size(), none) {
    for (std::uint32_t t = 0; t < given_of_.size(); ++t)
      if (keep[t]) expected_.push_back({key_of(mesh.triangles()[t]), t});
    std::sort(expected_.begin(), expected_.end());
  }

  std::string run(const RegionView& regions) {
    auto reason = match();
    for (std::uint32_t g = 0; g < view_.triangles.size() && reason.empty(); ++g) {
      reason = compare_edges(g);
      if (reason.empty()) reason = compare_region(g, regions);
    }
    return reason;
  }

 private:
  using Entry = std::pair<std::array<std::uint32_t, 3>, std::uint32_t>;

  std::string name(std::uint32_t g) const {
    const auto& [a, b, c] = view_.triangles[g];
    return say("triangle ", g, " (", a, ", ", b, ", ", c, ")");
  }

  std::string match() {
    for (std::uint32_t g = 0; g < view_.triangles.size(); ++g) {
      const auto key = key_of(view_.triangles[g]);
      const auto found = std::lower_bound(expected_.begin(), expected_.end(), Entry{key, 0});
      if (found == expected_.end() || found->first != key)
        return say(name(g), " is not one of the domain's in the constrained Delaunay triangulation");
      if (given_of_[found->second] != none) return say(name(g), " occurs twice");
      given_of_[found->second] = g;
      right_of_.push_back(found->second);
    }
    for (const auto& [key, t] : expected_)
      if (given_of_[t] == none)
        return say("the triangle (", key[0], ", ", key[1], ", ", key[2], ") belongs to the domain, but is missing");
    return {};
  }

  std::string compare_edges(std::uint32_t g) const {
    const auto& corners = mesh_.triangles()[right_of_[g]];
    if (view_.constrained && view_.constrained[g] > 7) return say(name(g), " has flags of edges it does not have");
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = view_.triangles[g][k];
      const auto j = static_cast<std::uint32_t>(std::find(corners.begin(), corners.end(), corner) - corners.begin());
      const std::uint32_t h = 3 * right_of_[g] + j, twin = mesh_.twin(h);
      const std::int64_t beyond = twin == none || given_of_[twin / 3] == none ? -1 : std::int64_t(given_of_[twin / 3]);
      if (view_.neighbours && view_.neighbours[g][k] != beyond)
        return say(name(g), ": the neighbour across from vertex ", corner, " is ", beyond, ", not ",
                   view_.neighbours[g][k]);
      if (view_.constrained && (view_.constrained[g] >> k & 1) != int(mesh_.constrained(h)))
        return say(name(g), ": the edge across from vertex ", corner, " is ",
                   mesh_.constrained(h) ? "constrained, but not flagged" : "flagged, but not constrained");
    }
    return {};
  }

  std::string compare_region(std::uint32_t g, const RegionView& given) const {
    const std::uint32_t r = flood_.region[right_of_[g]];
    if (given.region && given.region[g] != r) return say(name(g), " is in region ", r, ", not ", given.region[g]);
    if (given.depth && given.depth[g] != flood_.depth[r])
      return say(name(g), " has depth ", flood_.depth[r], ", not ", given.depth[g]);
    if (given.winding && given.winding[g] != flood_.winding[r])
      return say(name(g), " has winding number ", flood_.winding[r], ", not ", given.winding[g]);
    return {};
  }

  const Completion& mesh_;
  const Flood& flood_;
  const MeshView& view_;
  std::vector<Entry> expected_;
  std::vector<std::uint32_t> given_of_;  // by right triangle
  std::vector<std::uint32_t> right_of_;  // by given triangle
};

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

std::string prove(Points points, Constraints constraints, const MeshView& view, const RegionView& regions,
                  const Grid& grid, const Options& options, std::uint64_t& steps) {
  std::optional<Sites> placed;
  std::string reason = place_sites(points, constraints, view.added, grid, placed);
  if (!reason.empty()) return reason;
  const Sites& sites = *placed;
  if (sites.flat) return verify(points, constraints, view, grid, options.crossing).reason;
  Rebuilt rebuilt{sites, static_cast<std::uint32_t>(points.size()), constraints, options.crossing, steps};
  reason = rebuilt.run();
  if (!reason.empty()) return reason;
  const Completion& mesh = *rebuilt.mesh;
  MeshView whole;
  whole.triangles = mesh.triangles();
  whole.added = view.added;
  const Verification proved = verify(points, constraints, whole, grid, options.crossing);
  if (!proved.valid) return say("the whole mesh made for comparison is not valid: ", proved.reason);
  Mesh whole_mesh(sites, whole);
  whole_mesh.prove_topology();
  const Flood flood(mesh, whole_mesh, rebuilt.paths);
  return Comparison(mesh, flood, chosen(sites, mesh, flood, grid, options, steps), view).run(regions);
}

}  // namespace

Verification verify_domain(Points points, Constraints constraints, const MeshView& mesh, const RegionView& regions,
                           const Grid& grid, const Options& options, std::uint64_t* steps) {
  std::uint64_t taken = 0;
  const std::string reason = prove(points, constraints, mesh, regions, grid, options, taken);
  if (steps) *steps = taken;
  return {reason.empty(), reason};
}

}  // namespace gcdt::proof

// SPDX-License-Identifier: Apache-2.0
#include "tiles/domain.hpp"

#include <numeric>

#include "tiles/indices.hpp"
#include "tiles/seeds.hpp"

namespace gcdt::tiles {

namespace {

/// The search from outside, on the host. Node 0 is outside, r + 1 is region r; arcs are constrained half edges between
/// two nodes, in the direction in which they are crossed (kernels/domain/domain.cl).
class Selection {
 public:
  Selection(const GridInput& input, const ForestResult& joined)
      : input_(input),
        triangles_(array_of<Triangle>(joined, GCDT_TRIANGLES)),
        neighbours_(array_of<Neighbours>(joined, GCDT_NEIGHBOURS)),
        constrained_(array_of<std::uint8_t>(joined, GCDT_CONSTRAINED)),
        pieces_(array_of<Constraint>(joined, GCDT_PIECES)),
        offsets_(array_of<std::uint32_t>(joined, GCDT_SOURCE_OFFSETS)),
        sources_(array_of<std::uint32_t>(joined, GCDT_SOURCES)),
        half_edges_(static_cast<std::uint32_t>(3 * triangles_.size())) {
    if (!joined.begins[GCDT_ADDED].empty()) added_ = array_of<GridPoint>(joined, GCDT_ADDED);
  }

  void run() {
    check_numbers();
    label();
    count_turns();
    list_arcs();
    search();
    count_open();
  }

  std::uint32_t region_of(std::size_t triangle) const { return region_[triangle]; }
  std::uint32_t depth_of(std::size_t triangle) const { return depth_[region_[triangle] + 1]; }
  std::int32_t winding_of(std::size_t triangle) const { return winding_[region_[triangle] + 1]; }
  bool keeps(std::size_t triangle, Domain domain) const {
    switch (domain) {
      case Domain::even_odd: return (winding_of(triangle) & 1) != 0;
      case Domain::nonzero: return winding_of(triangle) != 0;
      case Domain::holes: return !is_hole_[region_[triangle]];
      case Domain::outer: return depth_of(triangle) != 0;
      case Domain::outer_holes: return depth_of(triangle) != 0 && !is_hole_[region_[triangle]];
      default: return true;
    }
  }
  /// The least seed of each region; `GCDT_NONE` without one.
  std::vector<std::uint32_t> seeded(const std::vector<std::array<double, 2>>& seeds) const {
    std::vector<std::optional<GridPoint>> places;
    for (const std::array<double, 2>& seed : seeds) places.push_back(place_query(input_.chosen, seed));
    const std::vector<std::uint32_t> triangles =
        least_triangles(places, triangles_.size(), GCDT_NONE, [&](std::size_t t) -> std::array<GridPoint, 3> {
          return {at(triangles_[t][0]), at(triangles_[t][1]), at(triangles_[t][2])};
        });
    std::vector<std::uint32_t> least(regions, GCDT_NONE);
    for (std::size_t i = triangles.size(); i-- > 0;)
      if (triangles[i] != GCDT_NONE) least[region_[triangles[i]]] = static_cast<std::uint32_t>(i);
    return least;
  }
  void mark_holes(const std::vector<std::array<double, 2>>& seeds) {
    is_hole_.clear();
    for (const std::uint32_t seed : seeded(seeds)) is_hole_.push_back(seed != GCDT_NONE);
  }
  std::uint32_t regions = 0, deepest = 0;
  std::uint64_t open_parity = 0, open_winding = 0;

 private:
  /// Devices have written what comes from now on as indices.
  void check_numbers() const {
    const std::uint64_t vertices = input_.n() + added_.size();
    const auto count = static_cast<std::int64_t>(triangles_.size());
    check_each(triangles_.size(), "a triangle has a corner or a neighbour that is not there", [&](std::size_t t) {
      bool fits = true;
      for (std::size_t k = 0; k < 3; ++k)
        fits = fits && triangles_[t][k] < vertices && neighbours_[t][k] >= -1 && neighbours_[t][k] < count;
      return fits;
    });
  }

  GridPoint at(std::uint32_t v) const {
    return v < input_.n() ? input_.at(v) : added_[static_cast<std::size_t>(v - input_.n())];
  }
  bool is_constrained(std::uint32_t h) const { return (constrained_[h / 3] >> (h % 3) & 1) != 0; }
  std::int32_t across(std::uint32_t h) const { return neighbours_[h / 3][h % 3]; }
  bool is_arc(std::uint32_t h) const {
    if (!is_constrained(h)) return false;
    const std::int32_t u = across(h);
    return u < 0 || region_[h / 3] != region_[static_cast<std::uint32_t>(u)];
  }
  std::uint32_t source_of(std::uint32_t h) const { return across(h) < 0 ? 0 : region_[h / 3] + 1; }
  std::uint32_t target_of(std::uint32_t h) const {
    return region_[across(h) < 0 ? h / 3 : static_cast<std::uint32_t>(across(h))] + 1;
  }

  /// Ends: labels fall.
  std::uint32_t root_of(std::uint32_t t) {
    while (region_[t] != t) t = region_[t] = region_[region_[t]];
    return t;
  }
  // The least triangle of a region is its root, so regions are numbered by their least triangles.
  void label() {
    const auto count = static_cast<std::uint32_t>(triangles_.size());
    region_.resize(count);
    std::iota(region_.begin(), region_.end(), 0u);
    for (std::uint32_t h = 0; h < half_edges_; ++h) {
      if (is_constrained(h) || across(h) < 0) continue;
      const std::uint32_t a = root_of(h / 3), b = root_of(static_cast<std::uint32_t>(across(h)));
      region_[std::max(a, b)] = std::min(a, b);
    }
    for (std::uint32_t t = 0; t < count; ++t) region_[t] = region_[t] == t ? regions++ : region_[region_[t]];
  }

  void count_turns() {
    turns_.resize(pieces_.size());
    for_each_in_threads(pieces_.size(), [&](std::size_t piece) {
      const GridPoint p = at(pieces_[piece][0]), q = at(pieces_[piece][1]);
      for (std::uint32_t i = offsets_[piece]; i < offsets_[piece + 1]; ++i) {
        const Constraint& c = input_.constraints.ends[sources_[i]];
        const GridPoint a = at(c[0]), b = at(c[1]);
        const std::int64_t along = (std::int64_t{b[0]} - a[0]) * (std::int64_t{q[0]} - p[0]) +
                                   (std::int64_t{b[1]} - a[1]) * (std::int64_t{q[1]} - p[1]);
        turns_[piece] += along > 0 ? 1 : -1;
      }
    });
  }

  void list_arcs() {
    begins_.assign(std::size_t{regions} + 2, 0);
    for (std::uint32_t h = 0; h < half_edges_; ++h)
      if (is_arc(h)) ++begins_[source_of(h) + 1];
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
    arcs_.resize(begins_.back());
    for (std::uint32_t h = 0; h < half_edges_; ++h)
      if (is_arc(h)) arcs_[next[source_of(h)]++] = h;
  }

  /// The winding number beyond half edge h less that on its triangle's side; of an edge of the hull, the other way.
  std::int32_t turn_across(std::uint32_t h) const {
    const Triangle& t = triangles_[h / 3];
    const std::uint32_t a = t[(h % 3 + 1) % 3], b = t[(h % 3 + 2) % 3];
    const std::uint32_t piece = piece_between(
        pieces_, [&](std::uint32_t v) { return at(v); }, a, b);
    const std::int32_t left_over_right = pieces_[piece][0] == a ? turns_[piece] : -turns_[piece];
    return across(h) < 0 ? left_over_right : -left_over_right;
  }

  /// Ends: every round but the last settles a node.
  void search() {
    const std::size_t nodes = std::size_t{regions} + 1;
    depth_.assign(nodes, GCDT_NONE);
    winding_.assign(nodes, 0);
    std::vector<std::uint32_t> entry(nodes, GCDT_NONE), frontier{0}, next;
    depth_[0] = 0;
    for (std::uint32_t h = 0; h < half_edges_; ++h) {
      const std::uint32_t node = region_[h / 3] + 1;
      if (across(h) >= 0 || is_constrained(h) || depth_[node] == 0) continue;
      depth_[node] = 0;
      frontier.push_back(node);
    }
    std::size_t settled = frontier.size();
    for (std::uint32_t d = 0; !frontier.empty(); ++d) {
      next.clear();
      for (const std::uint32_t node : frontier)
        for (std::uint32_t i = begins_[node]; i < begins_[node + 1]; ++i) {
          const std::uint32_t target = target_of(arcs_[i]);
          if (depth_[target] != GCDT_NONE) continue;
          if (entry[target] == GCDT_NONE) next.push_back(target);
          entry[target] = std::min(entry[target], arcs_[i]);
        }
      for (const std::uint32_t node : next) {
        depth_[node] = deepest = d + 1;
        winding_[node] = winding_[source_of(entry[node])] + turn_across(entry[node]);
      }
      settled += next.size();
      frontier.swap(next);
    }
    if (settled != nodes) throw Error(Status::check_failed, "domain: regions cannot be reached from outside");
  }

  // Each edge once: one of the hull has no twin, of two half edges that of the lesser triangle counts.
  void count_open() {
    for (std::uint32_t h = 0; h < half_edges_; ++h) {
      if (!is_constrained(h) || (across(h) >= 0 && static_cast<std::uint32_t>(across(h)) < h / 3)) continue;
      const std::int32_t differs = is_arc(h) ? winding_[target_of(h)] - winding_[source_of(h)] : 0;
      const std::int32_t wrong = differs - turn_across(h);
      open_winding += wrong != 0;
      open_parity += (wrong & 1) != 0;
    }
  }

  const GridInput& input_;
  Span<Triangle> triangles_;
  Span<Neighbours> neighbours_;
  Span<std::uint8_t> constrained_;
  Span<Constraint> pieces_;
  Span<std::uint32_t> offsets_, sources_;
  Span<GridPoint> added_;
  std::uint32_t half_edges_;
  std::vector<std::uint32_t> region_, begins_, arcs_, depth_;
  std::vector<std::int32_t> turns_, winding_;
  std::vector<char> is_hole_;  ///< by region
};

/// Keeps the elements of an array that have a place, in their order.
template <class T, class Change>
void keep(ForestResult& joined, std::int32_t array, const std::vector<std::int32_t>& places, std::size_t count,
          Change&& change) {
  const Span<T> all = array_of<T>(joined, array);
  HostArray kept;
  T* to = kept.make<T>(count);
  for_each_in_threads(all.size(), [&](std::size_t t) {
    if (places[t] >= 0) to[places[t]] = change(all[t]);
  });
  joined.arrays[static_cast<std::size_t>(array)] = std::move(kept);
  joined.begins[static_cast<std::size_t>(array)] = {0, count};
}

}  // namespace

void select_domain(const GridInput& input, const Options& options, ForestResult& joined) {
  Selection selection(input, joined);
  selection.run();
  selection.mark_holes(options.hole_seeds);
  const std::vector<std::uint32_t> seeds = selection.seeded(options.region_seeds);
  const std::size_t triangles = joined.begins[GCDT_TRIANGLES].back();
  std::vector<std::int32_t> places(triangles, -1);
  std::int32_t count = 0;
  for (std::size_t t = 0; t < triangles; ++t)
    if (selection.keeps(t, options.domain)) places[t] = count++;
  const auto kept = static_cast<std::size_t>(count);
  auto* region = room<std::uint32_t>(joined, GCDT_REGIONS, kept);
  auto* depth = room<std::uint32_t>(joined, GCDT_DEPTHS, kept);
  auto* winding = room<std::int32_t>(joined, GCDT_WINDINGS, kept);
  auto* seed = room<std::int32_t>(joined, GCDT_REGION_SEEDS, kept);
  for_each_in_threads(triangles, [&](std::size_t t) {
    if (places[t] < 0) return;
    region[places[t]] = selection.region_of(t);
    depth[places[t]] = selection.depth_of(t);
    winding[places[t]] = selection.winding_of(t);
    seed[places[t]] = static_cast<std::int32_t>(seeds[selection.region_of(t)]);  // none: -1
  });
  if (kept < triangles) {
    keep<Triangle>(joined, GCDT_TRIANGLES, places, kept, [](const Triangle& t) { return t; });
    keep<std::uint8_t>(joined, GCDT_CONSTRAINED, places, kept, [](std::uint8_t flags) { return flags; });
    keep<Neighbours>(joined, GCDT_NEIGHBOURS, places, kept, [&](Neighbours three) {
      for (std::int32_t& other : three) other = other < 0 ? -1 : places[static_cast<std::size_t>(other)];
      return three;
    });
  }
  Statistics& s = joined.statistics;
  s.triangles = kept;
  s.triangles_removed = triangles - kept;
  s.regions = selection.regions, s.deepest = selection.deepest;
  s.open_parity = selection.open_parity, s.open_winding = selection.open_winding;
}

}  // namespace gcdt::tiles

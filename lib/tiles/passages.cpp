// SPDX-License-Identifier: Apache-2.0
#include "tiles/passages.hpp"

#include <atomic>
#include <cmath>
#include <memory>
#include <unordered_map>
#include <unordered_set>

#include "tiles/indices.hpp"

namespace gcdt::tiles {

namespace {

/// A triangle, and which of its corners is meant.
struct Corner {
  std::uint32_t triangle;
  unsigned at;
};

/// A triangle at each vertex that has one: any, since all find the same way on. Throws check_failed if the mesh names
/// vertices or triangles that are not there: so walks need not look.
class Starts {
 public:
  explicit Starts(const WalkedTile& mesh) : triangle_at_(new std::atomic<std::uint32_t>[mesh.points.size()]) {
    const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
    for_each_in_threads(mesh.points.size(),
                        [&](std::size_t v) { triangle_at_[v].store(GCDT_NONE, std::memory_order_relaxed); });
    check_each(mesh.triangles.size(), "a triangle of a tile has a corner or a neighbour that is not there",
               [&](std::size_t t) {
                 bool fits = true;
                 for (std::size_t k = 0; k < 3; ++k) {
                   const std::uint32_t v = mesh.triangles[t][k];
                   const std::int32_t other = mesh.neighbours[t][k];
                   fits = fits && v < mesh.points.size() && other >= -1 && other < triangles;
                   if (fits) triangle_at_[v].store(static_cast<std::uint32_t>(t), std::memory_order_relaxed);
                 }
                 return fits;
               });
  }
  std::uint32_t operator[](std::uint32_t v) const {
    const std::uint32_t triangle = triangle_at_[v].load(std::memory_order_relaxed);
    if (triangle == GCDT_NONE) refuse("a constraint ends at a vertex that no triangle of the tile has");
    return triangle;
  }

 private:
  std::unique_ptr<std::atomic<std::uint32_t>[]> triangle_at_;
};

class Walker {
 public:
  /// `is_passed`: by triangle; set for those of its walks.
  Walker(const WalkedTile& mesh, const Starts& starts, std::atomic<bool>* is_passed)
      : mesh_(mesh), points_(mesh.points), starts_(starts), is_passed_(is_passed) {}

  // Ends: each step leads to a vertex that is nearer to the end, and a mesh has finitely many; in what is no mesh, when
  // there were more.
  void walk(std::uint32_t from, std::uint32_t to, bool wide) {
    to_ = to;
    passed_.clear();
    std::size_t left = points_.size();
    for (std::uint32_t v = from; v != to; --left) {
      if (left == 0) lost();
      v = next_vertex(v);
    }
    if (wide) widen(from, to);
    for (const std::uint32_t t : passed_) is_passed_[t].store(true, std::memory_order_relaxed);
  }

 private:
  /// The triangles around a vertex, counter-clockwise; from one edge of the hull to the other if the vertex is on it.
  using Fan = std::vector<Corner>;

  unsigned corner_of(std::uint32_t triangle, std::uint32_t v) const {
    const Triangle& t = mesh_.triangles[triangle];
    return t[0] == v ? 0 : t[1] == v ? 1 : 2;
  }
  std::uint32_t corner(const Corner& c, unsigned turn) const { return mesh_.triangles[c.triangle][(c.at + turn) % 3]; }
  std::int32_t across(const Corner& c, unsigned turn) const { return mesh_.neighbours[c.triangle][(c.at + turn) % 3]; }

  std::int64_t orient(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orient2d(points_[a], points_[b], points_[c]);
  }

  [[noreturn]] static void lost() { refuse("a walk along a constraint left the mesh"); }

  /// Kept, since many passages may begin in one vertex. Ends: a turn around a vertex of a mesh comes back to its first
  /// triangle, or to the hull; in what is no mesh, after as many triangles as there are.
  const Fan& fan_of(std::uint32_t v) {
    const auto [found, is_new] = fans_.try_emplace(v);
    Fan& fan = found->second;
    if (!is_new) return fan;
    const std::uint32_t any = starts_[v];
    std::uint32_t first = any;
    std::size_t left = 2 * mesh_.triangles.size();
    for (std::int32_t t = static_cast<std::int32_t>(any); t >= 0;) {
      if (left-- == 0) lost();
      first = static_cast<std::uint32_t>(t);
      t = across({first, corner_of(first, v)}, 2);
      if (t == static_cast<std::int32_t>(any)) break;
    }
    for (std::int32_t t = static_cast<std::int32_t>(first); t >= 0;) {
      if (left-- == 0) lost();
      const auto here = static_cast<std::uint32_t>(t);
      fan.push_back({here, corner_of(here, v)});
      t = across(fan.back(), 1);
      if (t == static_cast<std::int32_t>(first)) break;
    }
    return fan;
  }

  /// Whether direction q comes before r, counter-clockwise from p on; all are vertices around v.
  bool is_before(std::uint32_t v, std::uint32_t p, std::uint32_t q, std::uint32_t r) const {
    const bool q_behind = behind(v, p, q), r_behind = behind(v, p, r);
    return q_behind != r_behind ? r_behind : orient(v, q, r) > 0;
  }
  /// Whether the direction of q is half a turn from that of p or more.
  bool behind(std::uint32_t v, std::uint32_t p, std::uint32_t q) const {
    const std::int64_t side = orient(v, p, q);
    if (side != 0) return side < 0;
    const GridPoint &o = points_[v], &a = points_[p], &b = points_[q];
    return (a[0] > o[0]) != (b[0] > o[0]) || (a[1] > o[1]) != (b[1] > o[1]) || (a[0] < o[0]) != (b[0] < o[0]) ||
           (a[1] < o[1]) != (b[1] < o[1]);
  }

  /// From vertex v the triangle that the way to to_ leads into, or whose first edge there it runs along, or whose
  /// second edge, which is the hull's then.
  Corner towards(std::uint32_t v) {
    const Fan& fan = fan_of(v);
    const std::uint32_t first = corner(fan[0], 1);
    std::size_t least = 0, end = fan.size();  // the first one is never behind the way, and the range halves
    while (end - least > 1) {
      const std::size_t middle = least + (end - least) / 2;
      (is_before(v, first, to_, corner(fan[middle], 1)) ? end : least) = middle;
    }
    return fan[least];
  }

  void pass_both(const Corner& c, unsigned edge) {
    passed_.push_back(c.triangle);
    if (const std::int32_t other = across(c, edge); other >= 0) passed_.push_back(static_cast<std::uint32_t>(other));
  }

  /// Adds the triangles near the way. What is near it is convex, so its triangles hang together by edges that are near
  /// it, too. Ends: no triangle is added twice.
  void widen(std::uint32_t from, std::uint32_t to) {
    std::unordered_set<std::uint32_t> seen(passed_.begin(), passed_.end());
    for (std::size_t i = 0; i < passed_.size(); ++i) {
      const std::uint32_t t = passed_[i];
      for (unsigned k = 0; k < 3; ++k) {
        const std::int32_t other = mesh_.neighbours[t][k];
        if (other < 0 || seen.count(static_cast<std::uint32_t>(other)) > 0) continue;
        const Triangle& corners = mesh_.triangles[t];
        if (!is_near(points_[from], points_[to], points_[corners[(k + 1) % 3]], points_[corners[(k + 2) % 3]]))
          continue;
        seen.insert(static_cast<std::uint32_t>(other));
        passed_.push_back(static_cast<std::uint32_t>(other));
      }
    }
  }

  /// Whether two segments are at most two cells apart, or a little more: one on both axes is less.
  static bool is_near(const GridPoint& a, const GridPoint& b, const GridPoint& p, const GridPoint& q) {
    const auto sign = [](std::int64_t value) { return (value > 0) - (value < 0); };
    if (sign(orient2d(a, b, p)) * sign(orient2d(a, b, q)) < 0 && sign(orient2d(p, q, a)) * sign(orient2d(p, q, b)) < 0)
      return true;
    return std::min({distance(a, b, p), distance(a, b, q), distance(p, q, a), distance(p, q, b)}) <= 2;
  }
  /// Of a point from a segment, off by less than a thousandth.
  static double distance(const GridPoint& a, const GridPoint& b, const GridPoint& p) {
    const double x = double(b[0]) - a[0], y = double(b[1]) - a[1], px = double(p[0]) - a[0], py = double(p[1]) - a[1];
    const double along = x * px + y * py, length = std::hypot(x, y);
    if (along <= 0) return std::hypot(px, py);
    if (along >= length * length) return std::hypot(px - x, py - y);
    return std::abs(static_cast<double>(orient2d(a, b, p))) / length;
  }

  std::uint32_t next_vertex(std::uint32_t v) {
    const Corner start = towards(v);
    const std::uint32_t right = corner(start, 1), left = corner(start, 2);
    if (orient(v, right, to_) == 0) {
      pass_both(start, 2);
      return right;
    }
    if (orient(v, left, to_) == 0) {
      pass_both(start, 1);
      return left;
    }
    return cross(v, start);
  }

  /// Through the triangle at v and those behind it, up to the first vertex on the way. Ends: the triangles are cut by
  /// a segment one after the other.
  std::uint32_t cross(std::uint32_t v, Corner here) {
    for (std::size_t steps = 0; steps <= mesh_.triangles.size(); ++steps) {
      passed_.push_back(here.triangle);
      const std::int32_t next = across(here, 0);
      if (next < 0) break;
      const std::uint32_t left = corner(here, 2), triangle = static_cast<std::uint32_t>(next);
      // The corner behind the edge that was crossed: the one after its left end, as that edge runs from left to right.
      const Corner apex = {triangle, (corner_of(triangle, left) + 2) % 3};
      const std::uint32_t w = corner(apex, 0);
      const std::int64_t side = orient(v, to_, w);
      if (side == 0) {
        passed_.push_back(triangle);
        return w;
      }
      // To the left of the way: on through the edge between the apex and the right end, which is across from the left.
      here = {triangle, (apex.at + (side > 0 ? 1u : 2u)) % 3};
    }
    lost();
  }

  const WalkedTile& mesh_;
  const Span<GridPoint> points_;
  const Starts& starts_;
  std::unordered_map<std::uint32_t, Fan> fans_;
  std::uint32_t to_ = 0;
  std::atomic<bool>* const is_passed_;
  std::vector<std::uint32_t> passed_;  ///< triangles of this walk
};

}  // namespace

std::vector<std::uint32_t> passed_by(const WalkedTile& mesh, const std::vector<Passage>& passages) {
  std::vector<std::uint32_t> passed;
  if (passages.empty() || mesh.triangles.empty()) return passed;
  const Starts starts(mesh);
  // Not lists of each walk's: many may pass the same triangles.
  const std::unique_ptr<std::atomic<bool>[]> is_passed(new std::atomic<bool>[mesh.triangles.size()]());
  Parts(passages.size(), 64).run([&](std::size_t, std::size_t first, std::size_t end) {
    Walker walker(mesh, starts, is_passed.get());
    for (std::size_t i = first; i < end; ++i) walker.walk(passages[i].from, passages[i].to, passages[i].wide);
  });
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (is_passed[t].load(std::memory_order_relaxed)) passed.push_back(t);
  return passed;
}

}  // namespace gcdt::tiles

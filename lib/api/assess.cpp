// SPDX-License-Identifier: Apache-2.0
// gcdt_assess: whether a mesh that is valid on the grid is valid at the coordinates as they were given.
//
// If all triangles turn left and their outline is a simple polygon, they cover its inside exactly once: over
// each point there are as many triangles as the outline winds around it. The outline of a mesh on the grid is convex
// there. It has a left and a right side of vertices with the least and the largest grid x, in order of y, and between
// them a lower and an upper chain in order of x. Rounding is monotone, so at the given coordinates the sides are in
// strict order of y and the chains of x, and neither meets itself. A chain meets the other one only where both have the
// same x; a side can meet only the first and last edges of the chains, all else being on other grid lines.
#include <algorithm>
#include <cstddef>

#include "api/state.hpp"
#include "mesh/exact.hpp"
#include "proof/grid.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

using exact::Point;
using Corner = std::uint32_t;

struct Given {
  std::vector<Point> at;  ///< as given, or of a grid point if added
  std::vector<proof::Vertex> on_grid;
  std::vector<std::uint32_t> place;  ///< the least vertex on the same grid point
};

/// Do two segments without a common end meet?
bool meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const int p = exact::orient2d(a, b, c), q = exact::orient2d(a, b, d);
  const int r = exact::orient2d(c, d, a), s = exact::orient2d(c, d, b);
  if (p * q < 0 && r * s < 0) return true;
  auto on = [](const Point& u, const Point& v, const Point& w, int side) {
    return side == 0 && std::min(u[0], v[0]) <= w[0] && w[0] <= std::max(u[0], v[0]) && std::min(u[1], v[1]) <= w[1] &&
           w[1] <= std::max(u[1], v[1]);
  };
  return on(a, b, c, p) || on(a, b, d, q) || on(c, d, a, r) || on(c, d, b, s);
}

class Outline {
 public:
  /// `next[v]` follows v around the mesh, counter-clockwise, if it is on the outline, else it is v.
  Outline(const Given& given, const std::vector<Corner>& next) : given_(given) {
    Corner first = 0;
    while (first < next.size() && next[first] == first) ++first;
    if (first == next.size()) return;
    Corner v = first;
    std::int32_t least = x(first), most = x(first);
    do {
      least = std::min(least, x(v));
      most = std::max(most, x(v));
      v = next[v];
    } while (v != first);
    while (!(x(v) == least && x(next[v]) != least)) v = next[v];  // where the lower chain begins
    const Corner begin = v;
    do {
      const Corner w = next[v];
      auto& chain = x(v) == least && x(w) == least ? left_
                    : x(v) == most && x(w) == most ? right_
                    : x(v) < x(w)                  ? lower_
                                                   : upper_;
      chain.push_back({v, w});
      v = w;
    } while (v != begin);
    std::reverse(upper_.begin(), upper_.end());  // both from left to right
  }

  bool simple() const {
    if (lower_.empty() || upper_.empty()) return false;
    for (const auto* side : {&left_, &right_})
      for (const Edge& edge : *side)
        for (const auto* chain : {&lower_, &upper_})
          for (const Edge& other : {chain->front(), chain->back()})
            if (edges_meet(edge, other)) return false;
    // Ends: each step leaves the edge that ends first.
    for (std::size_t i = 0, j = 0; i < lower_.size() && j < upper_.size();) {
      if (edges_meet(lower_[i], upper_[j])) return false;
      if (right_end(lower_[i]) < right_end(upper_[j]))
        ++i;
      else
        ++j;
    }
    return true;
  }

 private:
  struct Edge {
    Corner from, to;
  };
  std::int32_t x(Corner v) const { return given_.on_grid[v].x; }
  double right_end(const Edge& edge) const { return std::max(given_.at[edge.from][0], given_.at[edge.to][0]); }

  bool edges_meet(const Edge& e, const Edge& f) const {
    if (e.from == f.from && e.to == f.to) return false;
    const Point &a = given_.at[e.from], &b = given_.at[e.to], &c = given_.at[f.from], &d = given_.at[f.to];
    // Two segments with a common end meet elsewhere if they are on one line, on the same side of that end.
    if (e.to == f.from) return exact::orient2d(a, b, d) == 0 && !between(a, b, d);
    if (e.from == f.to) return exact::orient2d(c, d, b) == 0 && !between(c, d, b);
    if (e.from == f.from || e.to == f.to) return true;
    return meet(a, b, c, d);
  }
  /// b between a and c, all on one line.
  static bool between(const Point& a, const Point& b, const Point& c) {
    return (a[0] < b[0]) == (b[0] < c[0]) && (a[1] < b[1]) == (b[1] < c[1]);
  }

  const Given& given_;
  std::vector<Edge> left_, right_, lower_, upper_;
};

Given read_given(Points points, const gcdt_mesh& mesh, const Grid& grid) {
  Given given;
  std::string reason;
  given.on_grid = proof::quantise(points, grid, reason);
  if (!reason.empty()) throw Error(Status::invalid_argument, reason);
  for (std::size_t v = 0; v < points.size(); ++v)
    given.at.push_back({points.coordinate(v, 0), points.coordinate(v, 1)});
  for (std::uint64_t i = 0; i < mesh.added_count; ++i) {
    const std::int32_t x = mesh.added[2 * i], y = mesh.added[2 * i + 1];
    require(x >= 0 && y >= 0, "an added vertex is outside the grid");
    given.on_grid.push_back({x, y});
    given.at.push_back({proof::coordinate_at(grid, 0, x), proof::coordinate_at(grid, 1, y)});
  }
  std::vector<std::uint32_t> order(given.at.size());
  for (std::uint32_t v = 0; v < order.size(); ++v) order[v] = v;
  auto key = [&](std::uint32_t v) {
    return std::uint64_t(given.on_grid[v].x) << 32 | std::uint32_t(given.on_grid[v].y);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t u, std::uint32_t v) { return key(u) != key(v) ? key(u) < key(v) : u < v; });
  given.place.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    given.place[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? given.place[order[i - 1]] : order[i];
  return given;
}

gcdt_assessment assess(const Given& given, const gcdt_mesh& mesh) {
  gcdt_assessment found = {};
  for (std::size_t v = 0; v < given.at.size(); ++v) found.vertices_lost += given.at[v] != given.at[given.place[v]];
  std::vector<Corner> next(given.at.size());
  for (Corner v = 0; v < next.size(); ++v) next[v] = v;
  auto corner = [&](std::uint64_t t, int k) { return mesh.triangles[3 * t + static_cast<std::uint64_t>(k % 3)]; };
  for (std::uint64_t t = 0; t < mesh.triangle_count; ++t)
    for (int k = 0; k < 3; ++k) {
      require(corner(t, k) < given.at.size(), "a triangle has a corner that does not exist");
      const std::int32_t across = mesh.neighbours[3 * t + static_cast<std::uint64_t>(k)];
      require(across >= -1 && across < static_cast<std::int64_t>(mesh.triangle_count), "a neighbour does not exist");
    }
  for (std::uint64_t t = 0; t < mesh.triangle_count; ++t) {
    const Point &a = given.at[corner(t, 0)], &b = given.at[corner(t, 1)], &c = given.at[corner(t, 2)];
    const int turn = exact::orient2d(a, b, c);
    found.triangles_inverted += turn < 0;
    found.triangles_flat += turn == 0;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t across = mesh.neighbours[3 * t + static_cast<std::uint64_t>(k)];
      if (across < 0) next[corner(t, k + 1)] = corner(t, k + 2);
      if (across < 0 || static_cast<std::uint64_t>(across) < t || turn <= 0) continue;
      if (mesh.constrained && (mesh.constrained[t] >> k & 1)) continue;
      for (int j = 0; j < 3; ++j) {
        const Corner apex = corner(static_cast<std::uint64_t>(across), j);
        if (apex != corner(t, k + 1) && apex != corner(t, k + 2))
          found.edges_not_delaunay += exact::incircle(a, b, c, given.at[apex]) > 0;
      }
    }
  }
  found.outline_simple = mesh.triangle_count == 0 || Outline(given, next).simple();
  found.valid =
      found.triangles_inverted == 0 && found.triangles_flat == 0 && found.outline_simple && found.vertices_lost == 0;
  return found;
}

}  // namespace

int32_t gcdt_assess(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_grid* grid,
                    gcdt_assessment* assessment) {
  return guarded(nullptr, [&] {
    const gcdt_input given = read_struct(input, "gcdt_input");
    const gcdt_mesh m = read_struct(mesh, "gcdt_mesh", offsetof(gcdt_mesh, added));
    require((m.triangles && m.neighbours) || m.triangle_count == 0, "gcdt_mesh.triangles or neighbours is null");
    require(m.added || m.added_count == 0, "gcdt_mesh.added is null");
    write_struct(assess(read_given(read_points(given), m, read_grid(grid)), m), assessment, "gcdt_assessment");
  });
}

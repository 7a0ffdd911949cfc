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

#include "api/state.hpp"
#include "exact/doubles.hpp"
#include "proof/mesh.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

using exact::Point;
using Corner = std::uint32_t;

struct Given {
  std::vector<Point> at;  ///< as given, or of a grid point if added
  proof::Sites on_grid;
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
  std::int32_t x(Corner v) const { return given_.on_grid.at[v].x; }
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

Given read_given(Points points, const MeshView& mesh, const Grid& grid) {
  std::vector<Point> at;
  std::string reason;
  std::vector<proof::Vertex> on_grid = proof::quantise(points, grid, reason);
  if (!reason.empty()) throw Error(Status::invalid_argument, reason);
  for (std::size_t v = 0; v < points.size(); ++v) at.push_back({points.coordinate(v, 0), points.coordinate(v, 1)});
  const proof::Coordinates coordinates(grid);
  for (const auto& [x, y] : mesh.added) {
    require(x >= 0 && y >= 0, "an added vertex is outside the grid");
    on_grid.push_back({x, y});
    at.push_back({coordinates.at(0, x), coordinates.at(1, y)});
  }
  return {std::move(at), proof::Sites(std::move(on_grid))};
}

gcdt_assessment assess(const Given& given, const MeshView& mesh) {
  gcdt_assessment found = {};
  const std::size_t triangles = mesh.triangles.size();
  std::vector<Corner> next(given.at.size());
  for (Corner v = 0; v < next.size(); ++v) {
    found.vertices_lost += given.at[v] != given.at[given.on_grid.representative[v]];
    next[v] = v;
  }
  const auto corner = [&](std::size_t t, std::size_t k) { return mesh.triangles[t][k % 3]; };
  for (std::size_t t = 0; t < triangles; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      require(corner(t, k) < given.at.size(), "a triangle has a corner that does not exist");
      const std::int32_t across = mesh.neighbours[t][k];
      require(across >= -1 && across < static_cast<std::int64_t>(triangles), "a neighbour does not exist");
    }
  for (std::size_t t = 0; t < triangles; ++t) {
    const Point &a = given.at[corner(t, 0)], &b = given.at[corner(t, 1)], &c = given.at[corner(t, 2)];
    const int turn = exact::orient2d(a, b, c);
    found.triangles_inverted += turn < 0;
    found.triangles_flat += turn == 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t across = mesh.neighbours[t][k];
      if (across < 0) next[corner(t, k + 1)] = corner(t, k + 2);
      if (across < 0 || static_cast<std::size_t>(across) < t || turn <= 0) continue;
      if (mesh.constrained && (mesh.constrained[t] >> k & 1)) continue;
      for (const Corner apex : mesh.triangles[static_cast<std::size_t>(across)])
        if (apex != corner(t, k + 1) && apex != corner(t, k + 2))
          found.edges_not_delaunay += exact::incircle(a, b, c, given.at[apex]) > 0;
    }
  }
  found.outline_simple = triangles == 0 || Outline(given, next).simple();
  found.valid =
      found.triangles_inverted == 0 && found.triangles_flat == 0 && found.outline_simple && found.vertices_lost == 0;
  return found;
}

}  // namespace

int32_t gcdt_assess(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_grid* grid,
                    gcdt_assessment* assessment) {
  return guarded(nullptr, [&] {
    const gcdt_input given = read_struct(input, "gcdt_input");
    const MeshView m = read_mesh(mesh);
    require(m.neighbours || m.triangles.empty(), "gcdt_mesh.neighbours is null");
    write_struct(assess(read_given(read_points(given), m, read_grid(grid)), m), assessment, "gcdt_assessment");
  });
}

// SPDX-License-Identifier: Apache-2.0
// Deterministic inputs for tests and benchmarks. Only integer arithmetic and + - * / sqrt on doubles
// is used (no other function of the mathematical library), so every platform makes the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace gcdt::test {

using Point = std::array<double, 2>;
using Segment = std::array<std::uint32_t, 2>;

struct Workload {
  std::vector<Point> points;
  std::vector<Segment> constraints;
};

/// splitmix64 (Steele, Lea, Flood 2014; its constants).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In [0, bound); the bias of at most bound / 2^64 does not matter here.
  std::uint64_t below(std::uint64_t bound) { return next() % bound; }
  /// In [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }

 private:
  std::uint64_t state_;
};

template <class T>
void shuffle(std::vector<T>& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(i)]);
}

/// The same with its vertices in random order; constraints keep their ends and their order.
Workload shuffled_vertices(const Workload& work, Random& random);

/// (cos, sin) of the angle of `turn` / 2^32 whole turns, to about 1e-15.
Point direction(std::uint32_t turn);
/// `value` rounded to a multiple of 2^-29: coordinates in [-1, 3] then fit the grid without moving.
double snapped(double value);

// `n` is (about) the number of vertices. Constraints never cross unless said otherwise.
Workload uniform(std::size_t n, std::uint64_t seed = 1);
/// Sum of twelve uniform numbers: bell-shaped, within six standard deviations.
Workload gaussian(std::size_t n);
Workload ring(std::size_t n);
/// On 50 circles with radii 2^-3, 2^-6, ..., 2^-27: on the smallest ones many vertices coincide.
Workload clusters(std::size_t n);
/// The floor(sqrt(n))^2 points of a square of integers, shuffled.
Workload grid(std::size_t n);
/// Up to 12,288 integer points on one circle: x^2 + y^2 = 5^3 13^2 17 29 37 41 53 61 73 89, moved by 2^30.
Workload lattice_circle(std::size_t n);
Workload near_circle(std::size_t n);
/// Eight runs of integer points in eight directions; a constraint from end to end through each.
Workload collinear_runs(std::size_t n);
/// All vertices on one line, with overlapping constraints: no triangle.
Workload line(std::size_t n);
Workload line_and_one(std::size_t n);
/// A polygon of narrow teeth, each a thousand times as high as wide.
Workload comb(std::size_t n);
/// A polygon winding inwards and back out again.
Workload spiral(std::size_t n);
/// Uniform vertices and one constraint across everything.
Workload star(std::size_t n);
/// Uniform vertices and n / 200, at most 1000, nearly parallel constraints across everything.
Workload fan(std::size_t n);
/// Concentric squares, all edges constrained.
Workload nested_squares(std::size_t n);
/// n / 2 constraints that all meet in one vertex, among n / 2 other vertices.
Workload hub(std::size_t n);
/// Two clusters at opposite corners of the largest grid, tied by 100 long constraints.
Workload two_clusters(std::size_t n);
/// (i, i^2), at most 46,341 of them.
Workload parabola(std::size_t n);
/// Copies of polyline outlines of letters, some densely subdivided, with scene-long lines between rows.
Workload letters(std::size_t n, std::uint64_t seed = 16003);
/// n - 1 vertices one apart on a line, and one vertex far below them.
Workload row(std::size_t n);
/// The same with a vertex on either side.
Workload row_between(std::size_t n);
/// Two such rows side by side, far apart.
Workload two_rows(std::size_t n);
/// The teeth of comb(), in a polygon that is closed by two far corners.
Workload closed_comb(std::size_t n);
/// A square with a border of vertices one apart, and 50 vertices inside.
Workload dense_border(std::size_t n);
/// n / 10 constraints from one vertex to as many on a circle around it, among uniform vertices.
Workload sunray(std::size_t n);
/// Clusters along logarithmic spirals: each as large as its distance from the centre allows.
Workload log_spirals(std::size_t n);
/// n vertices (duplicates likely) on a side x side grid of integers and up to m random constraints
/// that do not cross: each is added if it crosses none before it. They may touch vertices and overlap.
Workload random_pslg(std::size_t n, std::uint32_t side, std::size_t m, std::uint64_t seed);
/// The same with m constraints that may cross.
Workload random_crossing(std::size_t n, std::uint32_t side, std::size_t m, std::uint64_t seed);

/// Whether the constraints s and t cross properly at a point that is no vertex; exact for integer
/// coordinates below 2^31 in size.
bool cross(const std::vector<Point>& points, const Segment& s, const Segment& t);

/// The paper's Synthetic-cons: 1M uniform vertices whose constraints (about 150k for n = 1M) are the
/// Delaunay edges of the first n / 20 vertices after scaling y by 4^(k - 1), k = 1..6: an affine map,
/// so they do not cross. Coordinates are integers of 31 - 2 (k - 1) bits, so the scaled ones have 31.
/// `delaunay_edges` is the caller's: integer points to edges.
template <class DelaunayEdges>
Workload synthetic_cons(std::size_t n, int k, DelaunayEdges delaunay_edges) {
  Random random(17000 + k);
  const int bits = 31 - 2 * (k - 1);
  Workload work;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = static_cast<double>(random.next() >> (64 - bits));
    work.points.push_back({x, static_cast<double>(random.next() >> (64 - bits))});
  }
  std::vector<Point> scaled(work.points.begin(), work.points.begin() + n / 20);
  for (Point& p : scaled) p[1] *= static_cast<double>(1 << (2 * (k - 1)));
  work.constraints = delaunay_edges(scaled);
  shuffle(work.constraints, random);
  return work;
}

/// The generator called `name` (as above, in lower case with underscores). Throws std::invalid_argument.
Workload workload(const std::string& name, std::size_t n);
/// Every name that workload() knows.
std::vector<std::string> workload_names();
/// Those whose time may grow faster than the number of vertices, and uniform ones beside them.
std::vector<std::string> growth_names();

}  // namespace gcdt::test

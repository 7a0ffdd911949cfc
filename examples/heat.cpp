// SPDX-License-Identifier: Apache-2.0
// Steady heat in an L-shaped plate: linear finite elements on refined meshes, solved with Eigen, against the solution
// r^(2/3) sin(2/3 phi). Its gradient has no bound at the inner corner. So with triangles of one size h the error falls
// as h^(4/3), and with triangles that shrink towards the corner as h^2.
#include <Eigen/SparseCholesky>
#include <cmath>
#include <cstdio>
#include <gcdt/gcdt.hpp>

using Point = std::array<double, 2>;
using Triplets = std::vector<Eigen::Triplet<double>>;

// The plate is a square less its lower right quarter; the inner corner is (0, 0).
const std::vector<Point> corners = {{0, 0}, {0, -1}, {-1, -1}, {-1, 1}, {1, 1}, {1, 0}};
const std::vector<gcdt::Constraint> sides = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}};

double temperature(const Point& p) {
  double angle = std::atan2(p[1], p[0]);  // from the side along x, 0 to 270 degrees
  if (angle < -1e-12) angle += 2 * std::acos(-1.0);
  return std::cbrt(p[0] * p[0] + p[1] * p[1]) * std::sin(2. / 3 * angle);
}

/// Solves for the inner vertices, the others having the right temperature. Returns the error in the mean square.
double error_on(const std::vector<Point>& points, const gcdt::Triangulation& mesh) {
  std::vector<int> unknown(points.size(), 0);
  for (const auto& [a, b] : mesh.pieces) unknown[a] = unknown[b] = -1;
  int count = 0;
  for (int& number : unknown)
    if (number == 0) number = count++;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  Triplets stiffness;
  double area = 0;
  for (const auto& t : mesh.triangles) {
    std::array<Point, 3> across;  // the side across from each corner
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 2; ++axis)
        across[k][axis] = points[t[(k + 2) % 3]][axis] - points[t[(k + 1) % 3]][axis];
    const double doubled = across[0][0] * across[1][1] - across[0][1] * across[1][0];
    area += doubled / 2;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3 && unknown[t[i]] >= 0; ++j) {
        const double entry = (across[i][0] * across[j][0] + across[i][1] * across[j][1]) / (2 * doubled);
        if (unknown[t[j]] >= 0)
          stiffness.emplace_back(unknown[t[i]], unknown[t[j]], entry);
        else
          right[unknown[t[i]]] -= entry * temperature(points[t[j]]);
      }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(stiffness.begin(), stiffness.end());
  const Eigen::VectorXd solution = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  const auto at = [&](std::uint32_t v) { return unknown[v] < 0 ? temperature(points[v]) : solution[unknown[v]]; };
  double squares = 0;  // of the errors in the middles of sides: exact for polynomials of degree 2
  for (const auto& t : mesh.triangles) {
    const Point &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    const double third = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 6;
    for (int k = 0; k < 3; ++k) {
      const Point &p = points[t[k]], &q = points[t[(k + 1) % 3]];
      const double wrong = (at(t[k]) + at(t[(k + 1) % 3])) / 2 - temperature({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2});
      squares += third * wrong * wrong;
    }
  }
  return std::sqrt(squares / area);
}

int main() {
  bool right = true;
  try {
    gcdt::Solver solver;
    for (const bool graded : {false, true}) {
      double before = 0, falls = 1;
      for (double h = 0.2; h > 0.02; h /= 2) {
        std::vector<double> sizes(corners.size(), h);
        if (graded) sizes[0] = h * h / 4;
        gcdt::Options options;
        options.domain = gcdt::Domain::outer;
        options.refine = gcdt::Refinement{};
        options.refine->least_angle = 25;
        options.refine->sizes = sizes;
        const gcdt::Triangulation mesh = solver.triangulate(corners, sides, options);
        std::vector<Point> points = corners;
        points.insert(points.end(), mesh.added.begin(), mesh.added.end());
        const double error = error_on(points, mesh);
        std::printf("%s h = %.4f: %7zu triangles, error %.3e", graded ? "graded," : "even,  ", h, mesh.triangles.size(),
                    error);
        if (before > 0) std::printf(", %.2f times less", before / error);
        std::printf("\n");
        if (before > 0) falls *= before / error;
        before = error;
      }
      // Theory for each halving: 2^(4/3) = 2.52, and 4.
      const double halving = std::cbrt(falls);
      right = right && (graded ? halving > 3.7 && halving < 4.3 : halving > 2.3 && halving < 2.8);
    }
  } catch (const gcdt::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return right ? 0 : 1;
}

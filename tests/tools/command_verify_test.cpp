// SPDX-License-Identifier: Apache-2.0
// The command's proof of results: `verify`, and what it catches.
#include <array>
#include <map>
#include <set>

#include "command_session.hpp"

using namespace gcdt::testing;

TEST_CASE("verify catches every kind of wrong mesh with status 5") {
  Session session;
  session.write("in.poly", random_poly(60, 0));
  session.good("triangulate in.poly -o o.ele -o o.neigh -o o.vtu");
  std::vector<std::string> rows;
  std::istringstream in(data_lines(session.read("o.ele")));
  std::string header;
  std::getline(in, header);
  for (std::string row; std::getline(in, row);) rows.push_back(row.substr(row.find(' ') + 1));
  auto write = [&](const std::vector<std::string>& triangles) {
    std::string text = std::to_string(triangles.size()) + " 3 0\n";
    for (std::size_t t = 0; t < triangles.size(); ++t) text += std::to_string(t) + " " + triangles[t] + "\n";
    session.write("m.ele", text);
  };
  auto mutant = [&](auto&& change) {
    std::vector<std::string> triangles = rows;
    change(triangles);
    write(triangles);
    CHECK(contains(session.bad(5, "verify in.poly m.ele"), "m.ele"));
  };
  write(rows);
  session.good("verify in.poly m.ele");
  write({rows.rbegin(), rows.rend()});
  session.good("verify in.poly m.ele");
  mutant([](auto& t) { t.pop_back(); });
  mutant([](auto& t) { t.push_back(t.front()); });
  mutant([](auto& t) { t.back() = t.front(); });
  mutant([](auto& t) {
    std::istringstream corners(t.front());
    std::string a, b, c;
    corners >> a >> b >> c;
    t.front() = a + " " + c + " " + b;
  });
  mutant([](auto& t) { t.front() = "0 1 60"; });
  mutant([](auto& t) { t.front() = "0 1 -1"; });
  mutant([](auto& t) { t.clear(); });

  std::string neigh = session.read("o.neigh");
  session.write("o.neigh",
                neigh.replace(neigh.find("\n1 ") + 1, neigh.find("\n2 ") - neigh.find("\n1 ") - 1, "1 -1 -1 -1"));
  session.bad(5, "verify in.poly o.neigh");
  session.write("other.poly", random_poly(61, 0));
  session.bad(5, "verify other.poly o.vtu");
  session.bad(5, "verify other.poly o.ele");
}

namespace {

using Corners = std::array<int, 3>;

/// Twice the area of a triangle of points whose coordinates are whole numbers.
long long turn(const std::vector<std::array<long long, 2>>& points, int a, int b, int c) {
  const auto &p = points[a], &q = points[b], &r = points[c];
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

}  // namespace

TEST_CASE("verify notices each single flip undone, and each constraint replaced by the other diagonal") {
  Session session;
  session.write("in.poly", random_poly(120, 0));
  session.good("triangulate in.poly -o o.ele -o o.edge -o o.node");
  std::vector<std::array<long long, 2>> points;
  std::istringstream nodes(session.read("o.node"));
  std::size_t count = 0;
  for (nodes >> count, nodes.ignore(100, '\n'); points.size() < count;) {
    double number, x, y;
    nodes >> number >> x >> y;
    points.push_back({std::llround(x * 1000), std::llround(y * 1000)});
  }
  std::istringstream rows(session.read("o.ele"));
  std::vector<Corners> triangles;
  for (rows >> count, rows.ignore(100, '\n'); triangles.size() < count;) {
    int number;
    Corners t;
    rows >> number >> t[0] >> t[1] >> t[2];
    triangles.push_back(t);
  }
  std::map<std::array<int, 2>, std::array<std::size_t, 2>> sides;  // directed edge: triangle, corner across
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) sides[{triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]}] = {t, k};
  std::istringstream edges(session.read("o.edge"));
  int flipped = 0, broken = 0;
  for (edges >> count, edges.ignore(100, '\n'); count > 0; --count) {
    int number, a, b, marker;
    edges >> number >> a >> b >> marker;
    if (sides.count({a, b}) == 0 || sides.count({b, a}) == 0) continue;
    const auto [t, k] = sides[{a, b}];
    const auto [u, j] = sides[{b, a}];
    const int c = triangles[t][k], d = triangles[u][j];
    if (turn(points, c, a, d) <= 0 || turn(points, d, b, c) <= 0) continue;  // cannot be flipped
    std::vector<Corners> mutant = triangles;
    mutant[t] = {c, a, d};
    mutant[u] = {d, b, c};
    std::string text = std::to_string(mutant.size()) + " 3 0\n";
    for (std::size_t i = 0; i < mutant.size(); ++i)
      text += std::to_string(i) + " " + std::to_string(mutant[i][0]) + " " + std::to_string(mutant[i][1]) + " " +
              std::to_string(mutant[i][2]) + "\n";
    session.write("m.ele", text);
    const std::string said = session.bad(5, "verify in.poly m.ele");
    CAPTURE(said);
    CHECK(contains(said, marker != 0 ? "constraint" : "Delaunay"));
    ++(marker != 0 ? broken : flipped);
  }
  CHECK(flipped > 100);
  CHECK(broken > 5);
}

TEST_CASE("verify cannot read an output that is missing or malformed: status 3") {
  Session session;
  session.write("in.poly", square);
  session.bad(3, "verify in.poly none.ele");
  session.write("bad.ele", "2 3 0\n0 0 1 3\n");
  CHECK(contains(session.bad(3, "verify in.poly bad.ele"), "bad.ele:2: "));
  session.write("bad.vtu", "<VTKFile>\n<");
  CHECK(contains(session.bad(3, "verify in.poly bad.vtu"), "bad.vtu:2: "));
}

// SPDX-License-Identifier: Apache-2.0
// The device's check of meshes from host memory: right ones pass, in any order and rotation, and each fault is named.
#include <doctest/doctest.h>

#include <algorithm>

#include "solver_fixture.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// What the check says; empty if nothing.
std::string said(const Workload& work, const Triangulation& mesh) {
  try {
    check(solver(), work.points, mesh.pieces, view(mesh));
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

/// The mesh with its triangles in another order, each beginning with another corner.
Triangulation shuffled(const Triangulation& mesh, Random& random) {
  std::vector<std::uint32_t> order(mesh.triangles.size()), place(mesh.triangles.size());
  for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
  shuffle(order, random);
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  Triangulation result = mesh;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const int first = static_cast<int>(random.below(3));
    result.constrained[i] = 0;
    for (int k = 0; k < 3; ++k) {
      const int from = (k + first) % 3;
      const std::int32_t across = mesh.neighbours[order[i]][from];
      result.triangles[i][k] = mesh.triangles[order[i]][from];
      result.neighbours[i][k] = across < 0 ? -1 : static_cast<std::int32_t>(place[across]);
      result.constrained[i] |= static_cast<std::uint8_t>((mesh.constrained[order[i]] >> from & 1) << k);
    }
  }
  for (Constraint& piece : result.pieces)
    if (random.below(2)) std::swap(piece[0], piece[1]);
  std::vector<Constraint> pieces(result.pieces.begin(), result.pieces.end());
  shuffle(pieces, random);
  result.pieces.assign(pieces.begin(), pieces.end());
  return result;
}

}  // namespace

TEST_CASE("meshes that are right pass, whatever their order") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Random random(seed);
    const Workload work = random_pslg(120, 40, 100, seed);
    const Triangulation mesh = solver().triangulate(work.points, work.constraints);
    CHECK(said(work, mesh) == "");
    CHECK(said(work, shuffled(mesh, random)) == "");
  }
  CHECK(said(line(20), solver().triangulate(line(20).points)) == "");
  CHECK(said({}, {}) == "");
}

TEST_CASE("each fault is named: corners, links, flags, pieces, a triangle too few, an edge that is not Delaunay") {
  const Workload work = random_pslg(120, 40, 100, 3);
  const Triangulation good = solver().triangulate(work.points, work.constraints);
  auto spoilt = [&](auto&& change) {
    Triangulation mesh = good;
    change(mesh);
    return said(work, mesh);
  };
  auto says = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  CHECK(says(spoilt([](auto& m) { m.triangles[5][1] = 5000; }), "a corner that is no vertex"));
  CHECK(says(spoilt([](auto& m) { std::swap(m.triangles[5][1], m.triangles[5][2]); }), "counter-clockwise"));
  CHECK(says(spoilt([](auto& m) { m.neighbours[5][1] = 99999; }), "a neighbour that is no triangle"));
  CHECK(says(spoilt([](auto& m) { m.constrained[5] ^= 1; }), "constraint"));
  CHECK(says(spoilt([](auto& m) { m.pieces.pop_back(); }), "not part of a constraint"));
  CHECK(says(spoilt([](auto& m) { m.pieces.push_back({m.pieces[0][1], m.pieces[0][0]}); }), "twice"));
  CHECK(says(spoilt([](auto& m) { m.pieces.push_back({0, 7777}); }), "no vertex"));
  CHECK(says(spoilt([](auto& m) { m.pieces.push_back({3, 3}); }), "one place"));
  CHECK(spoilt([](auto& m) {
          m.triangles.pop_back();
          m.neighbours.pop_back();
          m.constrained.pop_back();
        }) != "");
  // The other diagonal of a square and of a kite.
  const Workload kite{{{0, 0}, {10, -1}, {20, 0}, {10, 1}}, {}};
  Triangulation flipped = solver().triangulate(kite.points);
  CHECK(said(kite, flipped) == "");
  flipped.triangles = {{0, 1, 2}, {0, 2, 3}};
  flipped.neighbours = {{-1, 1, -1}, {-1, -1, 0}};
  CHECK(says(said(kite, flipped), "not locally Delaunay"));
}

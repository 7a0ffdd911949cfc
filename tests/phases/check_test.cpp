// SPDX-License-Identifier: Apache-2.0
// The check accepts right results and refuses each kind of wrong one for the right reason.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "host_result.hpp"
#include "phases/check.hpp"
#include "sample.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

HostResult result_of(runtime::Runtime& runtime, const Sample& sample) {
  Primitives primitives(runtime);
  const Vertices vertices = upload_vertices(runtime, sample);
  const OrderedMesh ordered =
      order_triangles(runtime, primitives, make_plan(runtime, vertices), upload_mesh(runtime, sample, 1), vertices);
  HostResult result;
  result.corners.resize(3 * ordered.triangles), result.neighbours.resize(3 * ordered.triangles),
      result.constrained.resize(ordered.triangles);
  runtime.read(ordered.corners, result.corners.data(), result.corners.size());
  runtime.read(ordered.neighbours, result.neighbours.data(), result.neighbours.size());
  runtime.read(ordered.constrained, result.constrained.data(), result.constrained.size());
  return result;
}

/// What check() says of `result`: its message, or "" if it passes.
std::string verdict(runtime::Runtime& runtime, const Sample& sample, const HostResult& result,
                    std::vector<std::uint64_t>* indices = nullptr) {
  OrderedMesh ordered;
  ordered.triangles = result.triangles();
  ordered.corners = runtime.allocate<cl_uint>("corners", result.corners.size());
  ordered.neighbours = runtime.allocate<cl_int>("neighbours", result.neighbours.size());
  ordered.constrained = runtime.allocate<cl_uchar>("flags", result.constrained.size());
  runtime.write(ordered.corners, result.corners.data(), result.corners.size());
  runtime.write(ordered.neighbours, result.neighbours.data(), result.neighbours.size());
  runtime.write(ordered.constrained, result.constrained.data(), result.constrained.size());
  const Vertices vertices = upload_vertices(runtime, sample);
  const Pieces pieces = upload_pieces(runtime, sample);
  try {
    check(runtime, make_plan(runtime, vertices), ordered, vertices, pieces);
  } catch (const Error& error) {
    CHECK(error.status() == Status::check_failed);
    if (indices) *indices = error.indices();
    return error.what();
  }
  return "";
}

/// Every device refuses `result` with the same message, which has `reason` in it.
void refused(const Sample& sample, const HostResult& result, const std::string& reason) {
  std::string first;
  for (auto& runtime : runtimes()) {
    CAPTURE(sample.name);
    CAPTURE(runtime->info().name);
    const std::string said = verdict(*runtime, sample, result);
    if (first.empty()) first = said;
    CHECK_MESSAGE(said.find(reason) != std::string::npos, said);
    CHECK(said == first);
  }
}

/// The first half edge that `fits`, as (triangle, corner).
std::array<cl_uint, 2> find_edge(const HostResult& result, const std::function<bool(cl_uint, cl_uint)>& fits) {
  for (cl_uint t = 0; t < result.triangles(); ++t)
    for (cl_uint k = 0; k < 3; ++k)
      if (fits(t, k)) return {t, k};
  FAIL("the sample has no such edge");
  return {0, 0};
}

struct Fixture {
  Sample sample;
  HostResult right;
  explicit Fixture(Sample s) : sample(std::move(s)), right(result_of(*runtimes().front(), sample)) {}
  Fixture() : Fixture(make_sample("random", random_points(120, 200, 4), 30, 4)) {}

  bool inner(cl_uint t, cl_uint k) { return right.neighbour(t, k) >= 0; }
  bool loose(cl_uint t, cl_uint k) { return inner(t, k) && !right.flagged(t, k); }
  /// The two triangles at the edge form a strictly convex quadrilateral.
  bool convex(cl_uint t, cl_uint k) {
    const auto u = static_cast<cl_uint>(right.neighbour(t, k));
    const cl_uint p = right.corner(t, k), q = right.corner(u, right.corner_to(u, t));
    return sample.mesh->orient(p, right.corner(t, k + 1), q) > 0 &&
           sample.mesh->orient(p, q, right.corner(t, k + 2)) > 0;
  }
  int incircle(cl_uint t, cl_uint k) {
    const auto u = static_cast<cl_uint>(right.neighbour(t, k));
    auto at = [&](cl_uint v) { return sample.mesh->vertex(v); };
    return device::gcdt_incircle(at(right.corner(t, 0)), at(right.corner(t, 1)), at(right.corner(t, 2)),
                                 at(right.corner(u, right.corner_to(u, t))));
  }
};

}  // namespace

TEST_CASE("right results pass on every device") {
  for (const Sample& sample : samples())
    for (auto& runtime : runtimes()) {
      CAPTURE(sample.name);
      CAPTURE(runtime->info().name);
      CHECK(verdict(*runtime, sample, result_of(*runtime, sample)) == "");
    }
}

TEST_CASE("a corner that is no vertex is refused") {
  Fixture f;
  for (cl_uint wrong : {f.sample.n(), f.sample.n() + 2, GCDT_NONE}) {
    HostResult result = f.right;
    result.corners[17] = wrong;
    refused(f.sample, result, "triangle 5 ");
    refused(f.sample, result, "has a corner that is no vertex");
  }
}

TEST_CASE("a triangle with two corners exchanged is refused") {
  Fixture f;
  std::swap(f.right.corners[30], f.right.corners[31]);
  refused(f.sample, f.right, "is not counter-clockwise");
}

TEST_CASE("a triangle left out with links to it is refused") {
  Fixture f;
  const cl_uint last = f.right.triangles() - 1;
  f.right.corners.resize(3 * last), f.right.neighbours.resize(3 * last), f.right.constrained.resize(last);
  refused(f.sample, f.right, "has a neighbour that is no triangle");
}

TEST_CASE("a neighbour below -1 is refused") {
  Fixture f;
  f.right.neighbours[4] = -2;
  refused(f.sample, f.right, "has a neighbour that is no triangle");
}

TEST_CASE("a hole is refused") {
  Fixture f;
  const auto [t, k] =
      find_edge(f.right, [&](cl_uint a, cl_uint) { return f.inner(a, 0) && f.inner(a, 1) && f.inner(a, 2); });
  f.right.remove(t);
  refused(f.sample, f.right, "boundary");
}

TEST_CASE("a notch in the hull is refused") {
  Fixture f;
  const auto [t, k] = find_edge(
      f.right, [&](cl_uint a, cl_uint b) { return !f.inner(a, b) && f.inner(a, b + 1) && f.inner(a, b + 2); });
  f.right.remove(t);
  refused(f.sample, f.right, "is a place where the boundary is not convex");
}

TEST_CASE("a triangle twice is refused") {
  Fixture f;
  f.right.append(11);
  refused(f.sample, f.right, "has a neighbour that does not link back");
}

TEST_CASE("a triangle twice and another missing is refused, although count and links agree") {
  Fixture f;
  const auto [t, k] = find_edge(
      f.right, [&](cl_uint a, cl_uint b) { return !f.inner(a, b) && f.inner(a, b + 1) && f.inner(a, b + 2); });
  f.right.append(t > 10 ? t - 5 : t + 5);
  const cl_uint last = f.right.triangles() - 1;
  for (cl_uint i = 0; i < 3; ++i) f.right.neighbour(last, i) = -1;
  f.right.remove(t);
  refused(f.sample, f.right, "boundary");
  HostResult copied = Fixture().right;
  for (cl_uint i = 0; i < 3; ++i) copied.corners[i] = copied.corners[30 + i];
  refused(f.sample, copied, "has a neighbour without the reversed edge");
}

TEST_CASE("the mesh twice is refused") {
  Fixture f;
  const cl_uint count = f.right.triangles();
  for (cl_uint t = 0; t < count; ++t) f.right.append(t);
  for (cl_uint i = 3 * count; i < 6 * count; ++i)
    if (f.right.neighbours[i] >= 0) f.right.neighbours[i] += static_cast<cl_int>(count);
  refused(f.sample, f.right, "has two boundary edges");
}

TEST_CASE("a wrong neighbour is refused") {
  Fixture f;
  HostResult result = f.right;
  const auto [t, k] = find_edge(f.right, [&](cl_uint a, cl_uint b) { return f.inner(a, b); });
  result.neighbour(t, k) = static_cast<cl_int>((result.neighbour(t, k) + 1) % result.triangles());
  refused(f.sample, result, "has a neighbour without the reversed edge");
  result = f.right;
  result.neighbour(t, k) = -1;
  refused(f.sample, result, "has a neighbour that does not link back");
  result = f.right;
  std::swap(result.neighbour(t, 0), result.neighbour(t, 1));
  refused(f.sample, result, "has a neighbour");
}

TEST_CASE("a flip undone is refused") {
  Fixture f;
  const auto [t, k] =
      find_edge(f.right, [&](cl_uint a, cl_uint b) { return f.loose(a, b) && f.convex(a, b) && f.incircle(a, b) < 0; });
  f.right.flip(t, k);
  refused(f.sample, f.right, "is not locally Delaunay");
}

TEST_CASE("a tie decided the other way is refused") {
  Fixture f(make_sample("a grid", grid_points(9, 9), 0));
  const auto [t, k] = find_edge(
      f.right, [&](cl_uint a, cl_uint b) { return f.loose(a, b) && f.convex(a, b) && f.incircle(a, b) == 0; });
  f.right.flip(t, k);
  refused(f.sample, f.right, "is the wrong diagonal of four cocircular vertices");
}

TEST_CASE("of four cocircular vertices the diagonal through the least is accepted and the other one refused") {
  // Counter-clockwise, the least in (X, Y) order first: X decides, Y where that is equal, and not the lowest.
  const std::vector<std::vector<Point>> circles = {{{0, 0}, {2, 0}, {2, 2}, {0, 2}},
                                                   {{0, 1}, {1, 0}, {2, 1}, {1, 2}},
                                                   {{0, 5}, {2, 1}, {8, 1}, {9, 8}},
                                                   {{0, 0}, {0x7FFFFFFF, 0}, {0x7FFFFFFF, 9}, {0, 9}}};
  for (const std::vector<Point>& circle : circles) {
    const Sample sample = number_points("four on a circle", circle, 3);
    std::vector<cl_uint> v;
    for (const Point& p : circle)
      v.push_back(
          static_cast<cl_uint>(std::find(sample.points.begin(), sample.points.end(), p) - sample.points.begin()));
    for (cl_uint first : {0u, 1u}) {  // where the diagonal begins
      const auto corner = [&](cl_uint i) { return v[(first + i) % 4]; };
      HostResult result;
      result.corners = {corner(0), corner(1), corner(2), corner(0), corner(2), corner(3)};
      result.neighbours = {-1, 1, -1, -1, -1, 0};
      result.constrained = {0, 0};
      for (auto& runtime : runtimes()) {
        CAPTURE(runtime->info().name);
        const std::string said = verdict(*runtime, sample, result);
        if (first == 0) CHECK(said == "");
        if (first == 1) CHECK(said.find("is the wrong diagonal of four cocircular vertices") != std::string::npos);
      }
    }
  }
}

TEST_CASE("wrong flags are refused") {
  Fixture f;
  const auto constraint =
      find_edge(f.right, [&](cl_uint t, cl_uint k) { return f.right.flagged(t, k) && f.inner(t, k); });
  const auto edge = find_edge(f.right, [&](cl_uint t, cl_uint k) { return f.loose(t, k); });
  const auto hull = find_edge(f.right, [&](cl_uint t, cl_uint k) { return !f.inner(t, k) && !f.right.flagged(t, k); });
  HostResult result = f.right;
  result.toggle(constraint[0], constraint[1]);
  refused(f.sample, result, "has constraint flags that do not agree");
  result.toggle_both(constraint[0], constraint[1]);
  result.toggle(constraint[0], constraint[1]);
  refused(f.sample, result, "is an edge that is not flagged");
  for (const auto& [t, k] : {edge, hull}) {
    result = f.right;
    result.toggle_both(t, k);
    refused(f.sample, result, "is flagged but is not part of a constraint");
  }
  result = f.right;
  result.constrained[3] |= 8;
  refused(f.sample, result, "has constraint flags that do not agree");
}

TEST_CASE("a constraint that is no edge is refused and named") {
  Fixture f;
  Sample without = make_sample("random", f.sample.points, 0, 4);
  REQUIRE(without.points == f.sample.points);
  HostResult plain = result_of(*runtimes().front(), without);
  for (cl_uint t = 0; t < plain.triangles(); ++t)  // flag the pieces that are Delaunay edges
    for (cl_uint k = 0; k < 3; ++k)
      for (const auto& p : f.sample.pieces)
        if (std::minmax(plain.corner(t, k + 1), plain.corner(t, k + 2)) == std::minmax(p[0], p[1])) plain.toggle(t, k);
  refused(f.sample, plain, "constraint piece ");
  refused(f.sample, plain, "is not an edge");
  Sample fewer = make_sample("random", f.sample.points, 0, 4);
  fewer.pieces = f.sample.pieces;
  fewer.pieces.erase(fewer.pieces.begin() + 7);
  refused(fewer, f.right, "is flagged but is not part of a constraint");
}

TEST_CASE("a vertex left out is refused and named by its input number, inside and on the hull") {
  for (const auto& [point, where] :
       {std::make_pair(Point{50, 50}, "inside"), std::make_pair(Point{300, 100}, "outside")}) {
    std::vector<Point> points = random_points(80, 200, 6);
    points.push_back(point);
    Sample sample = number_points(where, points, 6);
    const auto v =
        static_cast<cl_uint>(std::find(sample.points.begin(), sample.points.end(), point) - sample.points.begin());
    sample.mesh = std::make_unique<SequentialMesh>(sample.points, v);
    const HostResult result = result_of(*runtimes().front(), sample);
    refused(sample, result, "vertex " + std::to_string(sample.vertex_input[v]) + " is not a corner of any triangle");
    std::vector<std::uint64_t> indices;
    verdict(*runtimes().front(), sample, result, &indices);
    CHECK(indices == std::vector<std::uint64_t>{sample.vertex_input[v]});
  }
}

TEST_CASE("a boundary that is convex everywhere but winds twice is refused") {
  // A fan of ten triangles twice around its centre: count, links, turns and orientations all fit.
  std::vector<Point> ring, points{{1000000, 1000000}};
  const double pi = 3.14159265358979323846;
  for (int i = 0; i < 10; ++i) {
    const double radius = i % 2 ? 900000 : 880000, angle = 2 * pi * i / 5;
    ring.push_back(
        {static_cast<int>(1000000 + radius * std::cos(angle)), static_cast<int>(1000000 + radius * std::sin(angle))});
    points.push_back(ring.back());
  }
  Sample sample = make_sample("a double fan", points, 0);
  auto number = [&](const Point& p) {
    return static_cast<cl_uint>(std::find(sample.points.begin(), sample.points.end(), p) - sample.points.begin());
  };
  HostResult result;
  for (int i = 0; i < 10; ++i) {
    result.corners.insert(result.corners.end(), {number(points[0]), number(ring[i]), number(ring[(i + 1) % 10])});
    result.neighbours.insert(result.neighbours.end(), {-1, (i + 1) % 10, (i + 9) % 10});
    result.constrained.push_back(0);
  }
  refused(sample, result, "the boundary has 2 least corners, not 1");
}

TEST_CASE("no triangles are refused unless all vertices lie on one line") {
  Fixture f;
  refused(f.sample, HostResult(), "but there are no triangles");
  const Sample line = make_sample("on one line", {{0, 0}, {5, 5}, {9, 9}}, 2);
  for (auto& runtime : runtimes()) CHECK(verdict(*runtime, line, HostResult()) == "");
}

TEST_CASE("of many offences the same one is named under every launch geometry") {
  Fixture f;
  HostResult flags = f.right, turned = f.right, links = f.right;
  for (cl_uint t = 20; t < f.right.triangles(); t += 3) {
    flags.toggle(t, t % 3);
    std::swap(turned.corners[3 * t], turned.corners[3 * t + 1]);
    std::swap(links.neighbour(t, 0), links.neighbour(t, 1));
  }
  for (auto& runtime : runtimes()) {
    const runtime::Geometry usual = runtime->geometry();
    for (const HostResult* result : {&f.right, &flags, &turned, &links}) {
      const std::string said = verdict(*runtime, f.sample, *result);
      CHECK(said.empty() == (result == &f.right));
      for (const runtime::Geometry& geometry :
           {runtime::Geometry{1, 3}, runtime::Geometry{7, 2}, runtime::Geometry{64, 1}}) {
        runtime->geometry() = geometry;
        CHECK(verdict(*runtime, f.sample, *result) == said);
      }
      runtime->geometry() = usual;
    }
  }
}

TEST_CASE("every change of one word is refused") {
  Fixture f(make_sample("random", random_points(40, 30, 8), 12, 8));
  std::mt19937 random(1);
  runtime::Runtime& runtime = *runtimes().front();
  for (int round = 0; round < 300; ++round) {
    HostResult result = f.right;
    const std::size_t i = random() % result.corners.size();
    const cl_uint kind = random() % 3, value = random();
    if (kind == 0) result.corners[i] = value % (f.sample.n() + 1);
    if (kind == 1) result.neighbours[i] = static_cast<cl_int>(value % (result.triangles() + 1)) - 1;
    if (kind == 2) result.constrained[i / 3] = value % 8;
    if (result.corners == f.right.corners && result.neighbours == f.right.neighbours &&
        result.constrained == f.right.constrained)
      continue;
    CAPTURE(kind);
    CAPTURE(i);
    CHECK(verdict(runtime, f.sample, result) != "");
  }
}

TEST_CASE("the check reads back once and leaves nothing in device memory") {
  Fixture f;
  runtime::Runtime& runtime = *runtimes().front();
  Primitives primitives(runtime);
  const Vertices vertices = upload_vertices(runtime, f.sample);
  const Pieces pieces = upload_pieces(runtime, f.sample);
  const OrderedMesh ordered =
      order_triangles(runtime, primitives, make_plan(runtime, vertices), upload_mesh(runtime, f.sample, 1), vertices);
  const std::uint64_t before = runtime.meter().now, reads = runtime.read_backs();
  check(runtime, make_plan(runtime, vertices), ordered, vertices, pieces);
  CHECK(runtime.meter().now == before);
  CHECK(runtime.read_backs() == reads + 1);
}

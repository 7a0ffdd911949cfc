// SPDX-License-Identifier: Apache-2.0
// Quality refinement against what docs/refinement.md promises, on devices as what they are and as GPUs.
#include "phases/refine.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <optional>

#include "kinds.hpp"
#include "refine_options.hpp"
#include "refine_results.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

/// PoCL as it is.
runtime::Runtime& usual() { return *devices_as_all_kinds().front().runtime; }

std::uint64_t tangent_of(double angle) {
  return static_cast<std::uint64_t>(std::llround(std::ldexp(std::tan(angle * std::acos(-1.0) / 180), 31)));
}

/// Empty if the result is all that is promised.
std::string fault(runtime::Runtime& runtime, const Workload& work, const Options& options, const RefinedResult& r) {
  Options plain = options;
  plain.refine.reset();
  const RefinedResult before = result_of(runtime, work, plain);
  if (!mesh_fault(r).empty()) return mesh_fault(r);
  if (options.domain == Domain::hull && !r.triangles.empty() && !disc_fault(r).empty()) return disc_fault(r);
  if (!chain_fault(r, before).empty()) return chain_fault(r, before);
  const RefineResult& s = r.refined;
  if (s.added != r.points.size() - r.inputs) return "another number of vertices than was told";
  if ((s.left[GCDT_LEFT_LIMIT] > 0) && s.complete) return "a limit that was not reached has left triangles";
  const bool by_angle = options.refine->most_area == HUGE_VAL && options.refine->sizes.empty();
  if (by_angle && sharp_triangles(r, tangent_of(options.refine->least_angle)) != s.all_left())
    return "another number of sharp triangles than was told";
  return "";
}

/// `count` vertices in a square, and constraints between some.
Workload random_input(std::uint64_t seed, std::size_t count, std::uint64_t side, std::size_t constraints) {
  Random random(seed);
  Workload work;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = double(random.below(side));
    work.points.push_back({x, double(random.below(side))});
  }
  for (std::size_t i = 0; i < constraints; ++i) {
    const auto a = std::uint32_t(random.below(count));
    work.constraints.push_back({a, std::uint32_t(random.below(count))});
  }
  return work;
}

/// Constraints from a centre at small angles.
Workload needles(std::uint64_t seed, std::size_t count, double length) {
  Random random(seed);
  Workload work;
  work.points.push_back({length, length});
  for (std::size_t i = 0; i < count; ++i) {
    const Point d = direction(std::uint32_t(random.below(1u << 28)));
    const double r = length * random.between(0.3, 0.999);
    work.points.push_back({std::round(length + r * d[0]), std::round(length + r * d[1])});
    work.constraints.push_back({0, std::uint32_t(i + 1)});
  }
  return work;
}

/// Squares in squares, the inner ones turned: rings of constraints, some a few cells apart.
Workload rings(std::uint64_t seed, std::size_t count, double side) {
  Random random(seed);
  Workload work;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t first = std::uint32_t(work.points.size()), turn = std::uint32_t(random.below(1u << 30));
    const double radius = side / double(2 + 2 * i);
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
      const Point d = direction(turn + (corner << 30));
      work.points.push_back({std::round(side + radius * d[0]), std::round(side + radius * d[1])});
      work.constraints.push_back({first + corner, first + (corner + 1) % 4});
    }
  }
  return work;
}

/// Inputs of several kinds, from coarse grids, where nothing can be split, to the whole one.
std::vector<Workload> inputs(std::uint64_t first, std::uint64_t last) {
  std::vector<Workload> all;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const std::uint64_t side = std::uint64_t{1} << (3 + seed * 7 % 28);
    all.push_back(random_input(seed, 3 + seed % 40, side, 0));
    all.push_back(random_input(100 + seed, 30, side, 20));
    all.push_back(random_input(200 + seed, 12, side, 12));
    all.push_back(needles(seed, 3 + seed % 6, double(side) / 2));
    all.push_back(rings(seed, 1 + seed % 4, double(side) / 2));
  }
  return all;
}

std::uint64_t number_in(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}
std::uint64_t first_seed() { return number_in("GCDT_REFINED_FIRST", 1); }
std::uint64_t last_seed() { return first_seed() + number_in("GCDT_REFINED_CASES", 14) - 1; }

}  // namespace

TEST_CASE("rules are the integers nearest to what the standard library's functions say") {
  for (std::uint32_t angle = least_refined_angle; angle <= most_refined_angle; angle += 123457) {
    const device::RefineRules rules = refine_rules(angle);
    const long double radians = std::acos(-1.0L) * angle / 180e6L;
    CHECK(std::fabs(double(rules.tangent - std::ldexp(std::tan(radians), 31))) <= 0.5001);
    CHECK(std::fabs(double(rules.lens - std::ldexp(std::tan(2 * radians), 31))) <= 0.5001);
    // Half of a millionth is lost.
    const long double half = std::acos(-1.0L) * (angle / 2) / 180e6L;
    CHECK(std::fabs(double(rules.off_centre - std::ldexp(0.475L / std::tan(half), 24))) <= 0.5001);
  }
}

TEST_CASE("refined meshes are valid, reach the angle but where they say why not, and follow the constraints") {
  std::uint64_t added = 0, bent = 0, far = 0, reasons[4] = {};
  for (const Workload& work : inputs(first_seed(), last_seed()))
    for (const double angle : {20.0, 30.0}) {
      Options options = refining_on_grid(angle);
      options.refine->most_added = 4000;  // some at 30 degrees go on down to the grid
      const RefinedResult r = result_of(usual(), work, options);
      REQUIRE(fault(usual(), work, options, r) == "");
      const RefineResult& s = r.refined;
      CHECK(s.complete == (s.added < 4000));
      added += s.added, bent += s.bent, far += s.far;
      reasons[0] += s.left[GCDT_LEFT_INPUT_ANGLE], reasons[1] += s.left[GCDT_LEFT_BESIDE_ANGLE],
          reasons[2] += s.left[GCDT_LEFT_GRID];
      reasons[3] += s.left[GCDT_LEFT_REFUSED];
    }
  // All of it occurs in the usual ones.
  if (std::getenv("GCDT_REFINED_FIRST")) return;
  CHECK(added > 0);
  CHECK(bent > 0);
  CHECK(far > 0);
  for (const std::uint64_t reason : reasons) CHECK(reason > 0);
}

TEST_CASE("with room between the cells and no sharp corners nothing is left") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Workload work = random_input(seed, 60, 1 << 9, 0);
    for (Point& p : work.points) p = {p[0] * (1 << 21), p[1] * (1 << 21)};
    for (const double angle : {1.0, 20.0, 28.0}) {
      const RefinedResult r = result_of(usual(), work, refining_on_grid(angle));
      CHECK(fault(usual(), work, refining_on_grid(angle), r) == "");
      CHECK(r.refined.all_left() == r.refined.left[GCDT_LEFT_INPUT_ANGLE]);
      CHECK(r.refined.encroached == 0);
    }
  }
}

TEST_CASE("every device gives the same bytes, in every way") {
  const auto all = inputs(1, 2);
  for (std::size_t i = 0; i < all.size(); ++i) {
    Options options = refining_on_grid(i % 2 == 0 ? 25 : 20);
    const std::vector<double> sizes(all[i].points.size(), 200), areas = {5e4};
    options.refine->most_added = 300;
    if (i % 5 == 0) options.refine->sizes = sizes;     // points
    if (i % 5 == 4) options.domain = Domain::nonzero;  // rings; regions go with the triangles
    if (i % 5 == 4) options.refine->most_area = 1e5, options.region_seeds = {all[i].points[0]};
    if (i % 5 == 4) options.refine->region_areas = areas;
    const RefinedResult expected = result_of(usual(), all[i], options);
    for (Treated& device : devices_as_all_kinds()) {
      CAPTURE(device.name);
      const Tuned tuned(*device.runtime, i % 3 == 0 ? Tuning(device.runtime->tuning()) : small_thresholds());
      CHECK(same(result_of(*device.runtime, all[i], options), expected));
    }
  }
}

TEST_CASE("vertices and constraints in another order give the same mesh") {
  Random random(5);
  for (const Workload& work : inputs(1, 4)) {
    Workload other = shuffled_vertices(work, random);
    for (Segment& s : other.constraints) std::swap(s[0], s[1]);
    // Which constraints are dropped depends on their order.
    Options options = refining_on_grid();
    const RefinedResult a = result_of(usual(), work, options), b = result_of(usual(), other, options);
    CHECK(by_coordinates(a) == by_coordinates(b));
    CHECK(std::vector<GridPoint>(a.points.begin() + long(a.inputs), a.points.end()) ==
          std::vector<GridPoint>(b.points.begin() + long(b.inputs), b.points.end()));
  }
}

TEST_CASE("triangles are no larger than wanted, and edges beside constraints are Delaunay if that is wanted") {
  Workload work{{{0, 0}, {1 << 20, 0}, {1 << 20, 1 << 20}, {0, 1 << 20}, {1000, 1 << 19}, {900000, 500000}},
                {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}}};
  Options options = refining_on_grid();
  options.refine->most_area = 1e9;
  const RefinedResult r = result_of(usual(), work, options);
  CHECK(fault(usual(), work, options, r) == "");
  CHECK(r.refined.all_left() == 0);
  CHECK(r.triangles.size() > (std::uint64_t{1} << 40) / 1000000000u);
  for (const auto& c : r.triangles) {
    const GridPoint &a = r.points[c[0]], &b = r.points[c[1]], &d = r.points[c[2]];
    CHECK((b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0]) <= 2000000000);
  }
  options.refine->most_area = HUGE_VAL;
  options.refine->conforming = true;
  for (const Workload& input : {work, random_input(7, 40, 1u << 30, 20)}) {
    const RefinedResult conforming = result_of(usual(), input, options);
    CHECK(fault(usual(), input, options, conforming) == "");
    std::uint64_t in_circle = 0;
    for (std::size_t t = 0; t < conforming.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const auto& c = conforming.triangles[t];
        const GridPoint &p = conforming.points[c[(k + 1) % 3]], &q = conforming.points[c[(k + 2) % 3]],
                        &apex = conforming.points[c[k]];
        const Wide dot = Wide(p[0] - apex[0]) * (q[0] - apex[0]) + Wide(p[1] - apex[1]) * (q[1] - apex[1]);
        in_circle += dot < 0 && (conforming.flagged(t, k) || conforming.neighbours[t][k] < 0);
      }
    CHECK(in_circle == conforming.refined.encroached);
  }
}

TEST_CASE("wanted lengths are reached, and vary from vertex to vertex") {
  const Workload work{{{0, 0}, {1 << 24, 0}, {1 << 24, 1 << 24}, {0, 1 << 24}}, {}};
  const std::vector<double> sizes = {1 << 17, 1 << 21, 1 << 21, 1 << 21};
  Options options = refining_on_grid();
  options.refine->sizes = sizes;
  const RefinedResult r = result_of(usual(), work, options);
  CHECK(fault(usual(), work, options, r) == "");
  CHECK(r.refined.all_left() == 0);
  // The wanted length is between the least and the greatest of the corners of a convex set; and triangles beside vertex
  // 0 are as small as wanted there, not smaller than an eighth of it.
  for (const auto& c : r.triangles) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const GridPoint &a = r.points[c[k]], &b = r.points[c[(k + 1) % 3]];
      longest = std::max(longest, std::hypot(double(a[0] - b[0]), double(a[1] - b[1])));
    }
    CHECK(longest <= std::sqrt(2.0) * (1 << 21));
    if (c[0] == 0 || c[1] == 0 || c[2] == 0) {
      CHECK(longest < 3 * (1 << 17));
      CHECK(longest > (1 << 17) / 8);
    }
  }
  CHECK(r.triangles.size() > 300);
}

TEST_CASE("fixed borders and constraints are not split") {
  for (const Workload& work : {rings(1, 3, 1 << 20), random_input(3, 40, 1u << 20, 20)}) {
    Options options = refining_on_grid();
    options.refine->splits = Splits::none;
    const RefinedResult none = result_of(usual(), work, options);
    CHECK(fault(usual(), work, options, none) == "");
    CHECK(none.refined.on_subsegments == 0);
    CHECK(none.refined.left[GCDT_LEFT_FIXED] > 0);
    options.refine->splits = Splits::inner;
    const RefinedResult inner = result_of(usual(), work, options);
    CHECK(fault(usual(), work, options, inner) == "");
    Options plain = options;
    plain.refine.reset();
    const RefinedResult before = result_of(usual(), work, plain);
    const auto border = border_of(inner), border_before = border_of(before);
    CHECK(std::set<Edge>(border.begin(), border.end()) == std::set<Edge>(border_before.begin(), border_before.end()));
  }
}

TEST_CASE("only the triangles of the domain are refined") {
  const Workload work = rings(2, 3, 1 << 20);
  for (const Domain domain : {Domain::even_odd, Domain::nonzero, Domain::outer, Domain::holes}) {
    Options options = refining_on_grid();
    options.domain = domain;
    if (domain == Domain::holes) options.hole_seeds = {{double(1 << 20), double(1 << 20)}};
    const RefinedResult r = result_of(usual(), work, options);
    CHECK(fault(usual(), work, options, r) == "");
    Options plain = options;
    plain.refine.reset();
    const RefinedResult before = result_of(usual(), work, plain);
    Wide area = 0, area_before = 0;
    const auto add = [](Wide& sum, const RefinedResult& mesh) {
      for (const auto& c : mesh.triangles) {
        const GridPoint &a = mesh.points[c[0]], &b = mesh.points[c[1]], &d = mesh.points[c[2]];
        sum += Wide(b[0] - a[0]) * (d[1] - a[1]) - Wide(b[1] - a[1]) * (d[0] - a[0]);
      }
    };
    add(area, r);
    add(area_before, before);
    // The border is bent by less than a cell.
    CHECK(std::fabs(double(area - area_before)) < 1e-5 * double(area_before));
    CHECK(r.refined.added > 0);
    // A vertex stands on triangles of the domain alone.
    std::set<cl_uint> corners;
    for (const auto& c : r.triangles) corners.insert(c.begin(), c.end());
    for (std::size_t v = r.inputs; v < r.points.size(); ++v) CHECK(corners.count(cl_uint(v)) == 1);
  }
}

TEST_CASE("a limit of vertices is kept, and the mesh is valid wherever it ends") {
  const Workload work = random_input(9, 80, 1u << 30, 30);
  const std::uint64_t all = result_of(usual(), work, refining_on_grid(30)).refined.added;
  REQUIRE(all > 40);
  for (const std::uint64_t most : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{7}, all - 1, all}) {
    Options options = refining_on_grid(30);
    options.refine->most_added = most;
    const RefinedResult r = result_of(usual(), work, options);
    CHECK(fault(usual(), work, options, r) == "");
    CHECK(r.refined.added == most);
    CHECK(r.refined.complete == (most == all));
    CHECK((r.refined.left[GCDT_LEFT_LIMIT] > 0) == (most < all));
  }
}

TEST_CASE("inputs without triangles, of one triangle and of an empty domain are refined to what they are") {
  Options options = refining_on_grid();
  CHECK(result_of(usual(), {{{0, 0}, {5, 5}, {9, 9}}, {{0, 2}}}, options).triangles.empty());
  CHECK(result_of(usual(), {{}, {}}, options).triangles.empty());
  const Workload triangle{{{0, 0}, {1 << 20, 0}, {0, 1 << 20}}, {}};
  CHECK(result_of(usual(), triangle, options).triangles.size() == 1);
  options.domain = Domain::outer;
  CHECK(result_of(usual(), triangle, options).triangles.empty());
  CHECK(result_of(usual(), triangle, options).refined.added == 0);
}

TEST_CASE("what makes no sense is refused") {
  const Workload work = random_input(1, 10, 1000, 0);
  const std::vector<double> short_of_one(9, 1.0), with_zero = {1, 1, 1, 1, 1, 0, 1, 1, 1, 1}, ones(10, 1.0);
  const auto refused = [&](auto change, Crossing crossing = Crossing::drop) {
    Options options = refining_on_grid();
    options.crossing = crossing;
    change(*options.refine);
    try {
      result_of(usual(), work, options);
    } catch (const Error& error) {
      return error.status() == Status::invalid_argument;
    }
    return false;
  };
  CHECK(refused([](Refinement& r) { r.least_angle = 0.99; }));
  CHECK(refused([](Refinement& r) { r.least_angle = 34.01; }));
  CHECK(refused([](Refinement& r) { r.least_angle = std::nan(""); }));
  CHECK(refused([](Refinement& r) { r.most_area = 0; }));
  CHECK(refused([](Refinement& r) { r.most_area = -1; }));
  CHECK(refused([](Refinement& r) { r.most_area = std::nan(""); }));
  CHECK(refused([](Refinement& r) { r.least_length = -1; }));
  CHECK(refused([&](Refinement& r) { r.sizes = short_of_one; }));
  CHECK(refused([&](Refinement& r) { r.sizes = with_zero; }));
  CHECK(refused([&](Refinement& r) { r.sizes = ones; }, Crossing::split));
  CHECK_FALSE(refused([](Refinement& r) { r.least_angle = 34, r.most_added = 10; }));
}

TEST_CASE("a refinement can be cancelled, and the device be used again") {
  const Workload work = random_input(11, 200, 1u << 30, 0);
  Options options = refining_on_grid();
  options.progress = [](const char* phase, double) { return std::string(phase) != "refine"; };
  CHECK_THROWS_AS(result_of(usual(), work, options), Error);
  options.progress = {};
  CHECK(fault(usual(), work, options, result_of(usual(), work, options)) == "");
}

// SPDX-License-Identifier: Apache-2.0
// Refinement of results that are there: the bytes of the one call, on every device as what it is and as a GPU.
#include "solve/refine_result.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "kinds.hpp"
#include "query/adopt.hpp"
#include "query/arrays.hpp"
#include "refine_options.hpp"
#include "solve/triangulate.hpp"
#include "workloads.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

struct Case {
  const char* name;
  Workload work;
  Options options;
};

Case made_case(const char* name, Workload work, const Refinement& wanted, Domain domain = Domain::hull) {
  Case c = {name, std::move(work), {}};
  c.options.refine = wanted;
  c.options.domain = domain;
  return c;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back(made_case("points", uniform(300), refinement(28)));
  all.push_back(made_case("letters", letters(3), refinement(25, 2e-4), Domain::even_odd));
  all.push_back(made_case("squares", nested_squares(60), refinement(20), Domain::outer));
  all.push_back(made_case("random", random_pslg(60, 1000, 200, 3), refinement(30)));
  all.back().options.regions = true;
  all.push_back(made_case("coarse", random_pslg(40, 8, 80, 1), refinement(33)));
  all.push_back(made_case("limit", uniform(200, 2), refinement(30)));
  all.back().options.refine->most_added = 57;
  all.push_back(made_case("conforming", star(40), refinement(20)));
  all.back().options.refine->conforming = true;
  all.push_back(made_case("inner", comb(50), refinement(20, 20)));
  all.back().options.refine->splits = Splits::inner;
  all.push_back(made_case("crossings", random_crossing(30, 1 << 20, 12, 4), refinement(25)));
  all.back().options.crossing = Crossing::split;
  all.push_back(made_case("dropped", random_crossing(30, 1 << 20, 12, 4), refinement(25)));
  all.back().options.crossing = Crossing::drop;
  all.push_back(made_case("a line", line(20), refinement(25)));
  all.push_back(made_case("nothing", {}, refinement(25)));
  all.push_back(made_case("an empty domain", uniform(50), refinement(25), Domain::outer));
  return all;
}

DeviceTriangulation solve(runtime::Runtime& runtime, const Workload& work, const Options& options) {
  Primitives primitives(runtime);
  return triangulate(runtime, primitives, source_of(runtime, work.points, work.constraints), options);
}

DeviceTriangulation refine(runtime::Runtime& runtime, const DeviceTriangulation& made, const Options& options) {
  Primitives primitives(runtime);
  return refine_result(runtime, primitives, made, options);
}

using Bytes = std::vector<std::vector<unsigned char>>;

/// All arrays that a result has, by the table.
Bytes bytes_of(runtime::Runtime& runtime, const DeviceTriangulation& made) {
  Bytes all;
  for (const ResultArray& array : result_arrays) {
    if (array.there == There::on_demand) continue;
    all.emplace_back();
    if (!has(made, array)) continue;
    all.back().resize(elements(made, array) * array.element_bytes);
    if (!all.back().empty()) runtime.read_bytes(array.memory(made), 0, all.back().data(), all.back().size());
  }
  return all;
}

/// Where GCDT_REGIONS are in Bytes.
std::size_t region_slot() {
  std::size_t slot = 0;
  for (const ResultArray& array : result_arrays) {
    if (array.number == GCDT_REGIONS) break;
    slot += array.there != There::on_demand;
  }
  return slot;
}

Options without(Options options) {
  options.refine.reset();
  return options;
}

/// What is read of a call's options when its result is refined.
Options own(const Options& options) {
  Options read;
  read.refine = options.refine;
  return read;
}

}  // namespace

TEST_CASE("a result is refined to the bytes of one call, and stays as it is") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    std::optional<Bytes> expected;
    for (auto& [name, device] : devices_as_all_kinds()) {
      CAPTURE(name);
      const DeviceTriangulation plain = solve(*device, c.work, without(c.options));
      const Bytes before = bytes_of(*device, plain);
      const DeviceTriangulation refined = refine(*device, plain, own(c.options));
      if (!expected) expected = bytes_of(*device, solve(*device, c.work, c.options));
      CHECK(bytes_of(*device, refined) == *expected);
      CHECK(bytes_of(*device, plain) == before);
    }
  }
}

TEST_CASE("a refined result is refined further to the same bytes everywhere, and stays as it is") {
  std::vector<Case> all;
  all.push_back(made_case("letters", letters(3), refinement(20), Domain::even_odd));
  all.push_back(made_case("coarse", random_pslg(40, 8, 80, 1), refinement(33)));
  all.push_back(made_case("crossings", random_crossing(30, 1 << 20, 12, 4), refinement(20)));
  all.back().options.crossing = Crossing::split;
  for (const Case& c : all) {
    CAPTURE(c.name);
    std::optional<Bytes> expected;
    Options finer = own(c.options);
    finer.refine->least_angle = 30;
    finer.refine->most_added = 2000;
    for (auto& [name, device] : devices_as_all_kinds()) {
      CAPTURE(name);
      const DeviceTriangulation once = solve(*device, c.work, c.options);
      const Bytes before = bytes_of(*device, once);
      const Bytes further = bytes_of(*device, refine(*device, once, finer));
      if (!expected) expected = further;
      CHECK(further == *expected);
      CHECK(bytes_of(*device, refine(*device, once, own(c.options))) == before);
      CHECK(bytes_of(*device, once) == before);
    }
  }
}

TEST_CASE("an adopted mesh is refined to the same bytes everywhere") {
  // Any diagonals, and the last square is not of the mesh.
  Workload work;
  for (int i = 0; i < 49; ++i) work.points.push_back({double(i % 7), double(i / 7)});
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t square = 0; square + 1 < 36; ++square) {
    const std::uint32_t a = square / 6 * 7 + square % 6, b = a + 1, c = a + 8, d = a + 7;
    if (square % 3 == 0)
      triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}});
    else
      triangles.insert(triangles.end(), {{a, b, d}, {b, c, d}});
  }
  std::optional<Bytes> expected;
  for (auto& [name, device] : devices_as_all_kinds()) {
    CAPTURE(name);
    Primitives primitives(*device);
    const std::vector<Constraint> edges = edges_of(triangles, work.points.size());
    Workload whole = work;
    whole.constraints = edges;
    const DeviceTriangulation adopted = adopt(*device, primitives, solve(*device, whole, {}), triangles, 0);
    const Bytes before = bytes_of(*device, adopted);
    const DeviceTriangulation refined = refine(*device, adopted, own(made_case("", {}, refinement(25, 0.1)).options));
    const Bytes bytes = bytes_of(*device, refined);
    CHECK(refined.statistics.refine.added > 100);
    if (!expected) expected = bytes;
    CHECK(bytes == *expected);
    CHECK(bytes_of(*device, adopted) == before);
  }
}

TEST_CASE("the refined result is told of as one call's") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    runtime::Runtime& device = *devices_as_all_kinds().front().runtime;
    const Statistics one = solve(device, c.work, c.options).statistics;
    const Statistics s = refine(device, solve(device, c.work, without(c.options)), own(c.options)).statistics;
    CHECK(s.refine.complete == one.refine.complete);
    CHECK(s.refine.rounds == one.refine.rounds);
    CHECK(s.refine.added == one.refine.added);
    CHECK(s.refine.bent == one.refine.bent);
    CHECK(s.refine.left_grid == one.refine.left_grid);
    CHECK(s.n == one.n);
    CHECK(s.m == one.m);
    CHECK(s.triangles == one.triangles);
    CHECK(s.triangles_removed == one.triangles_removed);
    CHECK(s.vertices_added == one.vertices_added);
    CHECK(s.constraints_pieces == one.constraints_pieces);
    CHECK(s.flips == one.flips);
    CHECK(s.regions == one.regions);
    CHECK(s.notes.size() == one.notes.size());
    CHECK(s.ms.insert == 0);
  }
}

TEST_CASE("regions' areas and lengths at vertices go by the result's own seeds and vertices") {
  Case c = made_case("squares", nested_squares(60), refinement(25), Domain::outer);
  const Point first = c.work.points[0];
  c.options.region_seeds = {{first[0] + 1e-3, first[1] + 1e-3}, {0.5, 0.5}};
  c.options.regions = true;
  const std::vector<double> areas = {1, 4}, sizes(c.work.points.size(), 2);
  for (auto& [name, device] : devices_as_all_kinds()) {
    CAPTURE(name);
    Options by_region = c.options, by_length = c.options;
    by_region.refine->region_areas = areas;
    by_length.refine->sizes = sizes;
    const DeviceTriangulation plain = solve(*device, c.work, without(c.options));
    const Bytes one = bytes_of(*device, solve(*device, c.work, by_region)),
                other = bytes_of(*device, solve(*device, c.work, by_length));
    CHECK(bytes_of(*device, refine(*device, plain, own(by_region))) == one);
    CHECK(bytes_of(*device, refine(*device, plain, own(by_length))) == other);
    CHECK(one != other);
  }
}

TEST_CASE("triangles in any order are refined to the same mesh") {
  Case c = made_case("letters", letters(3), refinement(25), Domain::even_odd);
  for (auto& [name, device] : devices_as_all_kinds()) {
    CAPTURE(name);
    Options any = without(c.options);
    any.canonical = false;
    const DeviceTriangulation plain = solve(*device, c.work, any);
    const Bytes expected = bytes_of(*device, solve(*device, c.work, c.options));
    Bytes found = bytes_of(*device, refine(*device, plain, own(c.options)));
    REQUIRE(found.size() == expected.size());
    found[region_slot()] = expected[region_slot()];  // regions have the order of the result's own triangles
    CHECK(found == expected);
    Options not_sorted = own(c.options);
    not_sorted.canonical = false;
    const DeviceTriangulation refined = refine(*device, plain, not_sorted);
    CHECK(refined.mesh.triangles * 12 == expected[0].size());
  }
}

TEST_CASE("a refinement beside its result takes no more memory than the one call may") {
  for (const std::size_t n : {2000u, 20000u}) {
    const Workload work = n == 2000 ? random_pslg(n, 1 << 20, n, 1) : uniform(n);
    Options options;
    options.regions = true;
    runtime::Runtime& device = *devices_as_all_kinds().front().runtime;
    const DeviceTriangulation plain = solve(device, work, options);
    for (const std::uint64_t limit : {std::uint64_t{n} / 4, 4 * std::uint64_t{n}}) {
      options.refine = refinement(33);
      options.refine->most_added = limit;
      const Statistics s = refine(device, plain, own(options)).statistics;
      const std::uint64_t m = std::max(s.m, s.constraints_pieces);
      CHECK(s.peak_device_bytes <=
            gcdt_required_bytes_refined(n, m, s.crossed_pairs, limit) - gcdt_required_bytes(0, 0, 0));
      const DeviceTriangulation once = refine(device, plain, own(options));
      const std::uint64_t vertices = n + once.added.count;
      options.refine->least_angle = 34;
      const Statistics further = refine(device, once, own(options)).statistics;
      CHECK(further.peak_device_bytes <= gcdt_required_bytes_refined(vertices,
                                                                     std::max(further.m, further.constraints_pieces),
                                                                     further.crossed_pairs, limit) -
                                             gcdt_required_bytes(0, 0, 0));
    }
  }
}

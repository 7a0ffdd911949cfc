// SPDX-License-Identifier: Apache-2.0
// One problem in tiles: the same arrays as from one device, wherever it is cut.
#include <cmath>

#include "corpus.hpp"
#include "device_list.hpp"
#include "kinds.hpp"
#include "pool_cases.hpp"
#include "tiles/seeds.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::test;
using tiles::Cuts;
using tiles::GridPoint;

namespace {

const std::vector<cl::Device> all_of_them = every_device();  // before anything else lists devices

/// On two halves of a CPU, as two devices.
DevicePool& halves() {
  static std::unique_ptr<DevicePool> pool;
  if (!pool) {
    std::vector<DevicePool::Member> members;
    for (const cl::CommandQueue& queue : half_devices())
      members.push_back({queue.getInfo<CL_QUEUE_CONTEXT>(), queue.getInfo<CL_QUEUE_DEVICE>(), runtime::CallHook()});
    pool = std::make_unique<DevicePool>(std::move(members), runtime::Log(), Trace());
  }
  return *pool;
}

struct OneProblem {
  explicit OneProblem(const Workload& work)
      : points(work.points), constraints(work.constraints), n{0, points.size()}, m{0, constraints.size()} {}
  BatchInput view() const { return {1, Points::Type::float64, points.data(), n.data(), constraints.data(), m.data()}; }
  std::vector<Point> points;
  std::vector<Constraint> constraints;
  std::array<std::uint64_t, 2> n, m;
};

using Cut = std::function<Cuts(const tiles::GridInput&)>;

/// The mesh, or the error's text.
std::pair<Triangulation, std::string> in_tiles(const Workload& work, const Cut& cut, const Options& options,
                                               DevicePool& pool = halves()) {
  const OneProblem problem(work);
  try {
    const ForestResult made = tiles::triangulate_cut(pool, problem.view(), options, 4, cut);
    return {test::part_of(made, 0), ""};
  } catch (const Error& error) {
    return {{}, error.what()};
  }
}

Cut evenly(std::size_t tiles) {
  return [tiles](const tiles::GridInput& input) {
    tiles::Team alone;
    return tiles::even_cuts(input, tiles, alone);
  };
}

/// At vertices and between them, some more than once.
Cut anywhere(std::size_t tiles, Random& random) {
  return [tiles, &random](const tiles::GridInput& input) {
    std::vector<std::uint64_t> codes;
    while (codes.size() + 1 < tiles) {
      const std::uint64_t kind = random.below(4);
      if (kind == 0) codes.push_back(random.next() >> (2 + random.below(62)));
      if (kind == 1 && !codes.empty()) codes.push_back(codes.back());
      if (kind >= 2) codes.push_back(tiles::code_of(input.at(random.below(input.n()))) + kind - 2);
    }
    std::sort(codes.begin(), codes.end());
    return Cuts(codes);
  };
}

void check_same(const Workload& work, const Cut& cut, const Options& options, DevicePool& pool = halves()) {
  const auto [mesh, error] = in_tiles(work, cut, options, pool);
  const Singles alone({work}, options);
  CHECK(error == alone.errors[0]);
  if (alone.errors[0].empty() && error.empty()) CHECK(difference(mesh, alone.meshes[0]) == "");
}

Options with(Crossing crossing) {
  Options options;
  options.crossing = crossing;
  return options;
}

}  // namespace

TEST_CASE("random graphs on small grids, cut anywhere, give the bytes of one device") {
  Random random(77001);
  for (unsigned i = 0; i < 150; ++i) {
    CAPTURE(i);
    const auto side = static_cast<std::uint32_t>(2 + random.below(i % 3 == 0 ? 6 : 60));
    const std::size_t n = 1 + random.below(120), m = random.below(40);
    const Workload work = i % 2 ? random_pslg(n, side, m, i) : random_crossing(n, side, m, i);
    const std::size_t tiles = std::array<std::size_t, 4>{2, 3, 4, 7}[i % 4];
    for (const Crossing crossing : {Crossing::reject, Crossing::drop, Crossing::split}) {
      CAPTURE(static_cast<int>(crossing));
      check_same(work, anywhere(tiles, random), with(crossing));
    }
  }
}

TEST_CASE("every workload, cut evenly, gives the bytes of one device") {
  for (const std::string& name : workload_names()) {
    CAPTURE(name);
    const Workload work = workload(name, 3000);
    for (const std::size_t tiles : {2, 3, 7}) {
      CAPTURE(tiles);
      check_same(work, evenly(tiles), with(Crossing::drop));
    }
  }
}

TEST_CASE("even cuts are those of all codes in their order, if there are few, or within the slack the roundest code") {
  for (const std::size_t n : {0, 1, 5, 1000, 5000}) {
    const Workload work = uniform(n);
    for (const std::size_t tiles : {1, 2, 3, 7, 64}) {
      CAPTURE(n);
      CAPTURE(tiles);
      const Cut cut = [&](const tiles::GridInput& input) {
        std::vector<std::uint64_t> codes;
        for (std::size_t v = 0; v < n; ++v) codes.push_back(tiles::code_of(input.at(v)));
        std::sort(codes.begin(), codes.end());
        Cuts cuts = evenly(tiles)(input);
        CHECK(cuts.tiles() == tiles);
        const std::size_t slack = tiles::slack_of_cut(n, tiles);
        for (std::size_t t = 1; t < tiles && n > 0; ++t) {
          const std::uint64_t made = cuts.first_codes()[t - 1], even = codes[n * t / tiles];
          const std::uint64_t low = codes[n * t / tiles - slack], high = codes[n * t / tiles + slack];
          if (slack == 0 || low == even) {
            CHECK(made == even);
            continue;
          }
          const std::uint64_t last_bit = made & (~made + 1);
          CHECK(low < made);
          CHECK(made <= high);
          CHECK(made - last_bit <= low);
          CHECK(made + last_bit > high);
        }
        return cuts;
      };
      CHECK(in_tiles(work, cut, with(Crossing::reject)).second.empty());
    }
  }
}

TEST_CASE("regions and domains are those of one device") {
  Random random(77002);
  for (unsigned i = 0; i < 60; ++i) {
    CAPTURE(i);
    const Workload work = random_crossing(1 + random.below(100), 2 + i % 40, random.below(60), 5000 + i);
    Options options = with(i % 3 ? Crossing::drop : Crossing::split);
    options.domain = std::array<Domain, 4>{Domain::hull, Domain::even_odd, Domain::nonzero, Domain::outer}[i % 4];
    options.regions = true;
    check_same(work, anywhere(2 + i % 5, random), options);
  }
  for (const char* name : {"nested_squares", "letters", "closed_comb", "spiral"}) {
    CAPTURE(name);
    Options options;
    options.domain = Domain::even_odd;
    check_same(workload(name, 2000), evenly(4), options);
  }
}

namespace {

/// At vertices, between two of them, on constraints, and outside of the hull and of the grid; some more than once.
std::vector<Point> some_places(const Workload& work, std::size_t count, Random& random) {
  std::vector<Point> places;
  const auto any = [&]() -> const Point& { return work.points[random.below(work.points.size())]; };
  const auto middle = [](const Point& a, const Point& b) { return Point{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2}; };
  while (places.size() < count) {
    const std::uint64_t kind = random.below(8);
    if (kind < 3) places.push_back(middle(any(), any()));
    if (kind == 3 || kind == 4) places.push_back(any());
    if (kind == 5 && !work.constraints.empty()) {
      const Constraint& c = work.constraints[random.below(work.constraints.size())];
      places.push_back(middle(work.points[c[0]], work.points[c[1]]));
    }
    if (kind == 6 && !places.empty()) places.push_back(places.front());
    if (kind == 7) places.push_back(random.below(2) ? Point{-1e300, 4e9} : Point{any()[0], any()[1] - 0.25});
  }
  return places;
}

constexpr std::array<Domain, 6> domains = {Domain::holes,    Domain::outer_holes, Domain::hull,
                                           Domain::even_odd, Domain::nonzero,     Domain::outer};

}  // namespace

TEST_CASE("domains by hole points, and regions by theirs, are those of one device") {
  Random random(77003);
  for (unsigned i = 0; i < 120; ++i) {
    CAPTURE(i);
    const std::uint32_t side = 2 + i % 40;
    Workload work = i % 2 ? random_crossing(1 + random.below(100), side, random.below(60), 6000 + i)
                          : random_pslg(1 + random.below(100), side, random.below(60), 6000 + i);
    Options options = with(i % 3 ? Crossing::drop : Crossing::split);
    options.domain = domains[i % domains.size()];
    options.regions = i % 4 == 0;
    options.hole_seeds = some_places(work, random.below(40), random);
    options.region_seeds = some_places(work, random.below(40), random);
    if (i % 5 == 1)  // a decimal grid, and points that have more digits than it
      for (std::vector<Point>* points : {&work.points, &options.hole_seeds, &options.region_seeds})
        for (Point& p : *points) p = {p[0] / 10, p[1] / 10};
    if (i % 5 == 2) options.grid = FixedGrid{0, 0, "0.5"};
    check_same(work, anywhere(std::array<std::size_t, 4>{2, 3, 4, 7}[i % 4], random), options);
  }
}

TEST_CASE("many points in large meshes are in the regions that they have on one device") {
  Random random(77004);
  for (const char* name : {"letters", "closed_comb", "spiral", "nested_squares", "row"}) {
    CAPTURE(name);
    const Workload work = workload(name, 3000);
    Options options;
    options.domain = Domain::holes;
    options.hole_seeds = some_places(work, 20, random);
    options.region_seeds = some_places(work, 3000, random);
    for (const std::size_t tiles : {2, 3, 4, 7}) {
      CAPTURE(tiles);
      check_same(work, evenly(tiles), options);
    }
  }
}

TEST_CASE("a triangle finds the points that it holds, border included") {
  Random random(77005);
  const auto coordinate = [&](std::uint64_t side) { return static_cast<std::int32_t>(random.below(side)); };
  for (const std::uint64_t side : {5u, 60u, 1u << 20, 1u << 31}) {
    std::vector<GridPoint> points;
    for (int i = 0; i < 700; ++i) points.push_back({coordinate(side), coordinate(side)});
    for (int i = 0; i < 200; ++i) points.push_back({points[0][0], coordinate(side)});  // a row, too
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    const tiles::SeedTree tree(points);
    std::size_t held = 0;
    for (int i = 0; i < 400; ++i) {
      std::array<GridPoint, 3> t;
      for (GridPoint& corner : t)
        corner = random.below(3) ? GridPoint{coordinate(side), coordinate(side)} : points[random.below(points.size())];
      if (i % 4 == 0) t[2] = {t[0][0] + (t[0][0] == 0 ? 1 : -1), t[0][1]};  // a sliver
      if (tiles::orient2d(t[0], t[1], t[2]) < 0) std::swap(t[1], t[2]);
      std::vector<std::uint32_t> found, expected;
      tree.find(t, found);
      std::sort(found.begin(), found.end());
      for (std::uint32_t p = 0; p < points.size(); ++p)
        if (tiles::orient2d(t[0], t[1], points[p]) >= 0 && tiles::orient2d(t[1], t[2], points[p]) >= 0 &&
            tiles::orient2d(t[2], t[0], points[p]) >= 0)
          expected.push_back(p);
      if (tiles::orient2d(t[0], t[1], t[2]) == 0) continue;  // no triangle
      CHECK(found == expected);
      held += found.size();
    }
    CHECK(held > 400);
  }
}

TEST_CASE("a route goes through a vertex that no triangle has which its constraint crosses") {
  // The constraint from (-1, 0) to (20, 1) passes less than half a cell above (9, 0), but the edge from (0, 0) to
  // (20, 1) is between them, and the triangle below that edge would be final.
  Workload work;
  for (const auto& [x, y] :
       std::vector<std::array<int, 2>>{{-1, 0}, {20, 1}, {9, 0}, {0, 0}, {-12, 1}, {-30, -40}, {9, -50}, {50, -40}})
    work.points.push_back({1152.0 + x, 1124.0 + y});
  for (int i = 0; i < 6; ++i) work.points.push_back({5000.0 + 7 * i, 5000.0 + i * i});
  work.constraints = {{0, 1}, {4, 3}};
  Options options = with(Crossing::split);
  options.grid = FixedGrid{};
  const Triangulation alone = solver().triangulate(work.points, work.constraints, options);
  REQUIRE(std::count(alone.pieces.begin(), alone.pieces.end(), Constraint{2, 1}) == 1);
  check_same(
      work,
      [](const tiles::GridInput&) {
        return Cuts({tiles::code_of({4096, 4096})});
      },
      options);
}

TEST_CASE("the corpus in tiles gives the bytes and the errors of one device") {
  const std::string folder = std::string(GCDT_TEST_DATA) + "/corpus";
  std::size_t entries = 0;
  for (const CorpusEntry& entry : read_manifest(folder)) {
    CAPTURE(entry.name);
    const Workload work = read_poly(folder + "/" + entry.name);
    for (const std::size_t tiles : {2, 3, 4, 7}) {
      CAPTURE(tiles);
      for (const Crossing crossing : {Crossing::reject, Crossing::drop, Crossing::split})
        check_same(work, evenly(tiles), with(crossing));
    }
    ++entries;
  }
  CHECK(entries > 20);
}

TEST_CASE("a device treated as a GPU gives the same bytes") {
  DevicePool pool({{cl::Context(), app_device(), treated_as(DeviceKind::gpu)}}, {}, {});
  for (const char* name : {"uniform", "letters", "line", "clusters"}) {
    CAPTURE(name);
    check_same(workload(name, 1500), evenly(3), with(Crossing::reject), pool);
  }
  Workload decimals = workload("uniform", 1500);
  for (auto& point : decimals.points)
    for (double& x : point) x = std::round(1000 * x) / 1000;
  check_same(decimals, evenly(3), with(Crossing::reject), pool);
  for (unsigned i = 0; i < 6; ++i) {  // with vertices that are one, and constraints that pass and cross
    CAPTURE(i);
    const Crossing crossing = std::array{Crossing::drop, Crossing::split}[i % 2];
    check_same(random_crossing(120, 12 + i, 30, 9000 + i), evenly(2 + i % 3), with(crossing), pool);
  }
}

cl::Device some_cpu() {
  for (const cl::Device& device : all_of_them)
    if (device.getInfo<CL_DEVICE_TYPE>() == CL_DEVICE_TYPE_CPU) return device;
  throw std::runtime_error("there is no CPU among the devices");
}

TEST_CASE("a CPU beside a GPU gets no tile, unless that is lost or has no room") {
  const Workload work = workload("letters", 3000);
  const OneProblem problem(work);
  const Singles alone({work});
  enum { healthy_gpu, small_gpu, lost_gpu };
  for (const int kind : {healthy_gpu, small_gpu, lost_gpu}) {
    CAPTURE(kind);
    const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
    constexpr std::uint64_t never = std::uint64_t{1} << 40;
    runtime::CallHook gpu = treated_as(DeviceKind::gpu);
    if (kind == small_gpu) gpu.tuning.memory_bytes = 24u << 20;
    if (kind == lost_gpu) gpu.before = failing(calls, never, true, CL_INVALID_COMMAND_QUEUE).before;
    std::atomic<bool> is_solved_by_cpu{false};
    const Trace trace = [&](const TraceSpan& span) {
      if (span.name == "take" && span.device_number == 1) is_solved_by_cpu = true;
    };
    DevicePool pool({{cl::Context(), app_device(), gpu}, {cl::Context(), some_cpu(), {}}}, {}, trace);
    Options options;
    options.progress = [&](const char* phase, double) {
      if (std::string(phase) == "tiles") *calls = never;  // from now on it fails
      return true;
    };
    const ForestResult made = tiles::triangulate_cut(pool, problem.view(), options, 4, evenly(4));
    CHECK(difference(test::part_of(made, 0), alone.meshes[0]) == "");
    CHECK(is_solved_by_cpu == (kind != healthy_gpu));
    CHECK(pool.report(0).lost.has_value() == (kind == lost_gpu));
  }
}

TEST_CASE("devices of two vendors share the tiles of one problem") {
  std::vector<DevicePool::Member> members;
  for (const cl::Device& device : all_of_them) members.push_back({cl::Context(), device, {}});
  DevicePool pool(std::move(members), {}, {});
  for (const char* name : {"uniform", "letters", "closed_comb", "clusters"}) {
    CAPTURE(name);
    check_same(workload(name, 4000), evenly(6), with(Crossing::reject), pool);
  }
}

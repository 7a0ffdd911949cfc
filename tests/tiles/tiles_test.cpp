// SPDX-License-Identifier: Apache-2.0
// One problem in tiles: the same arrays as from one device, wherever it is cut.
#include "corpus.hpp"
#include "pool_cases.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::test;
using tiles::Cuts;
using tiles::GridPoint;

namespace {

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

using Cut = std::function<Cuts(const std::vector<GridPoint>&)>;

/// The mesh, or the error's text.
std::pair<Triangulation, std::string> in_tiles(const Workload& work, const Cut& cut, const Options& options) {
  const OneProblem problem(work);
  try {
    const ForestResult made = tiles::triangulate_cut(halves(), problem.view(), options, cut);
    return {test::part_of(made, 0), ""};
  } catch (const Error& error) {
    return {{}, error.what()};
  }
}

Cut evenly(std::size_t tiles) {
  return [tiles](const std::vector<GridPoint>& points) { return tiles::even_cuts(points, tiles); };
}

/// At vertices and between them, some more than once.
Cut anywhere(std::size_t tiles, Random& random) {
  return [tiles, &random](const std::vector<GridPoint>& points) {
    std::vector<std::uint64_t> codes;
    while (codes.size() + 1 < tiles) {
      const std::uint64_t kind = random.below(4);
      if (kind == 0) codes.push_back(random.next() >> (2 + random.below(62)));
      if (kind == 1 && !codes.empty()) codes.push_back(codes.back());
      if (kind >= 2) codes.push_back(tiles::code_of(points[random.below(points.size())]) + kind - 2);
    }
    std::sort(codes.begin(), codes.end());
    return Cuts(codes);
  };
}

void check_same(const Workload& work, const Cut& cut, const Options& options) {
  const auto [mesh, error] = in_tiles(work, cut, options);
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

TEST_CASE("regions and domains are those of one device") {
  Random random(77002);
  for (unsigned i = 0; i < 60; ++i) {
    CAPTURE(i);
    const Workload work = random_crossing(1 + random.below(100), 2 + i % 40, random.below(60), 5000 + i);
    Options options = with(Crossing::drop);
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

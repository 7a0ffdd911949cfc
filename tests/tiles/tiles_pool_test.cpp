// SPDX-License-Identifier: Apache-2.0
// Tiles behind the interface: options, memory, devices that fail, errors.
#include <csignal>

#include <sys/resource.h>

#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "scratch_folder.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

Options in_tiles(std::uint32_t tiles) {
  Options options;
  options.tiles = tiles;
  return options;
}

BatchResult cut(const Workload& work, std::uint32_t tiles, const Options& options = {}) {
  Pool pool(test_device());
  Options own = options;
  own.tiles = tiles;
  return pool.triangulate(batch_of({work}), own);
}

}  // namespace

TEST_CASE("a pool cuts every problem of a batch into so many tiles, and says what that took") {
  const std::vector<Workload> problems = {
      uniform(2000),     workload("letters", 1500),           problem({}),
      problem({{1, 2}}), problem({{0, 0}, {1, 1}}, {{0, 5}}), workload("line", 300)};
  Pool pool(test_device());
  const BatchResult result = pool.triangulate(batch_of(problems), in_tiles(3));
  Singles(problems).check(result);
  CHECK(result.tiles(0).tiles == 3);
  CHECK(result.tiles(0).seam_vertices > 0);
  CHECK(result.tiles(0).seam_vertices < 1000);
  CHECK(pool.triangulate(batch_of(problems)).tiles(0).tiles == 0);
  CHECK(pool.triangulate(batch_of(problems), in_tiles(1)).tiles(0).tiles == 0);
}

TEST_CASE("errors of a problem in tiles are those of one device") {
  const auto inf = std::numeric_limits<double>::infinity();
  std::vector<Workload> problems = {problem({{0, 0}, {inf, 1}, {2, 2}}), problem({{0, 0}, {1, 0}, {0, 1}}, {{0, 3}}),
                                    random_crossing(60, 20, 40, 3), random_crossing(2000, 5000, 40, 4)};
  Pool pool(test_device());
  Singles(problems).check(pool.triangulate(batch_of(problems), in_tiles(4)));
}

TEST_CASE("a vertex outside of a fixed grid is named in tiles, whatever its constraint does") {
  for (const double x : {2147483647.6, 2147483648.0, 3e9, -0.6}) {
    CAPTURE(x);
    Workload work = random_pslg(300, 1 << 20, 0, 5);
    const auto outside = static_cast<std::uint32_t>(work.points.size());
    work.points.push_back({x, 5});
    work.constraints.push_back({0, outside});
    Options on_grid;
    on_grid.grid = FixedGrid{};
    const auto error = cut(work, 3, on_grid).error(0);
    REQUIRE(error);
    CHECK(error->status() == Status::coordinate_outside_grid);
    CHECK(error->indices() == std::vector<std::uint64_t>{outside, 0});
  }
}

TEST_CASE(
    "a constraint between vertices outside of a fixed grid, through a cut between others there, loses no device") {
  Workload work;
  constexpr std::uint32_t count = 300;
  for (std::uint32_t i = 0; i < count; ++i) work.points.push_back({2147483647.6, 1000.0 * i});
  for (std::uint32_t i = 0; i < count / 2; ++i) work.constraints.push_back({i, i + count / 2});
  Options on_grid;
  on_grid.grid = FixedGrid{};
  const auto error = cut(work, 3, on_grid).error(0);
  REQUIRE(error);
  CHECK(error->status() == Status::coordinate_outside_grid);
  CHECK(error->indices() == std::vector<std::uint64_t>{0, 0});
}

TEST_CASE("rounding makes the same vertices one in tiles as on one device") {
  Workload work = uniform(500);
  for (Point& p : work.points) p[0] += 1e9;  // so that x is rounded to 2^-23, and to 2^-31 of the extent
  work.points.push_back({work.points[7][0] + 1e-7, work.points[7][1]});
  work.points.push_back({0, 0});
  const Triangulation alone = solver().triangulate(work.points, work.constraints);
  REQUIRE(alone.statistics.vertices_rounded_together > 0);
  const BatchResult made = cut(work, 3);
  CHECK(made.rounded_together(0).first == alone.statistics.vertices_rounded_together);
  CHECK(made.rounded_together(0).second == alone.statistics.rounded_pair);
  Options distinct;
  distinct.distinct = true;
  CHECK(cut(work, 3, distinct).error(0)->status() == Status::vertices_coincide);
}

TEST_CASE("what tiles do not take is refused") {
  Solver alone(test_device());
  const std::vector<Point> points = uniform(20).points;
  CHECK(error_of([&] { alone.triangulate(points, {}, in_tiles(2)); }).status() == Status::invalid_argument);
  Pool pool(test_device());
  const auto refused = [&](const Options& options) {
    return error_of([&] { pool.triangulate(batch_of({uniform(20)}), options); }).status();
  };
  CHECK(refused(in_tiles(GCDT_MAX_TILES + 1)) == Status::invalid_argument);
  Options grid = in_tiles(2);
  grid.grid = FixedGrid{0, 0, "zero"};
  CHECK(refused(grid) == Status::invalid_argument);
}

TEST_CASE("a pool takes hole and region points with one problem, whole or in tiles, and with no more") {
  const Workload work = workload("nested_squares", 1500);
  Options options;
  options.domain = Domain::holes;
  options.hole_seeds = {work.points[7], {0, 0}, work.points[8]};
  options.region_seeds = {work.points[700], work.points[9]};
  const Singles expected({work}, options);
  REQUIRE(expected.meshes[0].triangles.size() > 0);
  REQUIRE(expected.meshes[0].statistics.triangles_removed > 0);
  Pool pool(test_device());
  for (const std::uint32_t tiles : {0u, 1u, 2u, 3u, 4u, 7u}) {
    CAPTURE(tiles);
    options.tiles = tiles;
    expected.check(pool.triangulate(batch_of({work}), options));
    const Error refused = error_of([&] { pool.triangulate(batch_of({work, work}), options); });
    CHECK(refused.status() == Status::invalid_argument);
    CHECK(std::string(refused.what()).find("a batch of 2 takes none") != std::string::npos);
  }
  CHECK(pool.triangulate(batch_of({}), options).size() == 0);
}

TEST_CASE("a problem that is too large for a device is cut into as many tiles as fit") {
  constexpr std::uint64_t memory = 72u << 20;  // half of it is needed whatever the problem
  Pool small(test_device(), {}, {}, memory), whole(test_device());
  for (const std::string name : {"uniform", "spiral"}) {
    CAPTURE(name);
    const Workload work = workload(name, 200000);
    const BatchResult expected = whole.triangulate(batch_of({work})), made = small.triangulate(batch_of({work}));
    CHECK((made.error(0) ? std::string(made.error(0)->what()) : "") == "");
    if (made.error(0)) continue;
    CHECK(expected.tiles(0).tiles == 0);
    CHECK(made.tiles(0).tiles > 1);
    CHECK(difference(detail::triangulation(made, 0), detail::triangulation(expected, 0)) == "");
  }
  // One vertex far below a row: all but a few vertices are in the seam, whatever the tiles are.
  const BatchResult refused = small.triangulate(batch_of({workload("row", 400000)}));
  CHECK(refused.error(0)->status() == Status::out_of_memory);
  CHECK(std::string(refused.error(0)->what()).find("seam") != std::string::npos);
  CHECK(small.triangulate(batch_of({workload("uniform", 300000)}), in_tiles(1)).error(0)->status() ==
        Status::out_of_memory);
}

TEST_CASE("tiles are spilled to files, of which nothing is left, and the mesh is the same") {
  constexpr std::uint64_t memory = 72u << 20;
  const testing::ScratchFolder folder;
  const auto is_empty = [&] { return folder.names().empty(); };
  const Workload work = workload("uniform", 300000);
  const Options many = in_tiles(16);  // small ones, of which few have room beside what each run needs
  Pool whole(test_device()), small(test_device(), {}, {}, memory, folder / "");
  const BatchResult expected = whole.triangulate(batch_of({work}));
  const auto check = [&] {
    const BatchResult made = small.triangulate(batch_of({work}), many);
    CHECK((made.error(0) ? std::string(made.error(0)->what()) : "") == "");
    if (!made.error(0)) CHECK(difference(detail::triangulation(made, 0), detail::triangulation(expected, 0)) == "");
    CHECK(is_empty());
  };
  check();

  // Files of the process may have no more than half a megabyte: as on a full disk, writing fails.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{}, little{};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
  little = {1u << 19, before.rlim_max};
  REQUIRE(setrlimit(RLIMIT_FSIZE, &little) == 0);
  const BatchResult refused = small.triangulate(batch_of({work}), many);
  REQUIRE(setrlimit(RLIMIT_FSIZE, &before) == 0);
  REQUIRE(refused.error(0).has_value());
  CHECK(refused.error(0)->status() == Status::spill_failed);
  CHECK(std::string(refused.error(0)->what()).find(folder / "") != std::string::npos);
  CHECK(is_empty());
  check();

  Pool nowhere(test_device(), {}, {}, memory, folder / "none");
  CHECK(nowhere.triangulate(batch_of({work}), many).error(0)->status() == Status::spill_failed);
}

TEST_CASE("tiles can be cancelled, and the pool is usable afterwards") {
  Pool pool(test_device());
  const Workload work = workload("letters", 5000);
  for (const char* last : {"tiles", "seam", "join"}) {
    CAPTURE(last);
    Options options = in_tiles(4);
    options.progress = [&](const char* phase, double) { return std::string(phase) != last; };
    CHECK(error_of([&] { pool.triangulate(batch_of({work}), options); }).status() == Status::cancelled);
  }
  Singles({work}).check(pool.triangulate(batch_of({work}), in_tiles(4)));
}

TEST_CASE("a device that fails at its k-th OpenCL call changes no byte of a problem in tiles") {
  const Workload work = workload("letters", 800);
  const RaggedBatch batch({work});
  const Singles expected({work});
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  const auto run = [&](std::uint64_t k, bool for_good) {
    *calls = 0;
    DevicePool pool({{cl::Context(), app_device(), failing(calls, k, for_good, CL_INVALID_COMMAND_QUEUE)},
                     {cl::Context(), app_device(), healthy()}},
                    {}, {});
    expected.check(tiles::triangulate(pool, batch.view(), in_tiles(4)));
    return pool.report(0).lost.has_value();
  };
  CHECK(!run(0, false));
  const std::uint64_t all = *calls;
  REQUIRE(all > 300);
  std::uint64_t lost = 0;
  for (std::uint64_t i = 0; i < 24; ++i) lost += run(1 + i * all / 24, i % 2 == 0);
  CHECK(lost > 8);
}

TEST_CASE(
    "a device that is lost when its tiles are solved changes no byte, be it in the seam or when they are written") {
  const Workload work = workload("letters", 800);
  const RaggedBatch batch({work});
  const Singles expected({work});
  constexpr std::uint64_t never = std::uint64_t{1} << 40;
  int lost = 0;
  for (int i = 0; i < 4; ++i) {
    CAPTURE(i);
    const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
    DevicePool pool({{cl::Context(), app_device(), failing(calls, never, true, CL_INVALID_COMMAND_QUEUE)},
                     {cl::Context(), app_device(), healthy()}},
                    {}, {});
    Options options = in_tiles(4);
    options.progress = [&](const char* phase, double done) {
      if (std::string(phase) == "tiles" && done > 0.699) *calls = never;  // all are solved: it fails from now on
      return true;
    };
    expected.check(tiles::triangulate(pool, batch.view(), options));
    lost += pool.report(0).lost.has_value();
  }
  CHECK(lost > 0);  // unless the other one has solved all tiles
}

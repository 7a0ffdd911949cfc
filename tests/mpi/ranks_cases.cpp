// SPDX-License-Identifier: Apache-2.0
// One problem by the ranks of MPI that run this: at the first one the arrays, or the error, that one device gives.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "mpi_team.hpp"
#include "pool_cases.hpp"
#include "tiles/input_exchange.hpp"
#include "tiles/ranks.hpp"

using namespace gcdt;
using namespace gcdt::test;
using tiles::Cuts;

namespace {

std::unique_ptr<ranks::MpiTeam> all_ranks;
tiles::Team& team() { return *all_ranks; }

/// The same device for all ranks.
DevicePool& pool() {
  static DevicePool own({{cl::Context(), app_device(), {}}}, {}, {});
  return own;
}

/// What the rank is given of the input.
tiles::InputBlock block_of(const Workload& work) {
  tiles::InputBlock block;
  block.all_vertices = work.points.size(), block.all_constraints = work.constraints.size();
  const auto part = [&](const auto& all, auto& own) {
    const auto at = [&](std::size_t rank) {
      return all.begin() + static_cast<std::ptrdiff_t>(tiles::begin_of_part(all.size(), rank, team().size()));
    };
    own.assign(at(team().rank()), at(team().rank() + 1));
  };
  part(work.points, block.vertices);
  part(work.constraints, block.constraints);
  return block;
}

/// At vertices and between them, some more than once; the same for every rank, which all have the workload.
std::function<Cuts(const tiles::GridInput&)> anywhere(const Workload& work, std::size_t tiles, std::uint64_t seed) {
  return [&work, tiles, seed](const tiles::GridInput& block) {
    Random random(seed);
    const tiles::GridInput all{{Points(work.points), 0, {}, work.points.size()}, block.chosen, {}, {}, {}};
    std::vector<std::uint64_t> codes;
    while (codes.size() + 1 < tiles) {
      const std::uint64_t kind = random.below(4);
      if (kind == 0) codes.push_back(random.next() >> (2 + random.below(62)));
      if (kind == 1 && !codes.empty()) codes.push_back(codes.back());
      if (kind >= 2) codes.push_back(tiles::code_of(all.at(random.below(all.n()))) + kind - 2);
    }
    std::sort(codes.begin(), codes.end());
    return Cuts(codes);
  };
}

std::function<Cuts(const tiles::GridInput&)> evenly(std::size_t tiles) {
  return [tiles](const tiles::GridInput& block) { return tiles::even_cuts(block, tiles, team()); };
}

void check_same(const Workload& work, std::size_t tiles, const std::function<Cuts(const tiles::GridInput&)>& cut,
                const Options& options) {
  std::string error;
  ForestResult made;
  try {
    tiles::RankResult own = tiles::triangulate_rank(pool(), team(), block_of(work), options, tiles, cut);
    made = tiles::gather_result(team(), own, work.points, work.constraints, options);
  } catch (const Error& failed) {
    error = failed.what();
  }
  CHECK(team().sum(error.empty() ? 0 : 1) == (error.empty() ? 0 : team().size()));  // all ranks threw, or none
  if (!team().is_first()) return;
  const Singles alone({work}, options);
  CHECK(error == alone.errors[0]);
  if (alone.errors[0].empty() && error.empty()) CHECK(difference(test::part_of(made, 0), alone.meshes[0]) == "");
}

Options with(Crossing crossing) {
  Options options;
  options.crossing = crossing;
  return options;
}

}  // namespace

TEST_CASE("random graphs, cut anywhere, give the bytes and the errors of one device") {
  for (unsigned i = 0; i < 20; ++i) {
    CAPTURE(i);
    Random random(88000 + i);
    const auto side = static_cast<std::uint32_t>(2 + random.below(i % 3 == 0 ? 6 : 60));
    const std::size_t n = 1 + random.below(120), m = random.below(40);
    const Workload work = i % 2 ? random_pslg(n, side, m, i) : random_crossing(n, side, m, i);
    const std::size_t tiles = team().size() * (1 + i % 3);
    for (const Crossing crossing : {Crossing::reject, Crossing::drop, Crossing::split}) {
      CAPTURE(static_cast<int>(crossing));
      check_same(work, tiles, anywhere(work, tiles, i), with(crossing));
    }
  }
}

TEST_CASE("workloads, cut evenly, give the bytes of one device") {
  for (const std::string& name : workload_names()) {
    CAPTURE(name);
    const Workload work = workload(name, 2000);
    check_same(work, team().size(), evenly(team().size()), with(Crossing::drop));
  }
}

TEST_CASE("regions and domains are those of one device") {
  for (const char* name : {"nested_squares", "letters", "spiral"}) {
    CAPTURE(name);
    Options options = with(Crossing::split);
    options.domain = Domain::even_odd;
    const Workload work = workload(name, 1500);
    check_same(work, team().size(), evenly(team().size()), options);
    options.domain = Domain::holes;
    for (std::size_t i = 0; i < 30; ++i) {
      const Point &a = work.points[i * 31], &b = work.points[i * 47];
      (i % 5 ? options.region_seeds : options.hole_seeds).push_back(i % 2 ? a : Point{(a[0] + b[0]) / 2, b[1]});
    }
    check_same(work, team().size(), evenly(team().size()), options);
  }
}

TEST_CASE("invalid input is the error of one device at every rank") {
  Workload work = workload("uniform", 300);
  work.points[250][1] = std::numeric_limits<double>::infinity();
  check_same(work, team().size(), evenly(team().size()), {});
  work = workload("uniform", 300);
  work.constraints = {{0, 1}, {2, 3}, {4, 300}, {5, 301}};
  check_same(work, team().size(), evenly(team().size()), {});
  Options options;
  options.grid = FixedGrid{0.5, 0, "1e-9"};
  check_same(work, team().size(), evenly(team().size()), options);
}

TEST_CASE("rounding that makes vertices one is told, and refused where that is asked for") {
  Workload work;
  for (int i = 0; i < 60; ++i) work.points.push_back({i / 8.0, (i * i % 17) / 4.0});
  Options options;
  options.grid = FixedGrid{0, 0, "1"};
  check_same(work, 2 * team().size(), evenly(2 * team().size()), options);
  options.distinct = true;
  check_same(work, 2 * team().size(), evenly(2 * team().size()), options);
}

TEST_CASE("a rank gets the coordinates of any vertices as they were given") {
  const Workload work = workload("uniform", 500);
  const tiles::RankResult own =
      tiles::triangulate_rank(pool(), team(), block_of(work), {}, team().size(), evenly(team().size()));
  const tiles::GridInput all{{Points(work.points), 0, {}, work.points.size()}, own.chosen, {}, {}, {}};
  std::vector<tiles::Wanted> wanted;
  for (std::uint32_t v = static_cast<std::uint32_t>(team().rank()); v < 500; v += 3) wanted.push_back({v, all.at(v)});
  const auto found = tiles::coordinates_of(team(), own, wanted);
  REQUIRE(found.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) CHECK(found[i] == work.points[wanted[i].number]);
}

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  all_ranks = std::make_unique<ranks::MpiTeam>(MPI_COMM_WORLD);
  int failed = doctest::Context(argc, argv).run();
  all_ranks.reset();
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return failed;
}

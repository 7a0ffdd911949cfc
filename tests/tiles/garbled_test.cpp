// SPDX-License-Identifier: Apache-2.0
// What devices give back of tiles and seam is garbled, array by array: each time the call ends in the error that names
// what is not there, or another device takes over, and nothing is read or written where there is nothing.
#include "batch/pipeline.hpp"
#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "tiles/passages.hpp"
#include "tiles/seam.hpp"
#include "tiles/spilled.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::test;
using tiles::GridPoint;

namespace {

/// What a device of these kernels makes wrongly, and what is said of it.
struct Garbled {
  const char *from, *to, *reason;
};

/// Some vertices twice, letters, which have pieces, and a constraint that no tile has.
Workload with_everything() {
  Workload work = workload("letters", 4000);
  for (std::size_t i = 0; i < 40; ++i) work.points.push_back(work.points[i * 7]);
  return work;
}

Options in_tiles(bool check, bool regions = false) {
  Options options;
  options.tiles = 4;
  options.check = check;
  options.crossing = Crossing::drop;
  options.regions = regions;
  return options;
}

void is_refused(const std::string& reason, const std::function<void()>& use) {
  try {
    use();
    FAIL_CHECK("nothing is thrown: " << reason);
  } catch (const Error& error) {
    CHECK(error.status() == Status::check_failed);
    CHECK_MESSAGE(std::string(error.what()).find("tiles: " + reason) != std::string::npos, error.what());
  }
}

constexpr char border[] =
    "(uint4)(before[t], corners[3u * t + next_corner(k)], corners[3u * t + previous_corner(k)], k | marks);";

}  // namespace

TEST_CASE("numbers of a tile that are none end its device, with or without the check, and another one takes over") {
  const Garbled all[] = {
      {"merged[before[v]] = (uint2)(ids[v], ids[representatives[v]]);",
       "merged[before[v]] = (uint2)(ids[v] | 0x40000000u, ids[representatives[v]]);",
       "a merged vertex is none of the input"},
      {"merged[before[v]] = (uint2)(ids[v], ids[representatives[v]]);",
       "merged[before[v]] = (uint2)(ids[v], ids[representatives[v]] | 0x40000000u);",
       "a merged vertex is none of the input"},
      {border, "(uint4)(before[t] | 0x40000000u, 0u, 0u, k | marks);", "an edge of the border is of no final triangle"},
      {border, "(uint4)(before[t], corners[3u * t] | 0x40000000u, corners[3u * t], k | marks);",
       "an edge of the border is of no final triangle"},
      {border, "(uint4)(before[t], corners[3u * t], corners[3u * t + 1u] | 0x40000000u, k | marks);",
       "an edge of the border is of no final triangle"},
      {border, "(uint4)(before[t], corners[3u * t], corners[3u * t + 1u], 3u | marks);",
       "an edge of the border is of no final triangle"},
      {"out_corners[3u * place + k] = used_before[corners[3u * t + k]];",
       "out_corners[3u * place + k] = used_before[corners[3u * t + k]] | 0x40000000u;",
       "a triangle of a tile has a corner or a neighbour that is not there"},
      {"(int)near_before[other] : -1;", "(int)near_before[other] : -7;",
       "a triangle of a tile has a corner or a neighbour that is not there"},
      {"numbers[place] = t;", "numbers[place] = t | 0x40000000u;", "a triangle near a constraint is none of the tile"},
      // Lists of a tile's own numbers have none so great.
      {"out[i] = from[list[i]];\n}\nkernel",
       "out[i] = from[list[i]] | (from[list[i]] > 2500u ? 0x40000000u : 0u);\n}\nkernel", ""},
      {"counts[i] = low;\n", "counts[i] = low + kept + 1u;\n", "a piece of the seam has no place among the tile's"},
      {"source_counts[i] = with_offsets ? offsets[low] : low;", "source_counts[i] = 0x40000000u - i;",
       "a piece of the seam has no place among the tile's"},
      {"seam_ends[place] = ends[p], seam_offsets[place] = at;",
       "seam_ends[place] = ends[p] | 0x40000000u, seam_offsets[place] = at;",
       "the end of a piece is no vertex of the tile"},
      {"list[i] < constraints ? places[list[i]] : 0xFFFFFFFFu;", "0xFFFFFFFFu;",
       "a source of a piece is no constraint of the input"},
      {"numbers[place] = first + c;", "numbers[place] = first + c + 0x40000000u;",
       "an open constraint is none of the input"},
      {"before[i] = all_final ? low : finals_before[low];", "before[i] = low + triangles + 1u;",
       "a triangle of the seam has no place among the final ones"},
      {"before[i] = all_final ? low : finals_before[low];", "before[i] = i % 2u == 0u ? triangles : low;",
       "a triangle of the seam has no place among the final ones"},
  };
  const Workload work = with_everything();
  const RaggedBatch batch({work});
  Options one_device = in_tiles(true);
  one_device.tiles = 0;
  const Singles expected({work}, one_device);
  for (const bool check : {false, true})
    for (const Garbled& one : all) {
      CAPTURE(std::string(one.to));
      const TextEdit edit{one.from, one.to};
      is_refused(one.reason, [&] {
        DevicePool pool({{cl::Context(), app_device(), editing({edit})}}, {}, {});
        tiles::triangulate(pool, batch.view(), in_tiles(check));
      });
      CHECK(*edit.matched > 0);
      DevicePool pool({{cl::Context(), app_device(), editing({edit})}, {cl::Context(), app_device(), healthy()}}, {},
                      {});
      expected.check(tiles::triangulate(pool, batch.view(), in_tiles(check)));
    }
}

TEST_CASE("corners and neighbours that were written where none are, join and domain refuse") {
  const Garbled all[] = {
      {"out_corners[3u * place + k] = ids[corners[3u * t + k]];",
       "out_corners[3u * place + k] = ids[corners[3u * t + k]] | 0x40000000u;", ""},
      {"other == GCDT_NONE ? -1 : (int)(first + other);",
       "other == GCDT_NONE ? -1 : (int)(first + other) | 0x40000000;",
       "a triangle has a corner or a neighbour that is not there"},
      {"other == GCDT_NONE ? -1 : (int)(first + other);", "other == GCDT_NONE ? -1 : -7;",
       "a triangle has a corner or a neighbour that is not there"},
  };
  const RaggedBatch batch({with_everything()});
  for (const bool check : {false, true})
    for (const Garbled& one : all) {
      CAPTURE(std::string(one.to));
      const TextEdit edit{one.from, one.to};
      DevicePool pool({{cl::Context(), app_device(), editing({edit})}}, {}, {});
      is_refused(one.reason, [&] { tiles::triangulate(pool, batch.view(), in_tiles(check, true)); });
      CHECK(*edit.matched > 0);
    }
}

namespace {

/// A tile's mesh, as it is read to be walked.
struct Walked {
  std::vector<tiles::Triangle> triangles;
  std::vector<tiles::Neighbours> neighbours;
  std::vector<GridPoint> points;

  Walked() {
    const Workload work = uniform(300);
    Options options;
    options.grid = FixedGrid{0, 0, "1"};
    std::vector<std::array<std::int32_t, 2>> whole;
    for (const Point& p : work.points)
      whole.push_back({static_cast<std::int32_t>(p[0] * 1e6), static_cast<std::int32_t>(p[1] * 1e6)});
    const Triangulation mesh = solver().triangulate(whole, {}, options);
    triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
    neighbours.assign(mesh.neighbours.begin(), mesh.neighbours.end());
    points = whole;
  }
  std::vector<std::uint32_t> passed(std::uint32_t from = 0, std::uint32_t to = 299) const {
    return tiles::passed_by({triangles, neighbours, points}, {{from, to, false}, {to, from, true}});
  }
};

}  // namespace

TEST_CASE("a walk through what is no mesh ends, in an error") {
  const Walked right;
  REQUIRE(!right.passed().empty());
  const std::string absent = "a triangle of a tile has a corner or a neighbour that is not there";
  for (const std::uint32_t v : {300u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
    Walked wrong = right;
    wrong.triangles[100][1] = v;
    is_refused(absent, [&] { wrong.passed(); });
  }
  for (const std::int32_t t : {-2, static_cast<std::int32_t>(right.triangles.size()), 0x7FFFFFFF}) {
    Walked wrong = right;
    wrong.neighbours[100][2] = t;
    is_refused(absent, [&] { wrong.passed(); });
  }
  Walked without = right;
  for (tiles::Triangle& t : without.triangles)
    for (std::uint32_t& v : t) v = v == 0 ? 1 : v;
  is_refused("a constraint ends at a vertex that no triangle of the tile has", [&] { without.passed(); });

  Random random(20119);
  std::size_t refused = 0;
  for (int i = 0; i < 400; ++i) {  // numbers that are there, and wrong
    Walked wrong = right;
    for (int j = 0; j < 1 + i % 50; ++j) {
      const std::size_t t = random.below(wrong.triangles.size()), k = random.below(3);
      if (j % 2)
        wrong.triangles[t][k] = static_cast<std::uint32_t>(random.below(300));
      else
        wrong.neighbours[t][k] = static_cast<std::int32_t>(random.below(wrong.triangles.size()));
    }
    try {
      for (const std::uint32_t t : wrong.passed()) REQUIRE(t < wrong.triangles.size());
    } catch (const Error& error) {
      CHECK(error.status() == Status::check_failed);
      ++refused;
    }
  }
  CHECK(refused > 20);
}

TEST_CASE("a mesh of the seam whose numbers are none is refused") {
  // A square between two tiles, with a constraint along its diagonal.
  tiles::Seam seam;
  seam.points = tiles::GridPoints{{0, 0}, {8, 0}, {0, 8}, {8, 8}};
  seam.ids = {0, 1, 2, 3};
  seam.firsts = {0, 2, 4};
  seam.constraints.push_back({0, 3});
  seam.open = {0};
  struct Arrays {
    std::vector<tiles::Triangle> triangles{{0, 1, 3}, {0, 3, 2}};
    std::vector<tiles::Neighbours> neighbours{{-1, 1, -1}, {-1, -1, 0}};
    std::vector<std::uint8_t> constrained{2, 4};
    std::vector<Constraint> pieces{{0, 3}};
    std::vector<std::uint32_t> offsets{0, 1}, sources{0};
    tiles::ProblemMesh mesh() const {
      tiles::ProblemMesh made;
      made.triangles = triangles, made.neighbours = neighbours, made.constrained = constrained;
      made.pieces = pieces, made.source_offsets = offsets, made.sources = sources;
      return made;
    }
  };
  const auto take = [&](Arrays arrays) {
    return tiles::take_seam(seam, arrays.mesh(), arrays.neighbours.data(), arrays.constrained.data()).kept;
  };
  const Arrays right;
  CHECK(take(right) == std::vector<std::uint8_t>{1, 1});
  const auto check = [&](const char* reason, const std::function<void(Arrays&)>& garble) {
    Arrays wrong = right;
    garble(wrong);
    is_refused(reason, [&] { take(wrong); });
  };
  const char* const triangle = "a triangle of the seam has a corner or a neighbour that is not there";
  check(triangle, [](Arrays& a) { a.triangles[1][2] = 4; });
  check(triangle, [](Arrays& a) { a.neighbours[0][1] = 2; });
  check(triangle, [](Arrays& a) { a.neighbours[0][1] = -2; });
  check("the seam's mesh is not whole", [](Arrays& a) { a.neighbours.pop_back(); });
  check("the seam's mesh is not whole", [](Arrays& a) { a.constrained.pop_back(); });
  check("the end of a piece is no vertex of the seam", [](Arrays& a) { a.pieces[0][1] = 4; });
  check("the sources of a piece of the seam are not there", [](Arrays& a) { a.offsets[1] = 9; });
  check("the sources of a piece of the seam are not there", [](Arrays& a) { a.offsets[0] = 1; });
  check("a source of a piece is no constraint of the seam", [](Arrays& a) { a.sources[0] = 1; });
  check("a constrained edge is no piece", [](Arrays& a) { a.constrained[0] = 3; });
}

namespace {

/// Three final triangles in a row, that have been spilled, and one of the seam between the first two.
struct SpilledTile {
  std::vector<std::array<double, 2>> points{{0, 0}, {4, 0}, {0, 4}, {5, 5}, {1, 9}};
  std::vector<cl_uint> corners{0, 1, 2, 1, 3, 2, 2, 3, 4};
  std::vector<cl_int> neighbours{1, -1, -1, 2, 0, -1, -1, -1, 1};
  std::vector<std::array<std::uint64_t, 2>> keys{{1, 1}};

  void write() const {
    runtime::Runtime runtime(app_device());
    tiles::FinalTriangles final;
    final.count = 3;
    final.corners = runtime.upload("corners", corners);
    final.neighbours = runtime.upload("neighbours", neighbours);
    final.constrained = runtime.filled<cl_uchar>("flags", 3, 0);
    final.codes.resize(1);
    final.codes[0] = 0;
    final.spill(runtime, {});
    tiles::GridInput input{{Points(points), 0, {}, points.size()}, {}, {}, {{}, 0, {}, 0, {}}, {}};
    input.chosen = fixed_grid(FixedGrid{0, 0, "1"});
    std::vector<tiles::Triangle> to(4);
    std::vector<tiles::Neighbours> others(4);
    std::vector<std::uint8_t> flags(4);
    std::vector<std::uint32_t> before;
    const tiles::TilePlaces places{0, static_cast<std::uint32_t>(keys.size()), [this] { return keys; }};
    tiles::write_spilled(input, {{final, places, {to.data(), others.data(), flags.data()}, before}});
    CHECK(before == std::vector<std::uint32_t>{1});
    CHECK(to[2] == tiles::Triangle{1, 3, 2});
    CHECK(others[2] == tiles::Neighbours{3, 0, -1});
  }
};

}  // namespace

TEST_CASE("a spilled tile whose corners or neighbours are none is not written") {
  SpilledTile().write();
  for (const cl_uint v : {5u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
    SpilledTile wrong;
    wrong.corners = {v, 1, 2, v, 3, 2, v, 3, 4};
    is_refused("a vertex is asked for where it is not", [&] { wrong.write(); });
  }
  for (const cl_int t : {3, 0x7FFFFFFF}) {
    SpilledTile wrong;
    wrong.neighbours[3] = t;
    is_refused("a final triangle has a neighbour that is not there", [&] { wrong.write(); });
  }
}

TEST_CASE("shifts that fall, or of more triangles than there are, are refused") {
  const std::string reason = "a triangle of the seam has no place among the final ones";
  is_refused(reason, [] { tiles::Shifts({2, 1}, 5); });
  is_refused(reason, [] { tiles::Shifts({2, 6}, 5); });
}

TEST_CASE("tiles that wait in the result's arrays leave these where the result needs larger ones") {
  runtime::Runtime runtime(app_device());
  tiles::FinalTriangles final;
  final.count = 2;
  final.corners = runtime.upload("corners", std::vector<cl_uint>{0, 1, 2, 3, 4, 5});
  final.neighbours = runtime.upload("neighbours", std::vector<cl_int>{1, -1, -1, 0, -1, -1});
  final.constrained = runtime.upload("flags", std::vector<cl_uchar>{5, 6});
  std::vector<tiles::Triangle> triangles(2);
  std::vector<tiles::Neighbours> neighbours(2);
  std::vector<std::uint8_t> constrained(2);
  final.spill(runtime, {{}, {triangles.data(), neighbours.data(), constrained.data()}});
  REQUIRE(final.is_in_result());
  final.leave_result();
  CHECK(!final.is_in_result());
  triangles = {}, neighbours = {}, constrained = {};
  CHECK(final.berth().triangles[1] == tiles::Triangle{3, 4, 5});
  CHECK(final.berth().neighbours[1] == tiles::Neighbours{0, -1, -1});
  CHECK(final.berth().constrained[1] == 6);
}

// SPDX-License-Identifier: Apache-2.0
// Constraints of forests, enforced problem by problem, one after the other, against CGAL's constrained Delaunay
// triangulations and the pieces that brute force finds, on CPUs whose work-items are threads' loops.
#include "phases/enforce.hpp"
#include "constraint_oracle.hpp"
#include "forest_fixture.hpp"
#include "oracle.hpp"

using namespace fixture;

namespace {

runtime::Runtime& threads() {
  static const std::unique_ptr<runtime::Runtime> made = threads_runtime(runtime::Meshes::many);
  return *made;
}

/// A problem's points and pairs of them.
struct Problem {
  std::vector<Point> points;
  std::vector<Constraint> constraints;
};

/// Points are put along the curve; constraints follow.
void put_along_curve(Problem& problem) {
  const std::vector<Point> ranked = along_curve(problem.points);
  const auto place = [&](std::uint32_t v) {
    return std::uint32_t(std::find(ranked.begin(), ranked.end(), problem.points[v]) - ranked.begin());
  };
  for (Constraint& c : problem.constraints) c = {place(c[0]), place(c[1])};
  problem.points = ranked;
}

/// A grown forest with the constraints of its problems on the device, each end by one of its vertex's inputs.
struct Enforced {
  std::vector<Problem> problems;
  ForestOnDevice forest;
  std::vector<HostMesh> before;
  EnforceResult result;
  std::vector<std::vector<bool>> kept;  ///< by brute force, each constraint of each problem
  std::vector<cl_uint> crosses;         ///< what the result should say

  explicit Enforced(std::vector<Problem> given, bool past_crossings = false)
      : problems(ranked(std::move(given))), forest(threads(), points()) {
    forest.grow();
    before = forest.now();
    std::vector<cl_uint> first = {0};
    std::vector<cl_uint2> pairs;
    for (std::size_t p = 0; p < problems.size(); ++p) {
      for (const Constraint& c : problems[p].constraints)
        pairs.push_back({{input_of(forest.begin[p] + c[0]), input_of(forest.begin[p] + c[1])}});
      first.push_back(cl_uint(pairs.size()));
    }
    Primitives primitives(threads());
    result = enforce_problems(threads(), primitives, forest.vertices, forest.mesh,
                              threads().upload("first constraints", first), threads().upload("constraints", pairs),
                              past_crossings, forest.counters);
    for (const Problem& problem : problems) {
      const auto crossing = test::dropped(problem.points, problem.constraints);
      kept.emplace_back(problem.constraints.size(), true);
      crosses.resize(crosses.size() + problem.constraints.size());
      const auto own = crosses.end() - static_cast<std::ptrdiff_t>(problem.constraints.size());
      for (const std::uint32_t c : crossing) {
        kept.back()[c] = false;
        if (past_crossings || c == crossing[0]) own[c] = 1;
      }
      if (!past_crossings && !crossing.empty()) std::fill(kept.back().begin() + crossing[0], kept.back().end(), false);
    }
    if (std::count(crosses.begin(), crosses.end(), 1u) == 0) crosses.clear();
  }
  /// The constraints of a problem that are to be enforced.
  std::vector<Constraint> kept_of(std::size_t p) const {
    std::vector<Constraint> own;
    for (std::size_t c = 0; c < kept[p].size(); ++c)
      if (kept[p][c]) own.push_back(problems[p].constraints[c]);
    return own;
  }

 private:
  static std::vector<Problem> ranked(std::vector<Problem> all) {
    for (Problem& problem : all) put_along_curve(problem);
    return all;
  }
  std::vector<std::vector<Point>> points() const {
    std::vector<std::vector<Point>> all;
    for (const Problem& problem : problems) all.push_back(problem.points);
    return all;
  }
  // The first and the last one by turns.
  cl_uint input_of(cl_uint v) {
    last_ = !last_;
    const auto& inputs = forest.input_vertex;
    return last_ ? cl_uint(inputs.rend() - std::find(inputs.rbegin(), inputs.rend(), v)) - 1
                 : cl_uint(std::find(inputs.begin(), inputs.end(), v) - inputs.begin());
  }
  bool last_ = false;
};

/// Each piece of all problems, in vertices of the forest, with the constraints that have it.
std::map<Constraint, std::vector<std::uint32_t>> expected_sources(const Enforced& made) {
  std::map<Constraint, std::vector<std::uint32_t>> all;
  std::uint32_t number = 0;
  for (std::size_t p = 0; p < made.problems.size(); ++p)
    for (std::size_t c = 0; c < made.problems[p].constraints.size(); ++c, ++number) {
      if (!made.kept[p][c]) continue;
      for (const Constraint& piece : pieces_of(made.problems[p].points, made.problems[p].constraints[c]))
        all[{made.forest.begin[p] + piece[0], made.forest.begin[p] + piece[1]}].push_back(number);
    }
  return all;
}

/// Pieces and their sources are those of docs/contract.md, 3, in order.
void check_pieces(const Enforced& made) {
  const auto wanted = expected_sources(made);
  const Pieces& pieces = made.result.pieces;
  REQUIRE(pieces.count == wanted.size());
  std::vector<cl_uint2> ends(pieces.count);
  std::vector<cl_uint> offsets(std::size_t{pieces.count} + 1), sources(pieces.source_count);
  threads().read(pieces.ends, ends.data(), ends.size());
  threads().read(pieces.source_offsets, offsets.data(), offsets.size());
  threads().read(pieces.sources, sources.data(), sources.size());
  std::size_t place = 0, constraints = 0, without_length = 0;
  for (const auto& [piece, from] : wanted) {  // in order of the lower rank, then the higher one
    CHECK(Constraint{ends[place].s[0], ends[place].s[1]} == piece);
    CHECK(std::vector<std::uint32_t>(sources.begin() + offsets[place], sources.begin() + offsets[place + 1]) == from);
    ++place;
  }
  CHECK(offsets.back() == sources.size());
  for (std::size_t p = 0; p < made.problems.size(); ++p)
    for (const Constraint& c : made.kept_of(p)) ++constraints, without_length += c[0] == c[1];
  CHECK(made.result.zero_length == without_length);
  CHECK(made.result.hits == sources.size() - (constraints - without_length));
}

/// Every problem's mesh is CGAL's under its constraints, and just their pieces are marked.
void check_meshes(const Enforced& made) {
  const std::vector<HostMesh> after = made.forest.now();
  for (std::size_t p = 0; p < after.size(); ++p) {
    CAPTURE(p);
    const Problem& problem = made.problems[p];
    REQUIRE(invalid_reason(after[p], after[p].n) == "");
    CHECK(illegal_edges(after[p]) == 0);
    CHECK(marked_edges(after[p]) == expected_pieces(problem.points, made.kept_of(p)));
    CHECK(finite_faces(after[p]) == expected_faces(problem.points, made.kept_of(p)));
  }
}

void check_all(const Enforced& made) {
  CHECK(made.result.crosses == made.crosses);
  check_pieces(made);
  check_meshes(made);
}

void check_enforced(std::vector<Problem> problems) {
  const Enforced made(std::move(problems));
  REQUIRE(made.crosses.empty());
  check_all(made);
}

/// Two rows of points, and a constraint between them from end to end, which crosses all edges from row to row.
Problem strip(std::uint32_t length, std::int64_t height) {
  Problem problem;
  for (std::uint32_t i = 0; i < length; ++i) {
    problem.points.push_back({10 * std::int64_t(i), 0});
    problem.points.push_back({10 * std::int64_t(i), height});
  }
  const std::int64_t end = 10 * std::int64_t(length);
  problem.points.push_back({0, height / 2});
  problem.points.push_back({end, height / 2 + 1});
  problem.constraints = {{2 * length, 2 * length + 1}};
  return problem;
}

/// A centre with `spokes` points around it, all joined to it, and a ring of points further out.
Problem fan(std::uint32_t spokes) {
  Problem problem;
  problem.points = {{100000, 100000}};
  for (std::uint32_t i = 0; i < spokes; ++i) {
    // On the sides of a square, so that coordinates are integers and the directions differ.
    const std::int64_t along = 4 * 2000 * std::int64_t(i) / spokes, at = along % 2000;
    const std::array<Point, 4> sides = {{{at, 0}, {2000, at}, {2000 - at, 2000}, {0, 2000 - at}}};
    const Point& q = sides[std::size_t(along / 2000)];
    problem.points.push_back({99000 + q[0], 99000 + q[1]});
    problem.constraints.push_back({i % 2 == 0 ? 0 : i + 1, i % 2 == 0 ? i + 1 : 0});
  }
  return problem;
}

}  // namespace

TEST_CASE("random constraints of all kinds become edges, and the mesh is CGAL's under them") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    CAPTURE(seed);
    std::vector<Problem> problems;
    for (const std::vector<Point>& points : small_problems(seed)) {
      problems.push_back({along_curve(points), {}});
      Random random{seed + problems.size()};
      if (!points.empty())
        problems.back().constraints = random_constraints(problems.back().points, points.size(), random);
    }
    check_enforced(problems);
  }
}

TEST_CASE("a constraint across hundreds of faces, through a strip and through scattered points") {
  std::vector<Problem> problems = {strip(2, 20), strip(3, 6), strip(50, 20), strip(400, 8), strip(400, 2000)};
  Problem scattered = {along_curve(make_points("uniform", 800, 4)), {}};
  const auto by_x = std::minmax_element(scattered.points.begin(), scattered.points.end());
  scattered.constraints = {
      {std::uint32_t(by_x.second - scattered.points.begin()), std::uint32_t(by_x.first - scattered.points.begin())}};
  problems.push_back(scattered);
  check_enforced(problems);
}

TEST_CASE("of one constraint alone, the faces that it crosses and the edges that are there already are counted") {
  std::vector<Problem> all = {strip(2, 20), strip(50, 20), strip(400, 8)};
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    all.push_back({along_curve(make_points(seed % 2 ? "grid" : "uniform", 60, seed)), {}});
    Random random{seed};
    all.back().constraints = random_constraints(all.back().points, 1, random);
  }
  std::uint64_t crossed = 0;
  for (const Problem& problem : all) {
    const Enforced made({problem});
    const Problem& ranked = made.problems[0];
    const std::set<Constraint> pieces = expected_pieces(ranked.points, ranked.constraints);
    std::set<Constraint> edges;
    for (std::uint32_t e = 0; e < made.before[0].edges; ++e) edges.insert(ends_of_edge(made.before[0], e));
    std::uint64_t existing = 0;
    for (const Constraint& piece : pieces) existing += edges.count(piece);
    CHECK(made.result.crossed_pairs == met_by(made.before[0], pieces).pairs);
    CHECK(made.result.existing_edges == existing);
    crossed += made.result.crossed_pairs;
  }
  CHECK(crossed > 400);
}

TEST_CASE("many constraints share a vertex with more faces than are looked through at first") {
  std::vector<Problem> problems = {fan(3), fan(16), fan(63), fan(64), fan(65), fan(200)};
  // Between two such vertices, across what lies between, and from one to a vertex of few faces, both ways.
  Problem two = fan(150), other = fan(150);
  const auto shift = std::uint32_t(two.points.size());
  for (Point& p : other.points) two.points.push_back({p[0] + 9000, p[1] + 10});
  for (const Constraint& c : other.constraints) two.constraints.push_back({c[0] + shift, c[1] + shift});
  two.points.push_back({104500, 100700});
  two.points.push_back({104600, 99200});
  problems.push_back(two);
  for (const std::uint32_t last : {2 * shift, 2 * shift + 1})
    for (const bool back : {false, true}) {
      // The fans' own constraints would be in the way.
      Problem across = two;
      across.constraints.clear();
      across.constraints.push_back(back ? Constraint{last, 0} : Constraint{0, last});
      across.constraints.push_back(back ? Constraint{shift, last} : Constraint{last, shift});
      across.constraints.push_back(back ? Constraint{shift, 0} : Constraint{0, shift});
      problems.push_back(across);
    }
  // One that comes to the centre from a vertex before it, and goes on to one behind.
  for (const bool back : {false, true}) {
    Problem through = fan(150);
    const auto more = std::uint32_t(through.points.size());
    for (const std::int64_t x : {90000, 95000, 105000, 110000}) through.points.push_back({x, 100000});
    through.constraints.push_back(back ? Constraint{more + 3, more} : Constraint{more, more + 3});
    problems.push_back(through);
  }
  check_enforced(problems);
}

TEST_CASE("edges of the hull, vertices on constraints, overlaps, repeats, and constraints of no length") {
  Problem square;
  for (std::int64_t x = 0; x < 7; ++x)
    for (std::int64_t y = 0; y < 7; ++y) square.points.push_back({x, y});
  const auto at = [](std::uint32_t x, std::uint32_t y) { return 7 * x + y; };
  Problem hull = square, overlapping = square, knights = square;
  hull.constraints = {{at(0, 0), at(6, 0)}, {at(6, 6), at(6, 0)}, {at(6, 6), at(0, 6)}, {at(0, 0), at(0, 6)}};
  overlapping.constraints = {{at(0, 0), at(4, 4)}, {at(6, 6), at(2, 2)}, {at(3, 3), at(3, 3)}, {at(5, 5), at(1, 1)},
                             {at(4, 4), at(0, 0)}, {at(1, 1), at(2, 2)}, {at(0, 0), at(0, 0)}, {at(3, 3), at(3, 6)}};
  for (std::uint32_t x = 0; x + 2 < 7; x += 2)
    for (std::uint32_t y = 0; y + 1 < 7; ++y) knights.constraints.push_back({at(x, y), at(x + 2, y + 1)});
  Problem bare;
  bare.points = {{0, 0}, {6, 0}, {6, 6}, {0, 6}, {3, 1}, {3, 5}};
  bare.constraints = {{0, 1}, {2, 1}, {2, 3}, {0, 3}, {4, 5}};
  check_enforced({hull, overlapping, {square.points, {}}, knights, bare, {{{4, 4}}, {{0, 0}}}, {}});
}

TEST_CASE("what crosses an earlier constraint is left out as if it were not there, or with all that follows") {
  std::uint64_t left_out = 0, several = 0, fine = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    CAPTURE(seed);
    Random random{seed};
    std::vector<Problem> problems;
    for (int p = 0; p < 3; ++p) {
      Problem problem = {along_curve(make_points(seed % 2 ? "tiny" : "uniform", 12, 3 * seed + p)), {}};
      const std::uint64_t n = problem.points.size();
      for (int c = 0; c < (seed % 4 == 0 ? 12 : 1 + int(seed % 3)); ++c)
        problem.constraints.push_back({std::uint32_t(random.below(n)), std::uint32_t(random.below(n))});
      problems.push_back(problem);
    }
    const Enforced past(problems, true), up_to(problems, false);
    check_all(past);
    check_all(up_to);
    const auto count = std::count(past.crosses.begin(), past.crosses.end(), 1u);
    left_out += count > 0;
    several += count > 3;
    fine += count == 0;
  }
  CHECK(left_out > 20);
  CHECK(several > 20);
  CHECK(fine > 20);
}

TEST_CASE("of a constraint that crosses another one nothing is enforced, however many of its vertices come before") {
  Problem row;  // vertices on a line, and an edge across it near each end
  for (const std::int64_t x : {0, 11, 19, 32, 41, 50, 63, 71, 83}) row.points.push_back({x, 0});
  row.points.insert(row.points.end(), {{6, 31}, {5, -29}, {78, 33}, {76, -37}, {37, 2}, {35, -3}, {45, 3}, {46, -4}});
  const std::vector<Constraint> across = {{9, 10}, {11, 12}, {13, 14}, {15, 16}};
  std::vector<Problem> problems;
  for (const Constraint& gate : across)
    for (const Constraint& along : {Constraint{0, 8}, Constraint{8, 0}, Constraint{1, 7}, Constraint{2, 3}}) {
      problems.push_back(row);
      problems.back().constraints = {gate, along, {3, 3}, {0, 1}, {along[1], along[0]}};
    }
  for (const bool past : {false, true}) {
    const Enforced made(problems, past);
    REQUIRE(std::count(made.crosses.begin(), made.crosses.end(), 1u) >= 10);
    check_all(made);
  }
}

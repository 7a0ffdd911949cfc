// SPDX-License-Identifier: Apache-2.0
// Postconditions of cleaning and of the constrain phase.
#include "phases/constrain.hpp"
#include "mesh_fixture.hpp"
#include "phases/clean.hpp"
#include "phases/flip.hpp"

using namespace fixture;

namespace {

// Exact: do the interiors of segments pq and rs meet, other than at a vertex of both?
std::int64_t turn(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
int sign(std::int64_t v) { return (v > 0) - (v < 0); }
bool cross(const Point& p, const Point& q, const Point& r, const Point& s) {
  return sign(turn(p, q, r)) * sign(turn(p, q, s)) < 0 && sign(turn(r, s, p)) * sign(turn(r, s, q)) < 0;
}

// Random constraints that cross no other one, kept greedily; overlaps and vertices on them are welcome.
std::vector<Constraint> random_constraints(const std::vector<Point>& points, std::size_t wanted, Random& random) {
  std::vector<Constraint> kept;
  for (std::size_t tries = 0; tries < 8 * wanted && kept.size() < wanted; ++tries) {
    const Constraint c = {std::uint32_t(random.below(points.size())), std::uint32_t(random.below(points.size()))};
    bool free = true;
    for (const Constraint& k : kept) free &= !cross(points[c[0]], points[c[1]], points[k[0]], points[k[1]]);
    if (free) kept.push_back(c);
  }
  return kept;
}

struct Totals {
  std::uint64_t hits = 0, existing = 0, walked = 0, chains = 0, holes = 0, symbolic = 0;
  std::array<std::uint64_t, 4> pairs = {};
};

// The edges of the mesh that are marked, as pairs of vertices.
std::set<Constraint> marked_edges(const HostMesh& m) {
  std::set<Constraint> all;
  for (std::uint32_t e = 0; e < m.edges; ++e)
    if (m.marks[e] & GCDT_MARK_CONSTRAINED) {
      const cl_uint r = m.edge_faces[2 * e];
      const cl_uint* c = m.corners[r >> 2].s;
      const std::uint32_t u = c[((r & 3) + 1) % 3], v = c[((r & 3) + 2) % 3];
      all.insert({std::min(u, v), std::max(u, v)});
    }
  return all;
}

// What a constrain phase meets with in a mesh whose border is the convex hull, so that no piece leaves the finite
// faces.
struct Met {
  std::uint64_t pairs = 0;                   // of faces and pieces that cross them
  std::array<std::uint64_t, 4> of_two = {};  // the cases of figure 6, in the order of kernels/constrain/constrain.cl
};

// By brute force: all pieces that cross an edge, in the order in which they are met along it.
Met met_by(const HostMesh& m, const std::set<Constraint>& pieces) {
  Met met;
  const auto crossing = [&](std::uint32_t u, std::uint32_t v) {
    std::vector<Constraint> found;
    if (u >= m.n || v >= m.n) return found;
    for (const Constraint& c : pieces)
      if (cross(m.points[c[0]], m.points[c[1]], m.points[u], m.points[v])) found.push_back(c);
    // The distance from u is |turn(c, u)| of |turn(c, u)| + |turn(c, v)|.
    const auto at = [&](const Constraint& c, std::uint32_t end) {
      return static_cast<__int128>(std::abs(turn(m.points[c[0]], m.points[c[1]], m.points[end])));
    };
    std::sort(found.begin(), found.end(),
              [&](const Constraint& c, const Constraint& d) { return at(c, u) * at(d, v) < at(d, u) * at(c, v); });
    return found;
  };
  std::map<Constraint, std::uint64_t> sides_crossed;
  for (const cl_uint4& f : m.corners)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t w = f.s[k], u = f.s[(k + 1) % 3], v = f.s[(k + 2) % 3];
      const std::vector<Constraint> found = crossing(u, v);
      for (const Constraint& c : found) ++sides_crossed[c];
      if (found.size() < 2) continue;
      const auto comes_from_w = [&](const Constraint& c) { return c[0] == w || c[1] == w; };
      const auto cuts_off_u = [&](const Constraint& c) {
        return cross(m.points[c[0]], m.points[c[1]], m.points[u], m.points[w]);
      };
      const Constraint &first = found.front(), &last = found.back();
      const int from = comes_from_w(first) + comes_from_w(last);
      ++met.of_two[from == 2 ? 1 : from == 1 ? 3 : cuts_off_u(first) == cuts_off_u(last) ? 0 : 2];
    }
  for (const auto& [piece, sides] : sides_crossed) met.pairs += sides / 2 + 1;  // an edge has two sides
  return met;
}

// What docs/contract.md, 3, makes of the constraints, by brute force.
std::set<Constraint> expected_pieces(const std::vector<Point>& points, const std::vector<Constraint>& constraints) {
  std::set<Constraint> all;
  for (const Constraint& c : constraints) {
    const Point &p = points[c[0]], &q = points[c[1]];
    if (c[0] == c[1]) continue;
    std::vector<std::pair<std::int64_t, std::uint32_t>> on;
    for (std::uint32_t v = 0; v < points.size(); ++v) {
      const std::int64_t t = (q[0] - p[0]) * (points[v][0] - p[0]) + (q[1] - p[1]) * (points[v][1] - p[1]);
      const std::int64_t whole = (q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]);
      if (turn(p, q, points[v]) == 0 && t >= 0 && t <= whole) on.push_back({t, v});
    }
    std::sort(on.begin(), on.end());
    for (std::size_t i = 0; i + 1 < on.size(); ++i)
      all.insert({std::min(on[i].second, on[i + 1].second), std::max(on[i].second, on[i + 1].second)});
  }
  return all;
}

// As after so many rounds that no claim is left: all words are cleared before any is given out.
void use_up_claims(runtime::Runtime& runtime, Mesh& mesh) {
  std::vector<cl_uint4> records(2 * std::size_t{mesh.faces()});
  runtime.read(mesh.face_data, records.data(), records.size());
  for (std::uint32_t face = 0; face < mesh.faces(); ++face) records[GCDT_CORNERS(face)].s[3] = 0xFFFFFFF0u;
  runtime.write(mesh.face_data, records.data(), records.size());
  mesh.claims_below = 0xFFFFFFF1u;
}

void run_case(runtime::Runtime& runtime, std::vector<Point> points, std::size_t constraint_count, std::uint64_t seed,
              std::uint32_t coarsest, bool flipped_before, Totals& totals) {
  Vertices vertices = upload(runtime, points, coarsest);
  const std::uint32_t n = vertices.n();
  Random random{seed};
  const std::vector<Constraint> constraints = random_constraints(points, constraint_count, random);
  std::vector<cl_uint> identity(n);
  for (std::uint32_t v = 0; v < n; ++v) identity[v] = v;
  vertices.input_vertex = runtime.allocate<cl_uint>("map", n);
  runtime.write(vertices.input_vertex, identity.data(), n);

  const Plan plan = make_plan(runtime, vertices);
  Mesh mesh = make_mesh(runtime, n);
  const WorkLists lists = make_work_lists(runtime, n);
  History history = make_history(runtime, vertices.levels);
  PhaseCounters counters(runtime);
  Ticker ticker;
  Primitives primitives(runtime);
  insert_root(runtime, vertices, mesh);
  for (unsigned level = 0; level < vertices.levels.count; ++level) {
    insert_level(runtime, plan, vertices, mesh, history, lists, counters, level, ticker);
    if (level + 1 < vertices.levels.count || flipped_before)
      flip(runtime, plan, vertices, mesh, lists, counters, vertices.levels.begin[level + 1], ticker);
  }
  if (flipped_before) history = freeze_all(runtime, vertices, mesh);
  const WalkedMesh walked{plan, vertices, mesh, history};
  counters.zero();
  const runtime::Buffer<cl_uint2> staged = stage(runtime, constraints);
  Cleaner cleaner(runtime, primitives, vertices, staged, n);
  const CleanResult clean = cleaner.clean(walked, {}, counters);
  const std::set<Constraint> expected = expected_pieces(points, constraints);
  std::vector<cl_uint2> ends(clean.pieces.count);
  runtime.read(clean.pieces.ends, ends.data(), ends.size());
  std::set<Constraint> pieces;
  for (const cl_uint2& e : ends) pieces.insert({std::min(e.s[0], e.s[1]), std::max(e.s[0], e.s[1])});
  CHECK(pieces == expected);

  const Met met = met_by(download(runtime, mesh, points, n), expected);
  if (seed % 3 == 0) use_up_claims(runtime, mesh);
  const ConstrainResult result = constrain(runtime, primitives, plan, vertices, mesh, history, clean.pieces, counters);
  REQUIRE(result.failed == 0);
  if (flipped_before) {
    CHECK(result.crossed_pairs == met.pairs);
    for (std::size_t i = 0; i < met.of_two.size(); ++i) CHECK(result.pairs_of_two[i] == met.of_two[i]);
  }
  const HostMesh after = download(runtime, mesh, points, n);
  CHECK(invalid_reason(after, n) == "");
  CHECK(marked_edges(after) == expected);
  flip(runtime, plan, vertices, mesh, lists, counters, n, ticker);
  const HostMesh flipped = download(runtime, mesh, points, n);
  CHECK(invalid_reason(flipped, n) == "");
  CHECK(illegal_edges(flipped) == 0);
  CHECK(marked_edges(flipped) == expected);
  totals.hits += clean.hits;
  totals.existing += result.existing_edges;
  totals.walked += result.walked;
  totals.chains += result.chain_vertices;
  totals.holes += result.holes;
  totals.symbolic += result.symbolic_chain_vertices;
  for (std::size_t i = 0; i < totals.pairs.size(); ++i) totals.pairs[i] += result.pairs_of_two[i];
}

}  // namespace

TEST_CASE("constraints become edges, the mesh stays valid, and every case of the algorithm occurs") {
  for (const cl::Device& device : devices_under_test()) {
    runtime::Runtime runtime(device);
    CAPTURE(runtime.info().name);
    Totals totals;
    for (const char* kind : {"tiny", "grid", "uniform", "clusters", "corners", "collinear", "parabola"})
      for (std::uint32_t n : {2u, 3u, 5u, 12u, 40u, 150u})
        for (std::uint64_t seed = 0; seed < 6; ++seed)
          for (std::uint32_t coarsest : {4u, 1000u}) {
            CAPTURE(kind);
            CAPTURE(n);
            CAPTURE(seed);
            CAPTURE(coarsest);
            run_case(runtime, make_points(kind, n, seed), 2 * n, seed + 100, coarsest, seed % 2 == 1, totals);
          }
    CHECK(totals.hits > 0);
    CHECK(totals.existing > 0);
    CHECK(totals.walked > 0);
    CHECK(totals.chains > 0);
    CHECK(totals.holes > 0);
    CHECK(totals.symbolic > 0);
    for (const std::uint64_t pairs : totals.pairs) CHECK(pairs > 0);
    MESSAGE("hits " << totals.hits << " existing " << totals.existing << " walked " << totals.walked << " chains "
                    << totals.chains << " holes " << totals.holes << " symbolic " << totals.symbolic);
  }
}

// SPDX-License-Identifier: Apache-2.0
// Postconditions of cleaning and of the constrain phase.
#include "phases/constrain.hpp"
#include "constraint_oracle.hpp"
#include "phases/clean.hpp"

using namespace fixture;

namespace {

struct Totals {
  std::uint64_t hits = 0, existing = 0, walked = 0, chains = 0, holes = 0, symbolic = 0, left_out = 0;
  std::array<std::uint64_t, 4> pairs = {};
};

// As after so many rounds that no claim is left: all words are cleared before any is given out.
void use_up_claims(runtime::Runtime& runtime, Mesh& mesh) {
  std::vector<cl_uint4> records(2 * std::size_t{mesh.faces()});
  runtime.read(mesh.face_data, records.data(), records.size());
  for (std::uint32_t face = 0; face < mesh.faces(); ++face) records[GCDT_CORNERS(face)].s[3] = 0xFFFFFFF0u;
  runtime.write(mesh.face_data, records.data(), records.size());
  mesh.claims_below = 0xFFFFFFF1u;
}

void add(Totals& totals, const CleanResult& clean, const ConstrainResult& result) {
  totals.hits += clean.hits;
  totals.existing += result.existing_edges;
  totals.walked += result.walked;
  totals.chains += result.chain_vertices;
  totals.holes += result.holes;
  totals.symbolic += result.symbolic_chain_vertices;
  for (std::size_t i = 0; i < totals.pairs.size(); ++i) totals.pairs[i] += result.pairs_of_two[i];
}

void run_case(runtime::Runtime& runtime, std::vector<Point> points, std::size_t constraint_count, std::uint64_t seed,
              std::uint32_t coarsest, bool flipped_before, Totals& totals) {
  MeshOnDevice made(runtime, std::move(points), coarsest);
  const std::uint32_t n = made.n();
  Random random{seed};
  const std::vector<Constraint> constraints = random_constraints(made.points, constraint_count, random);
  Primitives primitives(runtime);
  made.insert_all(flipped_before);
  if (flipped_before) made.history = freeze_all(runtime, made.vertices, made.mesh, made.counters);
  made.counters.zero();
  made.plan.crossings_gated = seed % 3 == 1 ? UINT32_MAX : 0;
  const runtime::Buffer<cl_uint2> staged = stage(runtime, constraints);
  Cleaner cleaner(runtime, primitives, made.vertices, staged, n);
  CleanResult clean = cleaner.clean(made.walked(), cleaner.keep(made.plan, {}), made.counters);
  const std::set<Constraint> expected = expected_pieces(made.points, constraints);
  CHECK(read_pieces(runtime, clean.pieces) == expected);

  const Met met = met_by(made.now(), expected);
  const std::uint64_t already = static_cast<std::uint64_t>(
      std::count_if(expected.begin(), expected.end(),
                    [edges = edges_of(made.now())](const Constraint& piece) { return edges.count(piece) == 1; }));
  made.plan.least_existing = seed / 2 % 2 == 0 ? 0 : UINT32_MAX;  // and then none is left out
  made.plan.least_grouped = seed % 5 < 3 ? 0 : UINT32_MAX, made.plan.grouped_crossings = UINT32_MAX;
  if (seed % 3 == 0) use_up_claims(runtime, made.mesh);
  const ConstrainResult result =
      constrain(runtime, primitives, made.plan, made.vertices, made.mesh, made.history, clean.pieces, made.counters);
  REQUIRE(result.failed == 0);
  CHECK(result.existing_edges == already);
  CHECK(result.existing_edges + result.walked == expected.size());
  CHECK(result.left_out <= (made.plan.least_existing == 0 ? already : 0));
  totals.left_out += result.left_out;
  if (flipped_before) {
    CHECK(result.crossed_pairs == met.pairs);
    for (std::size_t i = 0; i < met.of_two.size(); ++i) CHECK(result.pairs_of_two[i] == met.of_two[i]);
  }
  const HostMesh after = made.now();
  CHECK(invalid_reason(after, n) == "");
  CHECK(marked_edges(after) == expected);
  made.flip();
  const HostMesh flipped = made.now();
  CHECK(invalid_reason(flipped, n) == "");
  CHECK(illegal_edges(flipped) == 0);
  CHECK(marked_edges(flipped) == expected);
  add(totals, clean, result);
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
    CHECK(totals.left_out > 0);
    for (const std::uint64_t pairs : totals.pairs) CHECK(pairs > 0);
    MESSAGE("hits " << totals.hits << " existing " << totals.existing << " walked " << totals.walked << " chains "
                    << totals.chains << " holes " << totals.holes << " symbolic " << totals.symbolic);
  }
}

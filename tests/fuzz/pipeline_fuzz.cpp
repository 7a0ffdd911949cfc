// SPDX-License-Identifier: Apache-2.0
// Graphs from bytes through everything that makes meshes of them: a solver, refinement, a pool's batch, tiles. What
// comes out is proved on the host, and batches and tiles have the bytes of the solver. The only errors are crossings
// that are to be rejected, and vertices that rounding makes one and that are to be distinct.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <gcdt/gcdt_pool.hpp>
#include <gcdt/verify.hpp>

#include "shapes.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

using namespace gcdt;
using fuzz::Graph;

[[noreturn]] void finding(const std::string& what) {
  std::fprintf(stderr, "pipeline_fuzz: %s\n", what.c_str());
  std::abort();
}

void require(bool holds, const char* what) {
  if (!holds) finding(what);
}

struct Problem {
  std::vector<std::array<double, 2>> vertices;
  std::vector<Constraint> constraints;
};

/// What is done, and how often it was; printed at the end.
struct Counts {
  unsigned long long problems = 0, proofs = 0, refined = 0, in_batches = 0, in_tiles = 0;
  ~Counts() {
    std::fprintf(stderr,
                 "pipeline_fuzz: %llu problems solved, %llu proofs, %llu refined, %llu in batches, %llu tiled\n",
                 problems, proofs, refined, in_batches, in_tiles);
  }
} counts;

Solver& solver() {
  static Solver one("Portable Computing Language");
  return one;
}
Pool& pool() {
  static Pool one("Portable Computing Language");
  return one;
}

/// Places of the bytes, so that every kind of grid comes up.
std::array<double, 2> place(const std::array<std::uint8_t, 2>& at, unsigned scale) {
  const double x = at[0], y = at[1];
  switch (scale) {
    case 1: return {x * 4194304, y * 4194304};
    case 2: return {x * 0.1, y * 0.01};
    case 3: return {x / 3, y / 7};
    case 4: return {x * 1e6 + y, y * 1e6 - x};
    case 5: return {x * 5e-324, y * 5e-324};
    case 6: return {x * 1e305, y * 1e305 - 1e307};
    default: return {x, y};
  }
}

Problem problem_of(const Graph& graph, std::size_t vertices) {
  Problem problem;
  for (std::size_t v = 0; v < vertices; ++v)
    problem.vertices.push_back(place(graph.vertices[v], graph.choices.scale % 10));
  for (const auto& [a, b] : graph.constraints)
    if (a < vertices && b < vertices) problem.constraints.push_back({a, b});
  return problem;
}

Options options_of(const Graph& graph) {
  const fuzz::Choices& c = graph.choices;
  Options options;
  options.crossing = static_cast<Crossing>(c.crossing % 3);
  options.domain = static_cast<Domain>(c.domain % 6);
  options.regions = (c.domain & 64) != 0;
  options.distinct = (c.domain & 128) != 0;
  if (c.scale % 10 == 8) options.grid = FixedGrid{-1, -2, "3"};
  if (c.scale % 10 == 9) options.grid = FixedGrid{-0.5, -0.25, "0.5"};
  return options;
}

/// Seeds at vertices and beside them.
void add_seeds(const Graph& graph, const Problem& problem, Options& options) {
  for (std::size_t i = 0; i < (graph.choices.seeds & 7u) && i < problem.vertices.size(); ++i) {
    const auto& at = problem.vertices[problem.vertices.size() - 1 - i];
    auto& seeds = i % 2 == 0 ? options.hole_seeds : options.region_seeds;
    seeds.push_back((graph.choices.seeds & 8) != 0 ? at : std::array<double, 2>{at[0] + 0.5, at[1] + 0.25});
  }
}

MeshView view_of(const Triangulation& mesh) {
  MeshView view;
  view.triangles = mesh.triangles;
  view.neighbours = mesh.neighbours.data();
  view.constrained = mesh.constrained.data();
  view.added = mesh.added_on_grid;
  view.added_origin = mesh.added_origin;
  return view;
}

void prove(const Problem& problem, const Triangulation& mesh, const Options& options) {
  ++counts.proofs;
  const bool regions = options.regions || options.domain != Domain::hull;
  const RegionView said =
      regions ? RegionView{mesh.region.data(), mesh.depth.data(), mesh.winding.data()} : RegionView{};
  const Verification found =
      verify_domain(problem.vertices, problem.constraints, view_of(mesh), said, mesh.statistics.grid, options);
  if (!found.valid) finding("the proof failed: " + found.reason);
}

/// The mesh, or the error that the call may end with.
struct Outcome {
  std::optional<Triangulation> mesh;
  std::optional<Status> error;
};

bool explained(const Error& error, const Options& options) {
  return (error.status() == Status::constraints_cross && options.crossing == Crossing::reject) ||
         (error.status() == Status::vertices_coincide && options.distinct);
}

Outcome solved(const Problem& problem, const Options& options) {
  ++counts.problems;
  Outcome outcome;
  try {
    outcome.mesh = solver().triangulate(problem.vertices, problem.constraints, options);
  } catch (const Error& error) {
    if (!explained(error, options)) finding(std::string("an error that nothing explains: ") + error.what());
    outcome.error = error.status();
  }
  return outcome;
}

/// Where constraints cross by one policy they do by the others.
void compare_policies(const Problem& problem, Options options, const Outcome& rejected) {
  if (options.crossing != Crossing::reject || rejected.error == Status::vertices_coincide) return;
  options.crossing = Crossing::drop;
  const Outcome dropped = solved(problem, options);
  require(dropped.mesh.has_value(), "dropping ended with an error");
  require((dropped.mesh->statistics.constraints_dropped > 0) == rejected.error.has_value(),
          "what is rejected is not what is dropped");
  prove(problem, *dropped.mesh, options);
}

bool same(const Triangulation& a, const Triangulation& b) {
  bool all = true;
  const auto equal = [](const auto& p, const auto& q) {
    return p.size() == q.size() && (p.size() == 0 || std::memcmp(p.data(), q.data(), p.size() * sizeof(p[0])) == 0);
  };
#define GCDT_ARRAY(number, name, ...) all = all && equal(a.name, b.name);
#include <gcdt/arrays.def>
  return all;
}

/// Every problem of a batch is proved; of `compared` of them the solver makes the same bytes.
void run_pool(const std::vector<Problem>& problems, const Options& options, std::size_t compared) {
  Batch batch;
  for (const Problem& problem : problems) batch.add(problem.vertices, problem.constraints);
  const BatchResult result = pool().triangulate(batch, options);
  Options alone = options;
  alone.tiles = 0;
  for (std::size_t p = 0; p < problems.size(); ++p) {
    const std::optional<Error> error = result.error(p);
    if (error && !explained(*error, options)) finding(std::string("an error that nothing explains: ") + error->what());
    const Triangulation mesh = gcdt::detail::triangulation(result, p);
    if (!error) prove(problems[p], mesh, alone);
    if (p >= compared) continue;
    const Outcome one = solved(problems[p], alone);
    require(error.has_value() == one.error.has_value(), "a problem fails in a batch, or alone, and not both");
    if (error) require(error->status() == *one.error, "a problem fails in another way in a batch");
    if (one.mesh) require(same(mesh, *one.mesh), "a batch has other bytes");
  }
}

/// The graph, nothing, and what else can be made of the graph.
void run_batch(const Graph& graph, const Options& options) {
  std::vector<Problem> problems = {problem_of(graph, graph.vertices.size()), {}};
  Graph other = graph;
  for (unsigned i = 0; i < graph.choices.seeds % 64u; ++i) {
    if (i % 8 == 0) other = graph;
    fuzz::Shapes(other, i + 64u * graph.choices.refinement).mutate();
    other.choices = graph.choices;
    problems.push_back(problem_of(other, other.vertices.size()));
  }
  counts.problems += problems.size(), counts.in_batches += problems.size();
  run_pool(problems, options, 2);
}

void run_tiles(const Graph& graph, Options options) {
  options.tiles = 2 + graph.choices.seeds % 15;
  const Problem problem = problem_of(graph, graph.vertices.size());
  add_seeds(graph, problem, options);
  ++counts.problems, ++counts.in_tiles;
  run_pool({problem}, options, 1);
}

Refinement refinement_of(const fuzz::Choices& c, const Problem& problem, const Options& options,
                         std::vector<double>& sizes) {
  Refinement refine;
  static constexpr double angles[] = {0, 1, 20, 26, 33, 34};
  refine.least_angle = angles[c.refinement % 6];
  refine.splits = static_cast<Splits>(c.refinement / 6 % 3);
  refine.conforming = c.refinement / 18 % 2 == 1;
  refine.most_added = 20 + 5u * c.seeds;
  const double extent = problem.vertices.empty() ? 1 : std::abs(problem.vertices[0][0]) + 1e-300;
  if (c.refinement / 36 % 3 == 1) refine.most_area = std::max(extent * extent / 50, 1e-300);
  if (c.refinement / 36 % 3 == 2 && options.crossing != Crossing::split) {
    for (std::size_t v = 0; v < problem.vertices.size(); ++v)
      sizes.push_back(extent / (2 + static_cast<double>(v % 9)) + 5e-324);
    refine.sizes = sizes;
  }
  return refine;
}

void run_refined(const Graph& graph, Options options) {
  const Problem problem = problem_of(graph, graph.vertices.size());
  add_seeds(graph, problem, options);
  std::vector<double> sizes;
  options.refine = refinement_of(graph.choices, problem, options, sizes);
  const Outcome outcome = solved(problem, options);
  if (!outcome.mesh) return;
  ++counts.refined;
  require(outcome.mesh->statistics.refine.added <= options.refine->most_added, "more vertices than the limit");
  if (options.crossing == Crossing::split) return;  // there is no proof of both
  ++counts.proofs;
  const RefinedVerification found = verify_refined(problem.vertices, problem.constraints, view_of(*outcome.mesh),
                                                   outcome.mesh->statistics.grid, options);
  if (!found.valid) finding("the proof of a refined mesh failed: " + found.reason);
}

/// Every vertex is a corner of the triangle where it is found, if the whole hull is there.
void run_queries(const Graph& graph, Options options) {
  options.domain = Domain::hull;
  const Problem problem = problem_of(graph, graph.vertices.size());
  ++counts.problems;
  std::optional<Result> result;
  try {
    result.emplace(solver().solve(problem.vertices, problem.constraints, options));
  } catch (const Error&) {
    return;  // run_single() says whether it may
  }
  const auto found = result->locate(problem.vertices);
  const auto representatives = result->representative();
  const auto triangles = result->triangles();
  for (std::size_t v = 0; v < problem.vertices.size() && !triangles.empty(); ++v) {
    require(found[v] >= 0, "a vertex is outside of the mesh");
    const auto& corners = triangles[static_cast<std::size_t>(found[v])];
    require(std::count(corners.begin(), corners.end(), representatives[v]) == 1, "a vertex is found elsewhere");
  }
  require(result->quality().triangles == triangles.size(), "quality of other triangles");
  require(result->hull().size() >= 3 || triangles.empty(), "a hull of less than three");
  result->edge_pieces();
  const Triangulation mesh = result->download();
  if (mesh.added_on_grid.size() > 0 || triangles.empty()) return;
  Options as_it_is;
  as_it_is.grid = options.grid;
  const Triangulation adopted = solver().adopt(problem.vertices, mesh.triangles, mesh.pieces, as_it_is).download();
  require(adopted.triangles == mesh.triangles && adopted.neighbours == mesh.neighbours,
          "an adopted mesh has other triangles");
}

void run_single(const Graph& graph, Options options) {
  const Problem problem = problem_of(graph, graph.vertices.size());
  add_seeds(graph, problem, options);
  const Outcome outcome = solved(problem, options);
  if (outcome.mesh) prove(problem, *outcome.mesh, options);
  if ((graph.choices.way & 64) != 0) compare_policies(problem, options, outcome);
}

void run(const Graph& graph) {
  const Options options = options_of(graph);
  switch (graph.choices.way % 8) {
    case 0:
    case 1: return run_single(graph, options);
    case 2: return run_tiles(graph, options);
    case 3: return run_refined(graph, options);
    case 4: return run_queries(graph, options);
    default: return run_batch(graph, options);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    run(fuzz::decode(data, size));
  } catch (const Error& error) {
    finding(std::string("an error that is not expected: ") + error.what());
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  if (seed % 4 == 0) return LLVMFuzzerMutate(data, size, most);
  Graph graph = fuzz::decode(data, size);
  fuzz::Shapes(graph, seed / 4).mutate();
  return fuzz::encode(graph, data, most);
}

/// Both graphs in one.
extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* data1, std::size_t size1,
                                                 const std::uint8_t* data2, std::size_t size2, std::uint8_t* out,
                                                 std::size_t most, unsigned) {
  Graph graph = fuzz::decode(data1, size1);
  const Graph other = fuzz::decode(data2, size2);
  const std::size_t before = graph.vertices.size();
  for (const auto& at : other.vertices)
    if (graph.vertices.size() < fuzz::most_vertices) graph.vertices.push_back(at);
  for (const auto& [a, b] : other.constraints)
    if (a + before < graph.vertices.size() && b + before < graph.vertices.size() &&
        graph.constraints.size() < fuzz::most_constraints)
      graph.constraints.push_back({static_cast<std::uint8_t>(a + before), static_cast<std::uint8_t>(b + before)});
  return fuzz::encode(graph, out, most);
}

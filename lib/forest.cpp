// SPDX-License-Identifier: Apache-2.0
#include "forest.hpp"

#include <algorithm>
#include <cstring>

#include "arrange.hpp"
#include "crossings.hpp"
#include "enforce.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;

namespace {

/// The problems of a run one after the other, in host memory.
struct Gathered {
  HostArray vertices, constraint_array;
  Span<Constraint> constraints;  ///< ends count through the run
  ProblemRanges ranges;

  Gathered(const BatchInput& batch, const std::vector<std::uint32_t>& numbers) {
    const std::size_t vertex_bytes = 8 * words_per_vertex(batch.type);
    std::uint64_t n = 0, m = 0;
    for (const std::uint32_t p : numbers) n += batch.n(p), m += batch.m(p);
    vertices.make<unsigned char>(n * vertex_bytes);
    constraints.data = written_ = constraint_array.make<Constraint>(m);
    InvalidProblems invalid;
    for (std::uint32_t i = 0; i < numbers.size(); ++i) add(batch, numbers[i], i, vertex_bytes, invalid);
    if (!invalid.errors.empty()) throw invalid;
    end();
  }

 private:
  void end() {
    ranges.first_input.push_back(static_cast<cl_uint>(inputs_));
    ranges.first_constraint.push_back(static_cast<cl_uint>(constraints.size));
  }

  void add(const BatchInput& batch, std::uint32_t p, std::uint32_t place, std::size_t vertex_bytes,
           InvalidProblems& invalid) {
    end();
    const std::uint64_t n = batch.n(p), m = batch.m(p);
    const Constraint* given = batch.constraints + batch.constraint_offsets[p];
    for (std::uint64_t c = 0; c < m; ++c) {
      if (given[c][0] >= n || given[c][1] >= n) {
        invalid.errors.emplace_back(place, index_error(c, given[c][0] >= n ? 0 : 1, n));
        break;
      }
      *written_++ = {static_cast<std::uint32_t>(given[c][0] + inputs_),
                     static_cast<std::uint32_t>(given[c][1] + inputs_)};
      ++constraints.size;
    }
    if (n > 0)
      std::memcpy(vertices.bytes.get() + inputs_ * vertex_bytes,
                  static_cast<const unsigned char*>(batch.vertices) + batch.vertex_offsets[p] * vertex_bytes,
                  n * vertex_bytes);
    inputs_ += n;
  }

  std::uint64_t inputs_ = 0;
  Constraint* written_ = nullptr;
};

class ForestPipeline final : public Pipeline {
 public:
  ForestPipeline(runtime::Runtime& runtime, Primitives& primitives, InputSource source, const Options& options,
                 ProblemRanges& ranges, Span<Constraint> constraints)
      : Pipeline(runtime, primitives, std::move(source), options), ranges_(ranges), constraints_given_(constraints) {}

  std::vector<Grid> grids;
  Buffer<cl_uint> first_triangle, first_piece;

 private:
  OrderResult order_points(InputPoints points) override {
    ranges_.first_input_buffer = upload("first inputs", ranges_.first_input);
    ranges_.first_constraint_buffer = upload("first constraints", ranges_.first_constraint);
    ForestOrder made = order_forest(runtime_, primitives_, std::move(points), ranges_, options_.grid,
                                    runtime_.tuning().coarsest_level);
    grids = std::move(made.grids);
    return std::move(made.ordered);
  }

  // Crossing constraints are each problem's own error. Pairs are sorted, so by problem.
  [[noreturn]] void reject(const std::vector<Constraint>& crossings) override {
    InvalidProblems invalid;
    for (std::size_t begin = 0, end = 0; begin < crossings.size(); begin = end) {
      const auto& first = ranges_.first_constraint;
      const std::uint32_t p = problem_of_constraint(crossings[begin][0]);
      std::vector<Constraint> own;
      for (; end < crossings.size() && crossings[end][0] < first[p + 1]; ++end)
        own.push_back({crossings[end][0] - first[p], crossings[end][1] - first[p]});
      const std::uint32_t shift = ranges_.first_input[p];
      invalid.errors.emplace_back(p, crossings_error(
                                         own,
                                         [&](std::uint32_t c) {
                                           const Constraint& given = constraints_given_[first[p] + c];
                                           return Constraint{given[0] - shift, given[1] - shift};
                                         },
                                         grids[p].kind == Grid::Kind::rounded));
    }
    throw invalid;
  }

  bool enforce_by_problem() override {
    EnforceResult r = enforce_problems(runtime_, primitives_, vertices_, mesh_, ranges_, constraints_, counters_);
    if (r.crossing) return false;
    statistics_.constraints_zero = r.zero_length;
    auto& cases = statistics_.cases;
    cases.constraint_hits = r.hits;
    cases.existing_edges = r.existing_edges;
    cases.pieces_walked = r.pieces.count - r.existing_edges;
    cases.chain_vertices = r.chain_vertices;
    statistics_.crossed_pairs = r.crossed_pairs;
    statistics_.flips += r.flips;
    pieces_ = std::move(r.pieces);
    return true;
  }

  // Added vertices would be numbered through all problems, and are ordered by their place on one grid: what crosses is
  // to be run alone.
  [[noreturn]] void split_crossings() override {
    Splitter splitter(runtime_, primitives_, constraints_, static_cast<std::uint32_t>(source_.n));
    const auto& marked = splitter.mark_crossing(WalkedMesh{vertices_, mesh_, history_}, pieces_, counters_);
    if (splitter.marked() == 0) fail_without_crossings({});
    std::vector<cl_uint> crosses(ranges_.first_constraint.back());
    runtime_.read(marked, crosses.data(), crosses.size());
    InvalidProblems invalid;
    for (std::uint32_t p = 0; p < ranges_.count(); ++p) {
      const auto first = crosses.begin() + ranges_.first_constraint[p];
      const auto end = crosses.begin() + ranges_.first_constraint[p + 1];
      if (std::find(first, end, 1u) != end) invalid.crossing.push_back(p);
    }
    throw invalid;
  }

  void output() override {
    auto& ms = statistics_.ms;
    OrderedMesh ordered;
    timed("output", ms.output, [&] {
      ticker_.tick("output", 0);
      history_ = {};
      lists_ = {};
      if (by_problem_) {
        ArrangedForest arranged = arrange_problems(runtime_, primitives_, mesh_, vertices_);
        ordered = std::move(arranged.mesh);
        first_triangle = std::move(arranged.first_triangle);
      } else {
        ordered = order_triangles(runtime_, primitives_, mesh_, vertices_, true);
        first_triangle = begins("first triangles", ordered.triangles, 3, ordered.corners);
      }
      mesh_ = {};
      first_piece = begins("first pieces", pieces_.count, 2, pieces_.ends);
    });
    if (options_.check)
      timed("check", ms.check,
            [&] { check_forest(runtime_, ordered, vertices_, pieces_, first_triangle, first_piece); });
    const bool wants_regions = options_.regions || options_.domain != Domain::hull;
    if (wants_regions && ordered.triangles > 0) timed("domain", ms.domain, [&] { select_by_problem(ordered); });
    timed("output", ms.output, [&] { number_by_problem(ordered); });
    result_.mesh = std::move(ordered);
    if (!result_.dropped.allocated()) result_.dropped = runtime_.allocate<cl_uint>("dropped constraints", 0);
  }

  // Regions do not lead from one problem to another, and outside is the same for all; so a search through the forest
  // is one through each problem, and the order of triangles and half edges within each is what it would be alone.
  void select_by_problem(OrderedMesh& ordered) {
    SelectedDomain selected = select_domain(runtime_, primitives_, ordered, vertices_, pieces_, turns_, options_);
    turns_ = {};
    result_.regions = std::move(selected.regions);
    const Buffer<cl_uint> first_of_hull = std::move(first_triangle);
    if (options_.domain != Domain::hull) ordered = std::move(selected.mesh);
    first_triangle = begins("first triangles", ordered.triangles, 3, ordered.corners);
    runtime_.launch("forest", "forest_local_regions", over(ordered.triangles), cl_uint{ordered.triangles},
                    vertices_.n(), vertices_.points, ordered.corners, first_of_hull, selected.region_of_hull,
                    result_.regions.region);
  }

  void number_by_problem(const OrderedMesh& ordered) {
    const cl_uint n = vertices_.n(), inputs = static_cast<cl_uint>(source_.n);
    runtime_.launch("forest", "forest_local_triangles", over(ordered.triangles), cl_uint{ordered.triangles}, n,
                    vertices_.points, vertices_.vertex_input, ranges_.first_input_buffer, first_triangle,
                    ordered.corners, ordered.neighbours);
    result_.representatives = runtime_.allocate<cl_uint>("output representatives", inputs);
    runtime_.launch("forest", "forest_representatives", over(inputs), inputs, n, vertices_.points,
                    vertices_.vertex_input, vertices_.input_vertex, ranges_.first_input_buffer,
                    result_.representatives);
    runtime_.launch("forest", "forest_local_sources", over(pieces_.source_count), cl_uint{pieces_.source_count},
                    ranges_.count(), ranges_.first_constraint_buffer, pieces_.sources);
    runtime_.launch("forest", "forest_local_pieces", over(pieces_.count), cl_uint{pieces_.count}, n, vertices_.points,
                    vertices_.vertex_input, ranges_.first_input_buffer, pieces_.ends);
    if (pieces_.count == 0) runtime_.fill<cl_uint>(pieces_.source_offsets, 0, 1);
  }

  template <class T>
  Buffer<cl_uint> begins(const char* name, cl_uint count, cl_uint stride, const Buffer<T>& things) {
    const cl_uint problems = ranges_.count();
    auto found = runtime_.allocate<cl_uint>(name, std::size_t{problems} + 1);
    runtime_.launch("forest", "forest_begins", over(std::size_t{problems} + 1), problems, count, stride, vertices_.n(),
                    vertices_.points, things, found);
    return found;
  }

  std::uint32_t problem_of_constraint(std::uint32_t c) const {
    const auto& first = ranges_.first_constraint;
    return static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), c) - first.begin() - 1);
  }

  Buffer<cl_uint> upload(const char* name, const std::vector<cl_uint>& values) {
    auto buffer = runtime_.allocate<cl_uint>(name, values.size());
    runtime_.write(buffer, values.data(), values.size());
    return buffer;
  }

  ProblemRanges& ranges_;
  Span<Constraint> constraints_given_;
};

/// Copies what a run has left on the device.
class Download {
 public:
  Download(runtime::Runtime& runtime, const ProblemRanges& ranges, ForestResult& result)
      : runtime_(runtime), ranges_(ranges), problems_(ranges.count()), result_(result) {}

  void run(const DeviceTriangulation& made, const Buffer<cl_uint>& first_triangle, const Buffer<cl_uint>& first_piece) {
    const OrderedMesh& mesh = made.mesh;
    const std::size_t triangles = mesh.triangles;
    read(mesh.corners, array(GCDT_TRIANGLES).make<cl_uint>(3 * triangles), 3 * triangles);
    read(mesh.neighbours, array(GCDT_NEIGHBOURS).make<cl_int>(3 * triangles), 3 * triangles);
    read(mesh.constrained, array(GCDT_CONSTRAINED).make<cl_uchar>(triangles), triangles);
    for (const int kind : {GCDT_TRIANGLES, GCDT_NEIGHBOURS, GCDT_CONSTRAINED}) begins(kind) = wide_of(first_triangle);
    const std::size_t inputs = ranges_.first_input.back();
    read(made.representatives, array(GCDT_REPRESENTATIVES).make<cl_uint>(inputs), inputs);
    begins(GCDT_REPRESENTATIVES).assign(ranges_.first_input.begin(), ranges_.first_input.end());
    pieces(made.pieces, wide_of(first_piece));
    dropped(made.dropped);
    if (made.regions.region.allocated()) regions(made.regions, triangles);
  }

 private:
  HostArray& array(int kind) { return result_.arrays[static_cast<std::size_t>(kind)]; }
  std::vector<std::uint64_t>& begins(int kind) { return result_.begins[static_cast<std::size_t>(kind)]; }

  template <class T>
  void read(const Buffer<T>& from, T* to, std::size_t count) {
    runtime_.read(from, to, count);
  }

  std::vector<std::uint64_t> wide_of(const Buffer<cl_uint>& buffer) {
    std::vector<cl_uint> words(std::size_t{problems_} + 1);
    read(buffer, words.data(), words.size());
    return {words.begin(), words.end()};
  }

  // The source offsets of a problem start at 0 and end with one more than it has pieces.
  void pieces(const Pieces& made, std::vector<std::uint64_t> first) {
    const std::size_t count = made.count;
    runtime_.read_bytes(made.ends.handle(), 0, array(GCDT_PIECES).make<cl_uint2>(count), count * sizeof(cl_uint2));
    read(made.sources, array(GCDT_SOURCES).make<cl_uint>(made.source_count), made.source_count);
    std::vector<cl_uint> offsets(count + 1);
    read(made.source_offsets, offsets.data(), offsets.size());
    auto* local = array(GCDT_SOURCE_OFFSETS).make<cl_uint>(count + problems_);
    auto &offset_begins = begins(GCDT_SOURCE_OFFSETS), &source_begins = begins(GCDT_SOURCES);
    for (std::size_t p = 0; p < problems_; ++p) {
      offset_begins.push_back(first[p] + p);
      source_begins.push_back(offsets[first[p]]);
      for (std::size_t i = first[p]; i <= first[p + 1]; ++i) *local++ = offsets[i] - offsets[first[p]];
    }
    offset_begins.push_back(count + problems_);
    source_begins.push_back(made.source_count);
    begins(GCDT_PIECES) = std::move(first);
  }

  void regions(const Regions& made, std::size_t triangles) {
    read(made.region, array(GCDT_REGIONS).make<cl_uint>(triangles), triangles);
    read(made.depth, array(GCDT_DEPTHS).make<cl_uint>(triangles), triangles);
    read(made.winding, array(GCDT_WINDINGS).make<cl_int>(triangles), triangles);
    read(made.seed, array(GCDT_REGION_SEEDS).make<cl_int>(triangles), triangles);
    for (const int kind : {GCDT_REGIONS, GCDT_DEPTHS, GCDT_WINDINGS, GCDT_REGION_SEEDS})
      begins(kind) = begins(GCDT_TRIANGLES);
  }

  void dropped(const Buffer<cl_uint>& made) {
    auto* local = array(GCDT_DROPPED).make<cl_uint>(made.size());
    read(made, local, made.size());
    std::size_t i = 0;
    for (std::size_t p = 0; p < problems_; ++p) {
      begins(GCDT_DROPPED).push_back(i);
      for (; i < made.size() && local[i] < ranges_.first_constraint[p + 1]; ++i)
        local[i] -= ranges_.first_constraint[p];
    }
    begins(GCDT_DROPPED).push_back(i);
  }

  runtime::Runtime& runtime_;
  const ProblemRanges& ranges_;
  std::uint32_t problems_;
  ForestResult& result_;
};

}  // namespace

ForestResult triangulate_forest(runtime::Runtime& runtime, Primitives& primitives, const BatchInput& batch,
                                std::vector<std::uint32_t> numbers, const Options& options) {
  ForestResult result;
  Gathered gathered(batch, numbers);
  ProblemRanges& ranges = gathered.ranges;
  const std::uint64_t n = ranges.first_input.back(), m = gathered.constraints.size;
  const InputSource source = {n, m, [&] {
                                DeviceInput loaded;
                                loaded.points.n = static_cast<cl_uint>(n);
                                loaded.points.type = coordinates_type(batch.type);
                                const std::size_t words = n * words_per_vertex(batch.type);
                                loaded.points.coordinates = runtime.allocate<cl_ulong>("coordinates", words);
                                runtime.write(loaded.points.coordinates,
                                              reinterpret_cast<const cl_ulong*>(gathered.vertices.bytes.get()), words);
                                loaded.constraints = stage(runtime, gathered.constraints);
                                return loaded;
                              }};
  runtime.memory().begin_call();
  ForestPipeline pipeline(runtime, primitives, source, options, ranges, gathered.constraints);
  const DeviceTriangulation made = pipeline.run();
  Download(runtime, ranges, result).run(made, pipeline.first_triangle, pipeline.first_piece);
  result.problems = std::move(numbers);
  result.grids = std::move(pipeline.grids);
  result.statistics = made.statistics;
  return result;
}

// Beside what one problem of that size needs: the second sort, the problems of vertices, tables of problems.
std::uint64_t forest_bytes(std::uint64_t problems, std::uint64_t n, std::uint64_t m) {
  return device_bytes_needed(n + problems, m, 2 * n + problems) + 24 * n + 256 * problems;
}

}  // namespace gcdt

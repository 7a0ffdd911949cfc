// SPDX-License-Identifier: Apache-2.0
#include "pipeline.hpp"

#include <chrono>

#include "check.hpp"
#include "crossings.hpp"
#include "output.hpp"

namespace gcdt {

namespace {

// The coarsest level goes into the symbolic triangle at once. Small enough for one work-group, large
// enough that the levels below it would cost more launches than they save flips.
constexpr std::uint32_t coarsest_level = 256;

constexpr std::size_t pairs_in_message = 10;

// What the steps take of a call with as many constraints as vertices, roughly, added up: only progress
// is told by it.
constexpr double order_share = 0.1, insert_share = 0.5, constrain_share = 0.75, flip_share = 0.9;

}  // namespace

Pipeline::Pipeline(runtime::Runtime& runtime, Primitives& primitives, Points points, Constraints constraints,
                   const Options& options)
    : runtime_(runtime),
      primitives_(primitives),
      points_(points),
      constraints_(constraints),
      options_(options),
      ticker_(options.progress),
      counters_(runtime) {}

template <class Step>
void Pipeline::timed(double& ms, Step&& step) {
  const double built = runtime_.build_ms();
  const auto start = std::chrono::steady_clock::now();
  step();
  runtime_.finish();
  ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count() -
        (runtime_.build_ms() - built);
}

Triangulation Pipeline::run() {
  if (constraints_.size >= (1ull << 31))
    throw Error(Status::invalid_argument, "more than 2^31 - 1 constraints: " + std::to_string(constraints_.size));
  runtime_.meter().peak = runtime_.meter().now;
  const std::uint64_t launches = runtime_.launches(), reads = runtime_.read_backs();
  const double built = runtime_.build_ms();
  auto& ms = statistics_.ms;
  timed(ms.order, [&] {
    ticker_.enter(0, order_share);
    ticker_.tick("order", 0);
    OrderResult ordered = order(runtime_, primitives_, points_, options_.grid, coarsest_level);
    vertices_ = std::move(ordered.vertices);
    statistics_.vertices_merged = ordered.merged;
    sort_ms_ = ordered.sort_ms;
    primitives_.release();
  });
  ticker_.enter(order_share, insert_share);
  timed(ms.insert, [&] { insert(); });
  ticker_.enter(insert_share, constrain_share);
  timed(ms.constrain, [&] { constrain_all(); });
  ticker_.enter(constrain_share, flip_share);
  timed(ms.flip, [&] { flip_all(); });
  ticker_.enter(flip_share, 1);
  output();
  ms.core = sort_ms_ + ms.insert + ms.constrain - clean_ms_ + ms.flip;
  ms.full = ms.order + ms.insert + ms.constrain + ms.flip + ms.check + ms.output;
  ms.build = runtime_.build_ms() - built;
  statistics_.launches = runtime_.launches() - launches;
  statistics_.read_backs = runtime_.read_backs() - reads;
  finish_statistics();
  return std::move(result_);
}

// Level by level: insert, then flip, so that each level goes into a Delaunay mesh (paper, section 8). The
// last level is left unflipped: constraints are enforced first, and located by its history tree.
void Pipeline::insert() {
  if (!mesh_.corners.allocated()) {
    mesh_ = make_mesh(runtime_, vertices_.n());
    lists_ = make_work_lists(runtime_, vertices_.n());
  }
  if (!history_.nodes.allocated()) history_ = make_history(runtime_, vertices_.levels);
  runtime_.fill<cl_uint>(mesh_.edge_marks, 0, mesh_.edges());
  insert_root(runtime_, vertices_, mesh_);
  for (unsigned level = 0; level < vertices_.levels.count; ++level) {
    statistics_.rounds.insert += insert_level(runtime_, vertices_, mesh_, history_, lists_, counters_, level, ticker_);
    const device::Counters& c = counters_.last();
    statistics_.cases.edge_splits += c.edge_splits;
    statistics_.history_depth = c.history_depth;
    statistics_.location_steps += wide(c.steps_low, c.steps_high);
    if (level + 1 < vertices_.levels.count)
      count_flips(flip(runtime_, vertices_, mesh_, lists_, counters_, vertices_.levels.begin[level + 1], ticker_));
  }
}

void Pipeline::count_flips(const FlipResult& flipped) {
  statistics_.rounds.flip += flipped.rounds;
  statistics_.flips += flipped.flips;
}

void Pipeline::constrain_all() {
  pieces_ = {};
  if (constraints_.size == 0) {
    pieces_.ends = runtime_.allocate<cl_uint2>("pieces", 0);
    return;
  }
  ticker_.tick("constrain", 0);
  cleaner_ = std::make_unique<Cleaner>(runtime_, primitives_, vertices_, constraints_, std::uint32_t(points_.size()));
  timed(clean_ms_, [&] { clean({}); });
  ticker_.tick("constrain", 0.3);
  const ConstrainResult first = enforce();
  if (first.failed) resolve_crossings(first);
  cleaner_.reset();
}

void Pipeline::clean(const std::vector<cl_uint>& wanted) {
  pieces_ = {};
  counters_.zero();
  CleanResult cleaned = cleaner_->clean(WalkedMesh{vertices_, mesh_, history_}, wanted, counters_);
  pieces_ = std::move(cleaned.pieces);
  const device::Counters& c = counters_.last();
  statistics_.location_steps += wide(c.steps_low, c.steps_high);
  if (wanted.empty()) {
    statistics_.constraints_zero = cleaned.zero_length;
    statistics_.cases.constraint_hits = cleaned.hits;
  }
}

ConstrainResult Pipeline::enforce() {
  const ConstrainResult r =
      constrain(runtime_, primitives_, WalkedMesh{vertices_, mesh_, history_}, pieces_, lists_, counters_);
  auto& cases = statistics_.cases;
  cases.existing_edges = r.existing_edges;
  cases.pieces_walked = r.walked;
  cases.chain_vertices = r.chain_vertices;
  cases.holes = r.holes;
  cases.symbolic_chain_vertices = r.symbolic_chain_vertices;
  statistics_.crossed_pairs = r.crossed_pairs;
  statistics_.location_steps += r.steps;
  return r;
}

// Enforcement failed: either constraints cross, and their pairs are named, or something is wrong.
void Pipeline::resolve_crossings(const ConstrainResult& first) {
  if (first.mesh_changed) insert();
  const std::vector<Constraint> crossings =
      find_crossings(runtime_, primitives_, WalkedMesh{vertices_, mesh_, history_}, pieces_, counters_);
  if (crossings.empty())
    throw Error(Status::check_failed,
                "constrain: the mesh would be invalid though no constraints cross (failure bits " +
                    std::to_string(first.failed) + ")");
  statistics_.crossings = crossings.size();
  if (options_.crossing == Crossing::reject) reject(crossings);
  result_.dropped = drop_crossing(crossings);
  statistics_.constraints_dropped = result_.dropped.size();
  std::vector<cl_uint> wanted(constraints_.size, 1);
  for (const std::uint32_t d : result_.dropped) wanted[d] = 0;
  timed(clean_ms_, [&] { clean(wanted); });
  runtime_.fill<cl_uint>(mesh_.edge_marks, 0, mesh_.edges());
  const ConstrainResult second = enforce();
  if (second.failed)
    throw Error(Status::check_failed, "constrain: constraints still cross after dropping (failure bits " +
                                          std::to_string(second.failed) + ")");
}

void Pipeline::reject(const std::vector<Constraint>& crossings) const {
  std::vector<std::uint64_t> indices;
  std::string list;
  auto ends = [&](std::uint32_t c) {
    return std::to_string(c) + " (" + std::to_string(constraints_[c][0]) + "-" + std::to_string(constraints_[c][1]) +
           ")";
  };
  for (std::size_t i = 0; i < std::min(crossings.size(), pairs_in_message); ++i) {
    indices.insert(indices.end(), {crossings[i][0], crossings[i][1]});
    list += (i ? ", " : "") + ends(crossings[i][0]) + " and " + ends(crossings[i][1]);
  }
  std::string message = std::to_string(crossings.size()) + (crossings.size() == 1 ? " pair" : " pairs") +
                        " of constraints cross: " + list;
  if (crossings.size() > pairs_in_message) message += ", ...";
  if (vertices_.grid.kind == Grid::Kind::rounded)
    message +=
        "; the coordinates were rounded to a grid, which can make constraints cross: choose another grid or drop "
        "crossing constraints";
  throw Error(Status::constraints_cross, message, indices, crossings.size());
}

void Pipeline::flip_all() { count_flips(flip(runtime_, vertices_, mesh_, lists_, counters_, vertices_.n(), ticker_)); }

void Pipeline::output() {
  auto& ms = statistics_.ms;
  OrderedMesh ordered;
  timed(ms.output, [&] {
    ticker_.tick("output", 0);
    history_ = {};
    lists_ = {};
    ordered = order_triangles(runtime_, primitives_, mesh_, vertices_);
    mesh_ = {};
  });
  if (options_.check) timed(ms.check, [&] { check(runtime_, primitives_, ordered, vertices_, pieces_); });
  timed(ms.output, [&] {
    std::vector<cl_uint2> ends(pieces_.count);
    runtime_.read(pieces_.ends, ends.data(), ends.size());
    result_.source_offsets.assign(std::size_t(pieces_.count) + 1, 0);
    if (pieces_.count > 0)
      runtime_.read(pieces_.source_offsets, result_.source_offsets.data(), result_.source_offsets.size());
    result_.sources.resize(pieces_.source_count);
    runtime_.read(pieces_.sources, result_.sources.data(), result_.sources.size());
    std::vector<cl_uint> inputs(vertices_.n());
    if (!ends.empty()) runtime_.read(vertices_.vertex_input, inputs.data(), inputs.size());
    result_.pieces.reserve(ends.size());
    for (const cl_uint2& e : ends) result_.pieces.push_back({inputs[e.s[0]], inputs[e.s[1]]});
    read_triangulation(runtime_, ordered, vertices_, result_);
  });
}

void Pipeline::finish_statistics() {
  Statistics& s = statistics_;
  s.n = points_.size();
  s.m = constraints_.size;
  s.constraints_pieces = pieces_.count;
  s.constraints_overlapping = pieces_.source_count - pieces_.count;
  s.triangles = result_.triangles.size();
  s.grid = vertices_.grid;
  s.peak_device_bytes = runtime_.meter().peak;
  s.device = runtime_.info().name;
  s.driver = runtime_.info().driver;
  s.platform = runtime_.info().platform;
  s.version = version();
  if (s.triangles == 0)
    s.notes.push_back(vertices_.n() < 3 ? "fewer than three distinct vertices: no triangles"
                                        : "all vertices lie on one line: no triangles");
}

}  // namespace gcdt

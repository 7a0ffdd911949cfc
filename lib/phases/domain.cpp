// SPDX-License-Identifier: Apache-2.0
#include "phases/domain.hpp"

#include "domain/domain.h"
#include "mesh/phase.hpp"
#include "phases/locate.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

namespace {

// Labels double their reach in each round of jumps, and every round of joins ends the ways of at least one
// work-item; more than these is a defect.
constexpr unsigned label_rounds = 4096;

static_assert(static_cast<unsigned>(Domain::outer_holes) == GCDT_KEEP_OUTER_HOLES, "rules are numbered alike");

/// One selection: labels, the graph of the regions, the choice.
struct Selection {
  Runtime& runtime;
  Primitives& primitives;
  const OrderedMesh& mesh;
  const Vertices& vertices;
  const Pieces& pieces;
  const Buffer<cl_int>& turns;
  cl_uint triangles = mesh.triangles, half_edges = 3 * mesh.triangles, regions = 0, arc_count = 0;
  Regions found = {};
  Buffer<device::DomainReport> report_buffer = runtime.allocate<device::DomainReport>("domain report", 1);
  Buffer<cl_uint> region = {}, arc_nodes = {}, arcs = {}, begins = {}, depth = {}, entry = {}, frontiers = {};
  Buffer<cl_uint> starts = {};
  Buffer<cl_int> winding = {};

  void label() {
    region = runtime.allocate<cl_uint>("regions", triangles);
    runtime.launch("regions", "label_start", over(triangles), triangles, region);
    repeat("label_join", [&] {
      runtime.launch("regions", "label_join", over(triangles), triangles, mesh.neighbours, mesh.constrained, region,
                     report_buffer);
    });
    repeat("label_jump",
           [&] { runtime.launch("regions", "label_jump", over(triangles), triangles, region, report_buffer); });
    auto numbers = runtime.allocate<cl_uint>("roots of regions", std::size_t{triangles} + 1);
    runtime.launch("regions", "label_roots", over(triangles), triangles, region, numbers);
    regions = primitives.scan_total(numbers, triangles);
    runtime.launch("regions", "label_number", over(triangles), triangles, numbers, region);
  }

  void list_arcs() {
    auto places = runtime.allocate<cl_uint>("places of arcs", std::size_t{half_edges} + 1);
    runtime.launch("domain", "count_arcs", over(half_edges), half_edges, mesh.neighbours, mesh.constrained, region,
                   places);
    arc_count = primitives.scan_total(places, half_edges);
    arc_nodes = runtime.allocate<cl_uint>("nodes of arcs", arc_count);
    arcs = runtime.allocate<cl_uint>("arcs", arc_count);
    runtime.launch("domain", "list_arcs", over(half_edges), half_edges, mesh.neighbours, mesh.constrained, region,
                   places, arc_nodes, arcs);
    places = {};
    primitives.sort(arc_nodes, arcs, arc_count, std::max(1u, bit_width(regions)));
    primitives.release();
    begins = runtime.allocate<cl_uint>("first arcs", std::size_t{nodes()} + 1);
    runtime.launch("domain", "find_begins", over(std::size_t{nodes()} + 1), nodes(), arc_count, arc_nodes, begins);
  }

  /// Ends: every round with a frontier settles a node, and one without is the last.
  void search() {
    depth = runtime.allocate<cl_uint>("depths", nodes());
    winding = runtime.allocate<cl_int>("windings", nodes());
    entry = runtime.allocate<cl_uint>("entries", nodes());
    frontiers = runtime.allocate<cl_uint>("frontiers", std::size_t{2} * nodes());
    runtime.zero(report_buffer);
    runtime.launch("domain", "depth_start", over(nodes()), nodes(), depth, winding, entry, frontiers, report_buffer);
    runtime.launch("domain", "depth_hull", over(half_edges), half_edges, mesh.neighbours, mesh.constrained, region,
                   depth, frontiers, report_buffer);
    device::DomainReport report = runtime.read_one(report_buffer);
    for (cl_uint d = 0, count = report.frontier[0]; count > 0; count = report.frontier[d % 3]) {
      if (d > nodes()) throw Error(Status::round_limit, "domain: regions are left after the limit of rounds");
      // The first frontier has the most arcs: outside has all of the hull, or its neighbours all coasts.
      const bool alone = d > 0 && count <= GCDT_DEPTH_NODES && report.arcs[d % 3] <= GCDT_DEPTH_ARCS;
      const cl_uint rounds = d > 0 ? Tuning::label_rounds_per_read : 1;
      if (alone) launch_round("depth_rounds", runtime::one_group(), d);
      for (cl_uint round = d; !alone && round < d + rounds; ++round) {
        launch_round("depth_expand", over(arc_count), round);
        launch_round("depth_settle", over(nodes()), round);
      }
      report = runtime.read_one(report_buffer);
      d += alone ? report.rounds : rounds;
    }
    if (report.settled != nodes())
      throw Error(Status::check_failed, "domain: " + std::to_string(nodes() - report.settled) +
                                            " regions cannot be reached from outside: the mesh is not connected");
    found.count = regions;
    found.deepest = report.deepest;
  }

  void count_open() {
    runtime.zero(report_buffer);
    runtime.launch("domain", "count_open", over(arc_count), arc_count, vertices.levels_buffer, mesh.corners,
                   mesh.neighbours, region, cl_uint{pieces.count}, pieces.ends, turns, arc_nodes, arcs, winding,
                   report_buffer);
    runtime.launch("domain", "count_dangling", over(half_edges), half_edges, vertices.levels_buffer, mesh.corners,
                   mesh.neighbours, region, cl_uint{pieces.count}, pieces.ends, turns, mesh.constrained, report_buffer);
    const device::DomainReport report = runtime.read_one(report_buffer);
    found.open_parity = report.open_parity;
    found.open_winding = report.open_winding;
    // All that the choice does not need.
    arc_nodes = {}, arcs = {}, begins = {}, entry = {}, frontiers = {};
  }

  SelectedDomain choose(const Options& options) {
    SelectedDomain selected;
    const Buffer<cl_uint> holes = seeded(options.hole_seeds), seeds = seeded(options.region_seeds);
    auto before = runtime.allocate<cl_uint>("kept before", std::size_t{triangles} + 1);
    runtime.launch("domain", "choose_triangles", over(triangles), triangles, static_cast<cl_uint>(options.domain),
                   region, depth, winding, holes, before);
    const cl_uint count = primitives.scan_total(before, triangles);
    primitives.release();
    selected.kept = runtime.allocate<cl_int>("kept triangles", triangles);
    runtime.launch("domain", "place_kept", over(triangles), triangles, before, selected.kept);
    if (options.domain != Domain::hull) {
      selected.mesh = make_ordered(runtime, count);
      runtime.launch("domain", "gather_kept", over(triangles), triangles, selected.kept, mesh.corners, mesh.neighbours,
                     mesh.constrained, selected.mesh.corners, selected.mesh.neighbours, selected.mesh.constrained);
    }
    Regions& r = found;
    r.region = runtime.allocate<cl_uint>("region of triangles", count);
    r.depth = runtime.allocate<cl_uint>("depth of triangles", count);
    r.winding = runtime.allocate<cl_int>("winding of triangles", count);
    r.seed = runtime.allocate<cl_int>("seed of triangles", count);
    runtime.launch("domain", "gather_regions", over(triangles), triangles, selected.kept, region, depth, winding, seeds,
                   r.region, r.depth, r.winding, r.seed);
    selected.regions = std::move(found);
    selected.region_of_hull = std::move(region);
    return selected;
  }

  cl_uint nodes() const { return regions + 1; }

  /// Launches until nothing is pending.
  template <class Launch>
  void repeat(const char* what, Launch&& launch) {
    for (unsigned round = 0;; ++round) {
      if (round == label_rounds) throw Error(Status::round_limit, std::string(what) + ": labels are not final");
      runtime.zero(report_buffer);
      launch();
      if (runtime.read_one(report_buffer).pending == 0) return;
    }
  }

  /// Launches a kernel of round d of the search.
  void launch_round(const char* kernel, runtime::Range range, cl_uint d) {
    runtime.launch("domain", kernel, range, d, vertices.levels_buffer, mesh.corners, mesh.neighbours, region,
                   cl_uint{pieces.count}, pieces.ends, turns, begins, arcs, depth, winding, entry, nodes(), frontiers,
                   report_buffer);
  }

  /// The least seed of each region, GCDT_NONE without one.
  Buffer<cl_uint> seeded(const std::vector<std::array<double, 2>>& points) {
    auto seeds = runtime.filled<cl_uint>("seeds of regions", regions, GCDT_NONE);
    if (points.empty()) return seeds;
    if (!starts.allocated()) starts = least_triangles(runtime, vertices, mesh, false);
    Fans fans;
    const SearchMesh searched = {vertices, mesh, false, nullptr, mesh, starts, starts, fans};
    const Located located = locate(runtime, primitives, searched, stage(runtime, Points(points)));
    runtime.launch("domain", "mark_seeds", over(points.size()), static_cast<cl_uint>(points.size()), located.triangles,
                   region, seeds);
    return seeds;
  }
};

}  // namespace

Buffer<cl_int> count_turns(Runtime& runtime, const Vertices& vertices, const Pieces& pieces,
                           const Buffer<cl_uint2>& constraints) {
  auto turns = runtime.filled<cl_int>("turns of pieces", pieces.count, 0);
  if (pieces.count != 0)
    runtime.launch("domain", "count_turns", over(pieces.source_count), cl_uint{pieces.source_count},
                   cl_uint{pieces.count}, pieces.source_offsets, pieces.sources, pieces.ends, constraints,
                   vertices.input_vertex, vertices.points, turns);
  return turns;
}

SelectedDomain select_domain(Runtime& runtime, Primitives& primitives, const OrderedMesh& ordered,
                             const Vertices& vertices, const Pieces& pieces, const Buffer<cl_int>& turns,
                             const Options& options) {
  Selection selection{runtime, primitives, ordered, vertices, pieces, turns};
  selection.label();
  selection.list_arcs();
  selection.search();
  selection.count_open();
  return selection.choose(options);
}

}  // namespace gcdt

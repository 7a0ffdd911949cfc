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
class Selection {
 public:
  Selection(Runtime& runtime, Primitives& primitives, const OrderedMesh& mesh, const Vertices& vertices,
            const Pieces& pieces, const Buffer<cl_int>& turns)
      : runtime_(runtime),
        primitives_(primitives),
        mesh_(mesh),
        vertices_(vertices),
        pieces_(pieces),
        turns_(turns),
        triangles_(mesh.triangles),
        half_edges_(3 * mesh.triangles),
        report_buffer_(runtime.allocate<device::DomainReport>("domain report", 1)) {}

  void label() {
    region_ = runtime_.allocate<cl_uint>("regions", triangles_);
    runtime_.launch("regions", "label_start", over(triangles_), triangles_, region_);
    repeat("label_join", [&] {
      runtime_.launch("regions", "label_join", over(triangles_), triangles_, mesh_.neighbours, mesh_.constrained,
                      region_, report_buffer_);
    });
    repeat("label_jump",
           [&] { runtime_.launch("regions", "label_jump", over(triangles_), triangles_, region_, report_buffer_); });
    auto numbers = runtime_.allocate<cl_uint>("roots of regions", std::size_t{triangles_} + 1);
    runtime_.launch("regions", "label_roots", over(triangles_), triangles_, region_, numbers);
    regions_ = primitives_.scan_total(numbers, triangles_);
    runtime_.launch("regions", "label_number", over(triangles_), triangles_, numbers, region_);
  }

  void list_arcs() {
    auto places = runtime_.allocate<cl_uint>("places of arcs", std::size_t{half_edges_} + 1);
    runtime_.launch("domain", "count_arcs", over(half_edges_), half_edges_, mesh_.neighbours, mesh_.constrained,
                    region_, places);
    arc_count_ = primitives_.scan_total(places, half_edges_);
    nodes_ = runtime_.allocate<cl_uint>("nodes of arcs", arc_count_);
    arcs_ = runtime_.allocate<cl_uint>("arcs", arc_count_);
    runtime_.launch("domain", "list_arcs", over(half_edges_), half_edges_, mesh_.neighbours, mesh_.constrained, region_,
                    places, nodes_, arcs_);
    places = {};
    primitives_.sort(nodes_, arcs_, arc_count_, std::max(1u, bit_width(regions_)));
    primitives_.release();
    begins_ = runtime_.allocate<cl_uint>("first arcs", std::size_t{nodes()} + 1);
    runtime_.launch("domain", "find_begins", over(std::size_t{nodes()} + 1), nodes(), arc_count_, nodes_, begins_);
  }

  /// Ends: every round with a frontier settles a node, and one without is the last.
  void search() {
    depth_ = runtime_.allocate<cl_uint>("depths", nodes());
    winding_ = runtime_.allocate<cl_int>("windings", nodes());
    entry_ = runtime_.allocate<cl_uint>("entries", nodes());
    frontiers_ = runtime_.allocate<cl_uint>("frontiers", std::size_t{2} * nodes());
    zero_report();
    runtime_.launch("domain", "depth_start", over(nodes()), nodes(), depth_, winding_, entry_, frontiers_,
                    report_buffer_);
    runtime_.launch("domain", "depth_hull", over(half_edges_), half_edges_, mesh_.neighbours, mesh_.constrained,
                    region_, depth_, frontiers_, report_buffer_);
    device::DomainReport report = runtime_.read_one(report_buffer_);
    for (cl_uint d = 0, count = report.frontier[0]; count > 0; count = report.frontier[d % 3]) {
      if (d > nodes()) throw Error(Status::round_limit, "domain: regions are left after the limit of rounds");
      // The first frontier has the most arcs: outside has all of the hull, or its neighbours all coasts.
      const bool alone = d > 0 && count <= GCDT_DEPTH_NODES && report.arcs[d % 3] <= GCDT_DEPTH_ARCS;
      const cl_uint rounds = d > 0 ? Tuning::label_rounds_per_read : 1;
      if (alone)
        rounds_in_one_group(d);
      else
        rounds_wide(d, rounds);
      report = runtime_.read_one(report_buffer_);
      d += alone ? report.rounds : rounds;
    }
    if (report.settled != nodes())
      throw Error(Status::check_failed, "domain: " + std::to_string(nodes() - report.settled) +
                                            " regions cannot be reached from outside: the mesh is not connected");
    found_.count = regions_;
    found_.deepest = report.deepest;
  }

  void count_open() {
    zero_report();
    runtime_.launch("domain", "count_open", over(arc_count_), arc_count_, vertices_.levels_buffer, mesh_.corners,
                    mesh_.neighbours, region_, cl_uint{pieces_.count}, pieces_.ends, turns_, nodes_, arcs_, winding_,
                    report_buffer_);
    runtime_.launch("domain", "count_dangling", over(half_edges_), half_edges_, vertices_.levels_buffer, mesh_.corners,
                    mesh_.neighbours, mesh_.constrained, region_, cl_uint{pieces_.count}, pieces_.ends, turns_,
                    report_buffer_);
    const device::DomainReport report = runtime_.read_one(report_buffer_);
    found_.open_parity = report.open_parity;
    found_.open_winding = report.open_winding;
    // All that the choice does not need.
    nodes_ = {}, arcs_ = {}, begins_ = {}, entry_ = {}, frontiers_ = {};
  }

  SelectedDomain choose(const Options& options) {
    SelectedDomain selected;
    const Buffer<cl_uint> holes = seeded(options.hole_seeds), seeds = seeded(options.region_seeds);
    auto before = runtime_.allocate<cl_uint>("kept before", std::size_t{triangles_} + 1);
    runtime_.launch("domain", "choose_triangles", over(triangles_), triangles_, static_cast<cl_uint>(options.domain),
                    region_, depth_, winding_, holes, before);
    const cl_uint count = primitives_.scan_total(before, triangles_);
    primitives_.release();
    selected.kept = runtime_.allocate<cl_int>("kept triangles", triangles_);
    runtime_.launch("domain", "place_kept", over(triangles_), triangles_, before, selected.kept);
    if (options.domain != Domain::hull) {
      selected.mesh = make_ordered(runtime_, count);
      runtime_.launch("domain", "gather_kept", over(triangles_), triangles_, selected.kept, mesh_.corners,
                      mesh_.neighbours, mesh_.constrained, selected.mesh.corners, selected.mesh.neighbours,
                      selected.mesh.constrained);
    }
    Regions& r = found_;
    r.region = runtime_.allocate<cl_uint>("region of triangles", count);
    r.depth = runtime_.allocate<cl_uint>("depth of triangles", count);
    r.winding = runtime_.allocate<cl_int>("winding of triangles", count);
    r.seed = runtime_.allocate<cl_int>("seed of triangles", count);
    runtime_.launch("domain", "gather_regions", over(triangles_), triangles_, selected.kept, region_, depth_, winding_,
                    seeds, r.region, r.depth, r.winding, r.seed);
    selected.regions = std::move(found_);
    selected.region_of_hull = std::move(region_);
    return selected;
  }

 private:
  cl_uint nodes() const { return regions_ + 1; }

  void zero_report() {
    const device::DomainReport zero = {};
    runtime_.write(report_buffer_, &zero, 1);
  }

  /// Launches until nothing is pending.
  template <class Launch>
  void repeat(const char* what, Launch&& launch) {
    for (unsigned round = 0;; ++round) {
      if (round == label_rounds) throw Error(Status::round_limit, std::string(what) + ": labels are not final");
      zero_report();
      launch();
      if (runtime_.read_one(report_buffer_).pending == 0) return;
    }
  }

  void rounds_wide(cl_uint first, cl_uint rounds) {
    for (cl_uint d = first; d < first + rounds; ++d) {
      runtime_.launch("domain", "depth_expand", over(arc_count_), d, begins_, arcs_, mesh_.neighbours, region_, depth_,
                      entry_, nodes(), frontiers_, report_buffer_);
      runtime_.launch("domain", "depth_settle", over(nodes()), d, vertices_.levels_buffer, mesh_.corners,
                      mesh_.neighbours, region_, cl_uint{pieces_.count}, pieces_.ends, turns_, begins_, depth_,
                      winding_, entry_, nodes(), frontiers_, report_buffer_);
    }
  }

  void rounds_in_one_group(cl_uint d) {
    runtime_.launch("domain", "depth_rounds", runtime::one_group(), d, vertices_.levels_buffer, mesh_.corners,
                    mesh_.neighbours, region_, cl_uint{pieces_.count}, pieces_.ends, turns_, begins_, arcs_, depth_,
                    winding_, entry_, nodes(), frontiers_, report_buffer_);
  }

  /// The least seed of each region, GCDT_NONE without one.
  Buffer<cl_uint> seeded(const std::vector<std::array<double, 2>>& points) {
    auto seeds = runtime_.filled<cl_uint>("seeds of regions", regions_, GCDT_NONE);
    if (points.empty()) return seeds;
    if (!starts_.allocated()) starts_ = least_triangles(runtime_, vertices_, mesh_, false);
    const Terrain terrain = {vertices_, mesh_, false, nullptr, mesh_, starts_, starts_};
    const Located located = locate(runtime_, primitives_, terrain, stage(runtime_, Points(points)));
    runtime_.launch("domain", "mark_seeds", over(points.size()), static_cast<cl_uint>(points.size()), located.triangles,
                    region_, seeds);
    return seeds;
  }

  Runtime& runtime_;
  Primitives& primitives_;
  const OrderedMesh& mesh_;
  const Vertices& vertices_;
  const Pieces& pieces_;
  const Buffer<cl_int>& turns_;
  cl_uint triangles_, half_edges_, regions_ = 0, arc_count_ = 0;
  Regions found_;
  Buffer<device::DomainReport> report_buffer_;
  Buffer<cl_uint> region_, nodes_, arcs_, begins_, depth_, entry_, frontiers_, starts_;
  Buffer<cl_int> winding_;
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
  Selection selection(runtime, primitives, ordered, vertices, pieces, turns);
  selection.label();
  selection.list_arcs();
  selection.search();
  selection.count_open();
  return selection.choose(options);
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "phases/domain_each.hpp"

#include "domain/domain.h"
#include "mesh/phase.hpp"

namespace gcdt {

using runtime::Buffer;
using runtime::over_large;
using runtime::Runtime;

namespace {

Buffer<cl_uint> words(Runtime& runtime, const char* name, std::size_t count) {
  return runtime.allocate<cl_uint>(name, count);
}

/// Takes the count. Throws if a region was not reached.
void take(Regions& regions, const device::DomainReport& report) {
  if (report.pending != 0) throw Error(Status::check_failed, "domain: a triangle has a neighbour in another problem");
  if (report.settled != report.regions)
    throw Error(Status::check_failed, "domain: " + std::to_string(report.regions - report.settled) +
                                          " regions cannot be reached from outside: the mesh is not connected");
  regions.count = report.regions;
}

}  // namespace

SelectedDomains select_domains(Runtime& runtime, Primitives& primitives, const OrderedMesh& ordered,
                               const Vertices& vertices, const Pieces& pieces, const Buffer<cl_int>& turns,
                               const Buffer<cl_uint>& first_triangle, const Buffer<cl_uint>& first_piece,
                               Domain domain) {
  const cl_uint problems = vertices.roots, rule = static_cast<cl_uint>(domain);
  const std::size_t triangles = ordered.triangles, nodes = device::gcdt_first_node(ordered.triangles, problems);
  const auto region = words(runtime, "regions", triangles), depth = words(runtime, "depths", nodes);
  const auto winding = runtime.allocate<cl_int>("windings", nodes), kept = runtime.allocate<cl_int>("kept", triangles);
  SelectedDomains selected;
  selected.first_triangle = words(runtime, "first kept triangles", std::size_t{problems} + 1);
  {
    auto report = runtime.allocate<device::DomainReport>("domain report", 1);
    runtime.zero(report);
    const auto queue = words(runtime, "queues", nodes), all_arcs = words(runtime, "arcs", 3 * triangles),
               arcs = words(runtime, "arcs of nodes", 3 * triangles), begins = words(runtime, "first arcs", nodes),
               entry = words(runtime, "entries", nodes);
    runtime.launch("domain_each", "domain_each", over_large(problems), problems, rule, first_triangle, first_piece,
                   ordered.corners, ordered.neighbours, ordered.constrained, pieces.ends, turns, region, queue,
                   all_arcs, arcs, begins, depth, winding, entry, kept, selected.first_triangle, report);
    take(selected.regions, runtime.read_one(report));
  }
  const cl_uint count = primitives.scan_total(selected.first_triangle, problems);
  primitives.release();
  selected.mesh = make_ordered(runtime, domain == Domain::hull ? 0 : count);
  Regions& r = selected.regions;
  r.region = words(runtime, "region of triangles", count);
  r.depth = words(runtime, "depth of triangles", count);
  r.winding = runtime.allocate<cl_int>("winding of triangles", count);
  r.seed = runtime.filled<cl_int>("seed of triangles", count, -1);
  runtime.launch("domain_each", "domain_each_keep", over_large(problems), problems, rule, first_triangle,
                 selected.first_triangle, kept, ordered.corners, ordered.neighbours, ordered.constrained, region, depth,
                 winding, selected.mesh.corners, selected.mesh.neighbours, selected.mesh.constrained, r.region, r.depth,
                 r.winding);
  return selected;
}

}  // namespace gcdt

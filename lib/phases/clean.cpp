// SPDX-License-Identifier: Apache-2.0
#include "phases/clean.hpp"

#include <array>

#include "constrain/clean.h"
#include "device/step.hpp"

namespace gcdt {

using runtime::over;

runtime::Buffer<cl_uint2> stage(runtime::Runtime& runtime, Constraints constraints) {
  static_assert(sizeof(Constraint) == sizeof(cl_uint2), "a constraint is copied as it is");
  return runtime.upload("constraints", reinterpret_cast<const cl_uint2*>(constraints.data()), constraints.size());
}

Error index_error(std::uint64_t constraint, std::uint64_t end, std::uint64_t vertices) {
  return Error(Status::index_out_of_range,
               "constraint " + std::to_string(constraint) + ": its " + (end == 1 ? "second" : "first") +
                   " end is no vertex; there are " + std::to_string(vertices),
               {constraint, end});
}

Pieces merge_runs(runtime::Runtime& runtime, Primitives& primitives, const runtime::Buffer<cl_uint>& firsts,
                  cl_uint count) {
  Pieces pieces;
  pieces.source_count = count;
  pieces.count = primitives.scan_total(firsts, count);
  pieces.source_offsets = runtime.allocate<cl_uint>("source offsets", std::size_t(pieces.count) + 1);
  primitives.compact_indices(firsts, pieces.source_offsets, count);
  runtime.fill<cl_uint>(pieces.source_offsets, count, 1, pieces.count);
  return pieces;
}

Cleaner::Cleaner(runtime::Runtime& runtime, Primitives& primitives, const Vertices& vertices,
                 const runtime::Buffer<cl_uint2>& constraints, std::uint32_t inputs)
    : runtime_(runtime),
      primitives_(primitives),
      vertices_(vertices),
      inputs_(inputs),
      count_(cl_uint(constraints.size())),
      constraints_(constraints) {}

KeptConstraints Cleaner::keep(const Plan& plan, const std::vector<cl_uint>& wanted, bool sorted) {
  const cl_uint all = wanted.empty();
  auto ends = runtime_.allocate<cl_uint2>("ends of constraints", count_);
  auto lengths = runtime_.allocate<cl_uint>("lengths of constraints", count_);
  // Behind the flags their sum, the complement of the first end that is no input point, and the length of those kept in
  // two words.
  auto kept = runtime_.allocate<cl_uint>("kept constraints", std::size_t(count_) + 4);
  const auto wanted_buffer = runtime_.upload("wanted constraints", wanted);
  runtime_.fill<cl_uint>(kept, 0, 3, std::size_t(count_) + 1);
  runtime_.launch("clean", "clean_map", over(count_), count_, cl_uint(inputs_), constraints_, vertices_.input_vertex,
                  vertices_.points, wanted_buffer, all, ends, lengths, kept);
  primitives_.exclusive_scan(kept, kept, count_);
  std::array<cl_uint, 4> found;
  runtime_.read(kept, found.data(), found.size(), count_);
  if (const cl_uint first = ~found[1]; first != GCDT_NONE) throw index_error(first / 2, first % 2, inputs_);
  KeptConstraints result;
  std::uint64_t selected = count_;
  if (!wanted.empty())
    selected = wanted.size() - static_cast<std::uint64_t>(std::count(wanted.begin(), wanted.end(), cl_uint{0}));
  result.count = found[0];
  result.zero_length = selected - result.count;
  result.length = wide(found[2], found[3]);
  result.crossings = expected_crossings(vertices_, result.length);
  result.list = runtime_.allocate<cl_uint>("list of constraints", result.count);
  result.ends = runtime_.allocate<cl_uint2>("ends of kept constraints", result.count);
  result.lengths = runtime_.allocate<cl_uint>("lengths of kept constraints", result.count);
  primitives_.compact_indices(kept, result.list, count_);
  runtime_.launch("clean", "clean_gather", over(result.count), result.count, result.list, ends, lengths, result.ends,
                  result.lengths);
  sorted = sorted || may_pay_in_turn(plan, sizes_of(vertices_), result.count, result.crossings);
  result.along_curve = sorted || pays_along_curve(plan, result);
  if (result.along_curve) put_along_curve(result, sorted ? 0 : plan.curve_bits);
  return result;
}

// Lengths are of each problem's own grid, so that of several they say nothing about all faces.
bool Cleaner::pays_along_curve(const Plan& plan, const KeptConstraints& kept) const {
  if (plan.curve_crossings == 0) return true;
  return vertices_.roots == 1 && kept.count > 0 && kept.crossings / kept.count >= plan.curve_crossings;
}

// Constraints that lie side by side cross the same faces: a thread that walks them one after the other, and a group
// that walks them at once, has these in its cache. Those of which some are taken ahead are sorted: what is left between
// two of them is narrow then, and which are chosen is the same on all devices.
void Cleaner::put_along_curve(KeptConstraints& kept, unsigned cell_bits) {
  KeptConstraints along;
  along.list = runtime_.allocate<cl_uint>("list of constraints", kept.count);
  along.ends = runtime_.allocate<cl_uint2>("ends of kept constraints", kept.count);
  along.lengths = runtime_.allocate<cl_uint>("lengths of kept constraints", kept.count);
  along.places = runtime_.allocate<cl_uint>("places of constraints", kept.count);
  if (cell_bits > 0)
    put_in_cells(cell_bits, kept, along);
  else
    sort_along_curve(kept, along);
  kept.list = std::move(along.list);
  kept.ends = std::move(along.ends);
  kept.lengths = std::move(along.lengths);
  kept.places = std::move(along.places);
}

void Cleaner::put_in_cells(unsigned most_bits, const KeptConstraints& kept, KeptConstraints& along) {
  const unsigned bits = std::max(1u, bit_width(vertices_.n())), cell_bits = std::min(bits, most_bits);
  const cl_uint low = bits - cell_bits, cells = 1u << cell_bits;
  const auto span = std::max(Tuning::least_curve_span, kept.count / Tuning::most_curve_parts + 1),
             parts = (kept.count - 1) / span + 1;
  auto table = runtime_.allocate<cl_uint>("constraints of cells", std::size_t{cells} * parts + 1);
  const auto range = runtime_.over_groups(parts, runtime::Groups::wide);
  runtime_.launch("clean", "clean_count_cells", range, kept.count, span, parts, cells, low, vertices_.levels_buffer,
                  kept.ends, table);
  primitives_.exclusive_scan(table, table, std::size_t{cells} * parts);
  runtime_.launch("clean", "clean_to_cells", range, kept.count, span, parts, cells, low, vertices_.levels_buffer, table,
                  kept.list, kept.ends, kept.lengths, along.places, along.list, along.ends, along.lengths);
}

void Cleaner::sort_along_curve(const KeptConstraints& kept, KeptConstraints& along) {
  auto keys = runtime_.allocate<cl_ulong>("ranks of constraints", kept.count);
  runtime_.launch("clean", "clean_ranks", over(kept.count), kept.count, vertices_.levels_buffer, kept.ends, keys,
                  along.places);
  primitives_.sort(keys, along.places, kept.count, std::max(1u, bit_width(vertices_.n())));
  runtime_.launch("clean", "clean_gather", over(kept.count), kept.count, along.places, kept.ends, kept.lengths,
                  along.ends, along.lengths);
  runtime_.launch("clean", "clean_gather_list", over(kept.count), kept.count, along.places, kept.list, along.list);
}

// Pieces are written in the order of their sources, in whatever order these were walked: sorting them keeps the sources
// of equal ones ascending.
void Cleaner::place_pieces(const KeptConstraints& kept, const PieceParts& parts,
                           const runtime::Buffer<cl_uint>& offsets, runtime::Buffer<cl_uint>& firsts) {
  firsts = runtime_.allocate<cl_uint>("first pieces of constraints", kept.along_curve ? kept.count + 1u : 0u);
  if (!kept.along_curve) return;
  runtime_.launch("clean", "clean_count", over(kept.count), kept.count, parts.begins, offsets, kept.places, firsts);
  primitives_.exclusive_scan(firsts, firsts, kept.count);
}

void Cleaner::launch_walk(cl_uint task, const WalkedMesh& walked, const KeptConstraints& kept, const PieceParts& parts,
                          const Found& found, const runtime::Buffer<cl_uint>& searched,
                          const runtime::Buffer<cl_uint>& counts, PhaseCounters& counters) {
  const Mesh& mesh = walked.mesh;
  const Fans& fans = walked.history.fans;
  runtime_.launch("clean", "clean_walk", over(parts.capacity), task, kept.count, parts.capacity, mesh.n,
                  vertices_.points, mesh.face_data, mesh.edge_faces, cl_uint{fans.made}, fans.begins, fans.faces,
                  cl_uint{walked.history.gates.made}, walked.history.gates.at, kept.ends, kept.list, parts.begins,
                  found.begins.lines, found.begins.pieces, found.begins.faces, found.passed, searched, found.offsets,
                  counts, found.first_hits, found.hits, found.crossed, counters.buffer());
}

Cleaner::Found Cleaner::walk(const WalkedMesh& walked, const KeptConstraints& kept, const PieceParts& parts,
                             PhaseCounters& counters) {
  Found found;
  found.begins = find_first_faces(runtime_, walked, kept.ends, kept.count, parts, nullptr, true, counters);
  found.crossed = runtime_.filled<cl_uint>("faces crossed by constraints", count_, 0);
  found.offsets = runtime_.allocate<cl_uint>("hits of parts", std::size_t(parts.capacity) + 1);
  found.first_hits = runtime_.allocate<cl_uint>("first vertices on parts", parts.capacity);
  found.hits = runtime_.allocate<cl_uint>("vertices on constraints", 0);
  found.passed = runtime_.allocate<cl_uint>("edges that parts pass", parts.capacity);
  if (!walked.history.fans.made && pays_for_gates(walked.plan, walked.mesh, 4 * kept.crossings))
    make_gates(runtime_, vertices_, walked.mesh, walked.history.gates);
  launch_walk(GCDT_CLEAN_ALL, walked, kept, parts, found, found.begins.faces, found.offsets, counters);
  primitives_.exclusive_scan(found.offsets, found.offsets, parts.capacity);
  if (counters.read().unfinished > 0) walk_rest(walked, kept, parts, found, counters);
  if (counters.last().failed) throw Error(Status::check_failed, "clean: a walk along a constraint left the mesh");
  return found;
}

// Parts give up that take long, since they turn around a vertex. They walk again when there are fans.
void Cleaner::walk_rest(const WalkedMesh& walked, const KeptConstraints& kept, const PieceParts& parts, Found& found,
                        PhaseCounters& counters) {
  Fans& fans = walked.history.fans;
  walked.history.gates = no_gates(runtime_);
  if (!fans.made) fans = make_fans(runtime_, primitives_, vertices_, walked.mesh, counters);
  const auto searched = std::move(found.begins.faces);
  found.begins.faces = runtime_.allocate<cl_uint>("first faces of parts", parts.capacity);
  runtime_.copy(searched, found.begins.faces, parts.capacity);
  find_missing_faces(runtime_, walked, kept.ends, kept.count, parts, found.begins, counters);
  auto counts = runtime_.allocate<cl_uint>("hits of parts", std::size_t(parts.capacity) + 1);
  launch_walk(GCDT_CLEAN_REST, walked, kept, parts, found, searched, counts, counters);
  primitives_.exclusive_scan(counts, counts, parts.capacity);
  found.offsets = std::move(counts);
  counters.read();
}

void Cleaner::write_hits(const WalkedMesh& walked, const KeptConstraints& kept, const PieceParts& parts, Found& found,
                         PhaseCounters& counters) {
  const cl_uint hits = counters.last().hits;
  if (hits == 0) return;
  found.hits = runtime_.allocate<cl_uint>("vertices on constraints", hits);
  launch_walk(GCDT_CLEAN_WRITE, walked, kept, parts, found, found.begins.faces, found.offsets, counters);
}

KeptConstraints Cleaner::every(const KeptConstraints& kept, cl_uint step) {
  KeptConstraints some;
  some.count = (kept.count - 1) / step + 1;
  some.list = runtime_.allocate<cl_uint>("list of constraints", some.count);
  some.ends = runtime_.allocate<cl_uint2>("ends of kept constraints", some.count);
  some.lengths = runtime_.allocate<cl_uint>("lengths of kept constraints", some.count);
  runtime_.launch("clean", "clean_choose", over(some.count), some.count, step, kept.list, kept.ends, kept.lengths,
                  some.list, some.ends, some.lengths);
  some.length = total_weight(runtime_, some.lengths, some.count);
  some.crossings = expected_crossings(vertices_, some.length);
  return some;
}

CleanResult Cleaner::clean(const WalkedMesh& walked, const KeptConstraints& kept, PhaseCounters& counters,
                           std::uint64_t least) {
  counters.zero();
  CleanResult result;
  runtime_.end_step();
  Step walking(runtime_, "walk");
  const PieceParts parts =
      parts_by_length(runtime_, primitives_, walked.plan, kept.lengths, kept.count, kept.length, kept.crossings);
  Found found = walk(walked, kept, parts, counters);
  result.walk_ms = walking.end();
  result.hits = counters.last().hits;
  result.steps = wide(counters.last().steps_low, counters.last().steps_high);
  const std::uint64_t crossed = wide(counters.last().pairs_low, counters.last().pairs_high);
  if (crossed < least) return result;
  write_hits(walked, kept, parts, found, counters);

  const cl_uint count = static_cast<cl_uint>(result.hits) + kept.count;
  const unsigned bits = std::max(1u, bit_width(vertices_.n()));
  auto whole = runtime_.allocate<cl_uint2>("parts of whole constraints", count_);
  auto keys = runtime_.allocate<cl_ulong>("keys of pieces", count);
  auto sources = runtime_.allocate<cl_uint>("sources of pieces", count);
  runtime::Buffer<cl_uint> firsts;
  place_pieces(kept, parts, found.offsets, firsts);
  runtime_.launch("clean", "clean_pieces", over(parts.capacity), kept.count, cl_uint(kept.along_curve), cl_uint(bits),
                  vertices_.levels_buffer, kept.ends, parts.begins, found.begins.pieces, found.offsets, found.hits,
                  kept.list, kept.along_curve ? kept.places : kept.list, firsts, keys, sources, found.crossed, whole);
  result.pieces = merge(vertices_, std::move(keys), std::move(sources), found.crossed, whole, count, bits);
  result.pieces.walked.faces = std::move(found.begins.faces);
  result.pieces.walked.passed = std::move(found.passed);
  result.pieces.walked.crossed = crossed;
  result.pieces.walked.pool = parts.pool;
  result.pieces.walked.existing = counters.last().existing_edges;
  return result;
}

Pieces Cleaner::merge(const Vertices& vertices, runtime::Buffer<cl_ulong> keys, runtime::Buffer<cl_uint> sources,
                      const runtime::Buffer<cl_uint>& crossed, const runtime::Buffer<cl_uint2>& whole, cl_uint count,
                      unsigned bits) {
  primitives_.sort_by_prefix(keys, sources, count, 2 * bits, bits);
  auto firsts = runtime_.allocate<cl_uint>("first pieces", std::size_t(count) + 1);
  runtime_.launch("clean", "mark_first", over(count), count, keys, firsts);
  Pieces pieces = merge_runs(runtime_, primitives_, firsts, count);
  pieces.ends = runtime_.allocate<cl_uint2>("pieces", pieces.count);
  pieces.walked.weights = runtime_.allocate<cl_uint>("weights of pieces", pieces.count);
  pieces.walked.parts = runtime_.allocate<cl_uint2>("parts of whole pieces", pieces.count);
  runtime_.launch("clean", "clean_ends", over(pieces.count), pieces.count, cl_uint(bits), vertices.levels_buffer, keys,
                  pieces.source_offsets, sources, crossed, whole, pieces.ends, pieces.walked.weights,
                  pieces.walked.parts);
  pieces.sources = std::move(sources);
  return pieces;
}

}  // namespace gcdt

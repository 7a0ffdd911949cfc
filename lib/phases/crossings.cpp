// SPDX-License-Identifier: Apache-2.0
#include "phases/crossings.hpp"

#include <algorithm>
#include <set>

namespace gcdt {

using runtime::over;

namespace {

constexpr std::size_t pairs_in_message = 10;

}  // namespace

CrossingPieces::CrossingPieces(runtime::Runtime& runtime, Primitives& primitives, const WalkedMesh& walked,
                               const Pieces& pieces, PhaseCounters& counters)
    : runtime_(runtime), primitives_(primitives), walked_(walked), pieces_(pieces), counters_(counters) {
  counters_.zero();
  find_records();
  counts_ = runtime_.allocate<cl_uint>("pairs of records", std::size_t(rows_) + 1);
  counters_.zero();
  test(0, 0, 0, pieces_.ends);
  const std::uint64_t found = wide(counters_.read().pairs_low, counters_.last().pairs_high);
  if (found >= 0xFFFFFFFFull)
    throw Error(Status::out_of_memory,
                "crossings: " + std::to_string(found) + " pairs of pieces cross, too many to list");
  primitives_.exclusive_scan(counts_, counts_, rows_);
  count_ = cl_uint(found);
}

// Records by face, unless testing all pairs of pieces of each problem takes fewer tests. The mesh may have been made
// again since pieces were cleaned, with other numbers, so where their walks began is not asked.
void CrossingPieces::find_records() {
  const cl_uint faces = walked_.mesh.faces();
  const PieceParts parts = parts_by_crossings(runtime_, primitives_, walked_.plan, pieces_);
  starts_ = runtime_.filled<cl_uint>("record starts", std::size_t(faces) + 1, 0);
  auto filled = runtime_.filled<cl_uint>("records filled", faces, 0);
  const PartBegins begins =
      find_first_faces(runtime_, walked_, pieces_.ends, pieces_.count, parts, nullptr, false, counters_);
  auto collect = [&](cl_uint emit, const runtime::Buffer<cl_uint>& records) {
    const Mesh& mesh = walked_.mesh;
    runtime_.launch("crossings", "crossings_records", over(parts.capacity), emit, pieces_.count, parts.capacity, mesh.n,
                    walked_.vertices.points, mesh.face_data, mesh.edge_faces, pieces_.ends, parts.begins, begins.lines,
                    begins.pieces, begins.faces, starts_, filled, records, counters_.buffer());
  };
  collect(0, filled);
  runtime_.launch("crossings", "crossings_work", over(std::max(faces, pieces_.count)), faces, pieces_.count,
                  walked_.plan.all_pairs, walked_.mesh.n, walked_.vertices.points, pieces_.ends, starts_,
                  counters_.buffer());
  const device::Counters& c = counters_.read();
  if (c.failed) throw Error(Status::check_failed, "crossings: a walk along a constraint left the mesh");
  all_ = c.hits == 0 && wide(c.flips_low, c.flips_high) < wide(c.pairs_low, c.pairs_high);
  rows_ = pieces_.count;
  if (all_) return;
  rows_ = primitives_.scan_total(starts_, faces);
  records_ = runtime_.allocate<cl_uint>("records of faces", rows_);
  collect(1, records_);
}

void CrossingPieces::test(cl_uint emit, cl_uint first, cl_uint last, const runtime::Buffer<cl_uint2>& pairs) {
  const Mesh& mesh = walked_.mesh;
  if (all_)
    runtime_.launch("crossings", "crossings_all", over(rows_), emit, first, last, pieces_.count, mesh.n,
                    walked_.vertices.points, pieces_.ends, counts_, pairs, counters_.buffer());
  else
    runtime_.launch("crossings", "crossings_pairs", over(rows_), emit, first, last, mesh.faces(), mesh.n,
                    walked_.vertices.points, mesh.face_data, mesh.edge_faces, pieces_.ends, starts_, records_, counts_,
                    pairs, counters_.buffer());
}

std::vector<Constraint> find_crossings(runtime::Runtime& runtime, Primitives& primitives, const WalkedMesh& walked,
                                       const Pieces& pieces, PhaseCounters& counters) {
  static_assert(sizeof(Constraint) == sizeof(cl_uint2), "pairs of constraints are copied as they are");
  CrossingPieces found(runtime, primitives, walked, pieces, counters);
  const cl_uint count = found.count();
  if (count == 0) return {};
  auto pairs = runtime.allocate<cl_uint2>("crossing pieces", count);
  found.list(0, count, pairs);
  auto begins = runtime.allocate<cl_uint>("crossing constraints of pieces", std::size_t(count) + 1);
  counters.zero();
  runtime.launch("crossings", "crossings_count_sources", over(count), count, pieces.source_offsets, pairs, begins,
                 counters.buffer());
  const std::uint64_t named = wide(counters.read().pairs_low, counters.last().pairs_high);
  if (named > 0xFFFFFFFFull)
    throw Error(Status::out_of_memory,
                "crossings: " + std::to_string(named) + " pairs of constraints cross, too many to list");
  primitives.exclusive_scan(begins, begins, count);
  auto constraints = runtime.allocate<cl_uint2>("crossing constraints", named);
  runtime.launch("crossings", "crossings_sources", over(count), count, pieces.source_offsets, pieces.sources, pairs,
                 begins, constraints);
  std::vector<Constraint> all(named);
  runtime.read_bytes(constraints.memory(), 0, all.data(), named * sizeof(Constraint));
  // Two straight constraints meet in one point, so each pair occurs once.
  std::sort(all.begin(), all.end());
  return all;
}

Error crossings_error(const std::vector<Constraint>& crossings, const std::function<Constraint(std::uint32_t)>& ends,
                      bool rounded) {
  std::vector<std::uint64_t> indices;
  std::string list;
  const auto named = [&](std::uint32_t c) {
    const Constraint e = ends(c);
    return std::to_string(c) + " (" + std::to_string(e[0]) + "-" + std::to_string(e[1]) + ")";
  };
  for (const Constraint& pair : crossings) indices.insert(indices.end(), pair.begin(), pair.end());
  for (std::size_t i = 0; i < std::min(crossings.size(), pairs_in_message); ++i)
    list += (i ? ", " : "") + named(crossings[i][0]) + " and " + named(crossings[i][1]);
  std::string message = std::to_string(crossings.size()) + (crossings.size() == 1 ? " pair" : " pairs") +
                        " of constraints cross: " + list;
  if (crossings.size() > pairs_in_message) message += ", ...";
  if (rounded)
    message +=
        "; the coordinates were rounded to a grid, which can make constraints cross: choose another grid, or drop or "
        "split crossing constraints";
  return Error(Status::constraints_cross, message, indices, crossings.size());
}

std::vector<std::uint32_t> drop_crossing(const std::vector<Constraint>& crossings) {
  // Pairs by their later constraint, ascending: when d is reached, every earlier one is decided.
  std::vector<Constraint> by_later;
  for (const Constraint& pair : crossings) by_later.push_back({pair[1], pair[0]});
  std::sort(by_later.begin(), by_later.end());
  std::set<std::uint32_t> dropped;
  for (const Constraint& pair : by_later)
    if (!dropped.count(pair[1])) dropped.insert(pair[0]);
  return {dropped.begin(), dropped.end()};
}

}  // namespace gcdt

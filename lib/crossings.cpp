// SPDX-License-Identifier: Apache-2.0
#include "crossings.hpp"

#include <algorithm>
#include <set>

namespace gcdt {

using runtime::over;

namespace {

constexpr std::size_t pairs_in_message = 10;

// Crossing pairs of pieces, by number of the piece.
std::vector<cl_uint2> crossing_pieces(runtime::Runtime& runtime, Primitives& primitives, const WalkedMesh& walked,
                                      const Pieces& pieces, PhaseCounters& counters) {
  const Mesh& mesh = walked.mesh;
  const cl_uint faces = mesh.faces();
  counters.zero();
  const Parts parts = make_parts(runtime, primitives, walked.vertices, pieces.ends, pieces.count);
  auto starts = runtime.allocate<cl_uint>("record starts", std::size_t(faces) + 1);
  auto filled = runtime.allocate<cl_uint>("records filled", faces);
  runtime.fill<cl_uint>(starts, 0, std::size_t(faces) + 1);
  runtime.fill<cl_uint>(filled, 0, faces);
  auto collect = [&](cl_uint emit, const runtime::Buffer<cl_uint>& records) {
    walked.launch(runtime, "crossings", "crossings_records", over(parts.capacity),
                  std::make_tuple(emit, pieces.count, parts.capacity), pieces.ends, parts.begins, starts, filled,
                  records, counters.buffer());
  };
  collect(0, filled);
  primitives.exclusive_scan(starts, starts, faces);
  if (counters.read().failed) throw Error(Status::check_failed, "crossings: a walk along a constraint left the mesh");
  const cl_uint total = runtime.read_one(starts, faces);
  auto records = runtime.allocate<cl_uint>("records of faces", total);
  collect(1, records);

  auto counts = runtime.allocate<cl_uint>("pairs of records", std::size_t(total) + 1);
  auto test = [&](cl_uint emit, const runtime::Buffer<cl_uint2>& pairs) {
    runtime.launch("crossings", "crossings_pairs", over(total), emit, faces, mesh.n, walked.vertices.points,
                   mesh.face_data, mesh.edge_faces, pieces.ends, starts, records, counts, pairs, counters.buffer());
  };
  test(0, pieces.ends);
  const std::uint64_t found = wide(counters.read().pairs_low, counters.last().pairs_high);
  if (found >= 0xFFFFFFFFull)
    throw Error(Status::out_of_memory,
                "crossings: " + std::to_string(found) + " pairs of pieces cross, too many to list");
  primitives.exclusive_scan(counts, counts, total);
  auto pairs = runtime.allocate<cl_uint2>("crossing pieces", found);
  test(1, pairs);
  std::vector<cl_uint2> result(found);
  runtime.read(pairs, result.data(), found);
  return result;
}

}  // namespace

std::vector<Constraint> find_crossings(runtime::Runtime& runtime, Primitives& primitives, const WalkedMesh& walked,
                                       const Pieces& pieces, PhaseCounters& counters) {
  const std::vector<cl_uint2> crossing = crossing_pieces(runtime, primitives, walked, pieces, counters);
  std::vector<cl_uint> offsets(std::size_t(pieces.count) + 1), sources(pieces.source_count);
  runtime.read(pieces.source_offsets, offsets.data(), offsets.size());
  runtime.read(pieces.sources, sources.data(), sources.size());
  std::vector<Constraint> all;
  for (const cl_uint2& pair : crossing)
    for (cl_uint i = offsets[pair.s[0]]; i < offsets[pair.s[0] + 1]; ++i)
      for (cl_uint j = offsets[pair.s[1]]; j < offsets[pair.s[1] + 1]; ++j)
        all.push_back({std::min(sources[i], sources[j]), std::max(sources[i], sources[j])});
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
  for (std::size_t i = 0; i < std::min(crossings.size(), pairs_in_message); ++i) {
    indices.insert(indices.end(), {crossings[i][0], crossings[i][1]});
    list += (i ? ", " : "") + named(crossings[i][0]) + " and " + named(crossings[i][1]);
  }
  std::string message = std::to_string(crossings.size()) + (crossings.size() == 1 ? " pair" : " pairs") +
                        " of constraints cross: " + list;
  if (crossings.size() > pairs_in_message) message += ", ...";
  if (rounded)
    message +=
        "; the coordinates were rounded to a grid, which can make constraints cross: choose another grid or drop "
        "crossing constraints";
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

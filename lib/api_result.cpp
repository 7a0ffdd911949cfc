// SPDX-License-Identifier: Apache-2.0
// The C interface: results.
#include <chrono>
#include <cstddef>
#include <iterator>

#include "api.hpp"

using namespace gcdt;
using namespace gcdt::api;

namespace {

constexpr std::size_t element_bytes[] = {12, 12, 1, 4, 8, 4, 4, 4, 8, 8};  // by GCDT_TRIANGLES ...

}  // namespace

Array gcdt_result::array(std::int32_t number) const {
  const Pieces& pieces = data.pieces;
  const std::size_t bytes = gcdt_element_bytes(number);
  switch (number) {
    case GCDT_TRIANGLES: return {data.mesh.corners.handle(), data.mesh.triangles, bytes};
    case GCDT_NEIGHBOURS: return {data.mesh.neighbours.handle(), data.mesh.triangles, bytes};
    case GCDT_CONSTRAINED: return {data.mesh.constrained.handle(), data.mesh.triangles, bytes};
    case GCDT_REPRESENTATIVES: return {data.representatives.handle(), data.representatives.size(), bytes};
    case GCDT_PIECES: return {pieces.ends.handle(), pieces.count, bytes};
    case GCDT_SOURCE_OFFSETS: return {pieces.source_offsets.handle(), std::uint64_t{pieces.count} + 1, bytes};
    case GCDT_SOURCES: return {pieces.sources.handle(), pieces.source_count, bytes};
    case GCDT_DROPPED: return {data.dropped.handle(), data.dropped.size(), bytes};
    case GCDT_ADDED: return {data.added.points.handle(), data.added.count, bytes};
    case GCDT_ADDED_CROSSINGS: return {data.added.crossing.handle(), data.added.count, bytes};
  }
  throw Error(Status::invalid_argument, "no array of a result has the number " + std::to_string(number));
}

size_t gcdt_element_bytes(int32_t array) {
  return array >= 0 && static_cast<std::size_t>(array) < std::size(element_bytes) ? element_bytes[array] : 0;
}

uint64_t gcdt_result_count(const gcdt_result* result, int32_t array) {
  return result && gcdt_element_bytes(array) != 0 ? result->array(array).count : 0;
}

int32_t gcdt_result_copy(gcdt_result* result, int32_t array, void* destination, uint64_t capacity) {
  return guarded_call(result ? result->state.get() : nullptr, [&] {
    const Array from = result->array(array);
    if (capacity < from.count)
      throw Error(
          Status::buffer_too_small,
          std::to_string(from.count) + " elements do not fit where there is room for " + std::to_string(capacity),
          {from.count, capacity});
    if (from.count == 0) return;
    require(destination, "destination is null");
    const auto start = std::chrono::steady_clock::now();
    result->state->runtime.read_bytes(from.memory, 0, destination, static_cast<std::size_t>(from.bytes()));
    Statistics& s = result->data.statistics;
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    s.ms.output += ms;
    s.ms.full += ms;
    ++s.read_backs;
  });
}

void gcdt_result_release(gcdt_result* result) { delete result; }

int32_t gcdt_result_statistics(const gcdt_result* result, gcdt_statistics* statistics) {
  return guarded_call(result ? result->state.get() : nullptr, [&] {
    const Statistics& s = result->data.statistics;
    gcdt_statistics c = {};
    c.n = s.n, c.m = s.m, c.vertices_merged = s.vertices_merged;
    c.constraints_zero = s.constraints_zero, c.constraints_pieces = s.constraints_pieces;
    c.constraints_overlapping = s.constraints_overlapping;
    c.crossings = s.crossings, c.constraints_dropped = s.constraints_dropped;
    c.vertices_added = s.vertices_added, c.triangles = s.triangles;
    c.grid = write_grid(s.grid);
    c.ms_core = s.ms.core, c.ms_full = s.ms.full, c.ms_build = s.ms.build, c.ms_order = s.ms.order;
    c.ms_insert = s.ms.insert, c.ms_constrain = s.ms.constrain, c.ms_flip = s.ms.flip;
    c.ms_check = s.ms.check, c.ms_output = s.ms.output;
    c.rounds_insert = s.rounds.insert, c.rounds_flip = s.rounds.flip;
    c.flips = s.flips, c.history_depth = s.history_depth, c.location_steps = s.location_steps;
    c.launches = s.launches, c.read_backs = s.read_backs, c.crossed_pairs = s.crossed_pairs;
    c.peak_device_bytes = s.peak_device_bytes, c.held_device_bytes = s.held_device_bytes;
    c.edge_splits = s.cases.edge_splits, c.constraint_hits = s.cases.constraint_hits;
    c.existing_edges = s.cases.existing_edges, c.pieces_walked = s.cases.pieces_walked;
    c.chain_vertices = s.cases.chain_vertices, c.holes = s.cases.holes;
    c.symbolic_chain_vertices = s.cases.symbolic_chain_vertices;
    c.device = s.device.c_str(), c.driver = s.driver.c_str();
    c.platform = s.platform.c_str(), c.version = s.version.c_str();
    c.constraints_split = s.constraints_split, c.constraint_move = s.constraint_move;
    write_struct(c, statistics, "gcdt_statistics", offsetof(gcdt_statistics, constraints_split));
  });
}

const char* gcdt_result_note(const gcdt_result* result, size_t number) {
  if (!result || number >= result->data.statistics.notes.size()) return nullptr;
  return result->data.statistics.notes[number].c_str();
}

// SPDX-License-Identifier: Apache-2.0
#include "statistics.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/grid_text.hpp"

namespace gcdt::command {

namespace {

using Json = nlohmann::ordered_json;

Json grid_json(const Grid& grid) {
  return {{"kind", io::kind_name(grid.kind)},
          {"origin", grid.origin},
          {"cell", grid.cell()},
          {"largest_move", grid.largest_move}};
}

Json milliseconds_json(const Statistics::Milliseconds& ms) {
  return {{"read", ms.read},           {"call", ms.call},   {"core", ms.core},   {"full", ms.full},
          {"write", ms.write},         {"build", ms.build}, {"order", ms.order}, {"insert", ms.insert},
          {"constrain", ms.constrain}, {"flip", ms.flip},   {"check", ms.check}, {"output", ms.output},
          {"domain", ms.domain},       {"clean", ms.clean}, {"walk", ms.walk},   {"gather", ms.gather}};
}

Json quality_json(const Quality& q) {
  return {{"least_angle", q.least_angle},
          {"least_angle_triangle", q.least_angle_triangle},
          {"largest_angle", q.largest_angle},
          {"largest_angle_triangle", q.largest_angle_triangle},
          {"least_area", q.least_area},
          {"largest_area", q.largest_area},
          {"area", q.area}};
}

Json cases_json(const Statistics::Cases& cases) {
  return {{"edge_splits", cases.edge_splits},
          {"constraint_hits", cases.constraint_hits},
          {"existing_edges", cases.existing_edges},
          {"pieces_walked", cases.pieces_walked},
          {"chain_vertices", cases.chain_vertices},
          {"holes", cases.holes},
          {"symbolic_chain_vertices", cases.symbolic_chain_vertices},
          {"pairs_cut_one_corner", cases.pairs_cut_one_corner},
          {"pairs_from_one_corner", cases.pairs_from_one_corner},
          {"pairs_cut_two_corners", cases.pairs_cut_two_corners},
          {"pairs_cut_and_from", cases.pairs_cut_and_from}};
}

Json assessment_json(const Assessment& a) {
  return {{"valid", a.valid},
          {"outline_simple", a.outline_simple},
          {"triangles_inverted", a.triangles_inverted},
          {"triangles_flat", a.triangles_flat},
          {"vertices_lost", a.vertices_lost},
          {"edges_not_delaunay", a.edges_not_delaunay}};
}

}  // namespace

std::string statistics_json(const Statistics& s, const Measured& measured) {
  Json json = {{"n", s.n},
               {"m", s.m},
               {"vertices_merged", s.vertices_merged},
               {"vertices_rounded_together", s.vertices_rounded_together},
               {"rounded_pair", s.vertices_rounded_together == 0 ? Json() : Json(s.rounded_pair)},
               {"constraints_zero", s.constraints_zero},
               {"constraints_pieces", s.constraints_pieces},
               {"constraints_overlapping", s.constraints_overlapping},
               {"crossings", s.crossings},
               {"constraints_dropped", s.constraints_dropped},
               {"vertices_added", s.vertices_added},
               {"constraints_split", s.constraints_split},
               {"constraint_move", s.constraint_move},
               {"triangles", s.triangles},
               {"quality", quality_json(measured.quality)},
               {"grid", grid_json(s.grid)},
               {"ms", milliseconds_json(s.ms)},
               {"rounds", {{"insert", s.rounds.insert}, {"flip", s.rounds.flip}}},
               {"flips", s.flips},
               {"history_depth", s.history_depth},
               {"location_steps", s.location_steps},
               {"launches", s.launches},
               {"read_backs", s.read_backs},
               {"crossed_pairs", s.crossed_pairs},
               {"regions", s.regions},
               {"triangles_removed", s.triangles_removed},
               {"deepest", s.deepest},
               {"open_parity", s.open_parity},
               {"open_winding", s.open_winding},
               {"peak_device_bytes", s.peak_device_bytes},
               {"device", s.device},
               {"driver", s.driver},
               {"platform", s.platform},
               {"version", s.version},
               {"cases", cases_json(s.cases)},
               {"notes", s.notes}};
  if (measured.given) json["given"] = assessment_json(*measured.given);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string statistics_table(const Statistics& s, const Measured& measured) {
  std::string table;
  auto row = [&](const char* name, const std::string& value) { table += fmt::format("{:<12}  {}\n", name, value); };
  row("vertices",
      fmt::format("{} ({} merged, {} of these by rounding)", s.n, s.vertices_merged, s.vertices_rounded_together));
  row("constraints", fmt::format("{} ({} of length zero, {} dropped)", s.m, s.constraints_zero, s.constraints_dropped));
  row("pieces", fmt::format("{} ({} overlapping)", s.constraints_pieces, s.constraints_overlapping));
  row("crossings", s.vertices_added + s.constraints_split == 0
                       ? fmt::format("{}", s.crossings)
                       : fmt::format("{} ({} vertices added, {} constraints split, moved by {} at most)", s.crossings,
                                     s.vertices_added, s.constraints_split, s.constraint_move));
  row("triangles", fmt::format("{} ({} removed)", s.triangles, s.triangles_removed));
  if (s.regions != 0)
    row("regions", fmt::format("{}, {} deep ({} edges open by even-odd, {} by winding)", s.regions, s.deepest,
                               s.open_parity, s.open_winding));
  row("grid", fmt::format("{}, origin {},{}, cell {}, largest move {}", io::kind_name(s.grid.kind), s.grid.origin[0],
                          s.grid.origin[1], s.grid.cell(), s.grid.largest_move));
  if (const auto& given = measured.given)
    row("as given", fmt::format("{}: {} triangles inverted, {} flat, {} vertices lost, {} edges not Delaunay",
                                given->valid ? "valid" : "not valid", given->triangles_inverted, given->triangles_flat,
                                given->vertices_lost, given->edges_not_delaunay));
  row("rounds", fmt::format("{} insert, {} flip ({} flips)", s.rounds.insert, s.rounds.flip, s.flips));
  row("time", fmt::format("{:.1f} ms (building {:.1f}, phases {:.1f}; core {:.1f}), read {:.1f}", s.ms.call, s.ms.build,
                          s.ms.full, s.ms.core, s.ms.read));
  row("", fmt::format("order {:.1f}, insert {:.1f}, constrain {:.1f}, flip {:.1f}, check {:.1f}, output {:.1f}",
                      s.ms.order, s.ms.insert, s.ms.constrain, s.ms.flip, s.ms.check, s.ms.output));
  row("memory", fmt::format("{:.1f} MiB on the device", static_cast<double>(s.peak_device_bytes) / (1 << 20)));
  row("device", fmt::format("{} ({}, driver {})", s.device, s.platform, s.driver));
  return table;
}

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
#include "statistics.hpp"

#include <fmt/args.h>
#include <fmt/format.h>

#include <functional>

#include <nlohmann/json.hpp>

#include "io/grid_text.hpp"

namespace gcdt::command {

namespace {

using Json = nlohmann::ordered_json;

/// What the file has: statistics, and what was asked for beside them.
struct Shown : Statistics {
  Shown(const Statistics& statistics, const Measured& measured) : Statistics(statistics), quality(measured.quality) {}
  std::optional<Quality> quality;
};

template <class T>
Json value_of(const T& value) {
  return value;
}

Json value_of(const Grid& grid) {
  return {{"kind", io::kind_name(grid.kind)},
          {"origin", grid.origin},
          {"cell", grid.cell()},
          {"largest_move", grid.largest_move}};
}

Json value_of(const std::optional<Quality>& quality) {
  if (!quality) return nullptr;
  const Quality& q = *quality;
  return {{"least_angle", q.least_angle},
          {"least_angle_triangle", q.least_angle_triangle},
          {"largest_angle", q.largest_angle},
          {"largest_angle_triangle", q.largest_angle_triangle},
          {"least_area", q.least_area},
          {"largest_area", q.largest_area},
          {"area", q.area}};
}

Json value_of(const Assessment& a) {
  return {{"valid", a.valid},
          {"outline_simple", a.outline_simple},
          {"triangles_inverted", a.triangles_inverted},
          {"triangles_flat", a.triangles_flat},
          {"vertices_lost", a.vertices_lost},
          {"edges_not_delaunay", a.edges_not_delaunay}};
}

/// `name`: of an object's member after a dot.
void put(Json& json, const std::string& name, Json value) {
  const std::size_t dot = name.find('.');
  (dot == std::string::npos ? json[name] : json[name.substr(0, dot)][name.substr(dot + 1)]) = std::move(value);
}

/// The numbers and strings by the names of their members in gcdt_statistics.
using Values = fmt::dynamic_format_arg_store<fmt::format_context>;

Values values_of(const Statistics& s) {
  Values values;
#define GCDT_STATISTIC(member, name) values.push_back(fmt::arg(#member, s.name));
#define GCDT_STATISTIC_TEXT(member, name) values.push_back(fmt::arg(#member, std::cref(s.name)));
#include <gcdt/statistics.def>
  return values;
}

/// Of a refinement: what was added, and what is not as wanted.
template <class Row>
void refined_rows(const Statistics& s, Row&& row) {
  row("refined",
      "{refine_added} vertices added, {refine_on_subsegments} of them on constraints and borders, in {refine_rounds} "
      "rounds");
  if (s.refine.bent > 0)
    row("", "{refine_bent} are beside their constraint or border, constraints moved by {refine_move} at most");
  std::string left;
  const auto reason = [&](std::uint64_t count, const char* why) {
    if (count > 0) left += fmt::format("{}{} {}", left.empty() ? "" : ", ", count, why);
  };
  reason(s.refine.left_input_angle, "in angles between constraints");
  reason(s.refine.left_beside_angle, "beside such angles");
  reason(s.refine.left_grid, "by the grid or the least length");
  reason(s.refine.left_fixed, "by what is not split");
  reason(s.refine.left_refused, "by constraints that could not be split");
  reason(s.refine.left_limit, "by the limit of vertices");
  row("not as wanted", left.empty() ? "nothing" : left);
}

}  // namespace

std::string statistics_json(const Statistics& statistics, const Measured& measured) {
  const Shown s(statistics, measured);
  Json json;
#define GCDT_STATISTIC_OTHER(name) put(json, #name, value_of(s.name));
#define GCDT_STATISTIC(member, name) GCDT_STATISTIC_OTHER(name)
#define GCDT_STATISTIC_TEXT(member, name) GCDT_STATISTIC_OTHER(name)
#include <gcdt/statistics.def>
  if (s.vertices_rounded_together == 0) json["rounded_pair"] = nullptr;
  json["plan"] = measured.plan;
  if (measured.tiles.tiles > 0)
    json["tiles"] = {{"count", measured.tiles.tiles}, {"seam_vertices", measured.tiles.seam_vertices}};
  if (measured.given) json["given"] = value_of(*measured.given);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string statistics_table(const Statistics& s, const Measured& measured) {
  const Values values = values_of(s);
  std::string table;
  const auto line = [&](const char* name, const std::string& value) {
    table += fmt::format("{:<13} {}\n", name, value);
  };
  const auto row = [&](const char* name, const std::string& value) { line(name, fmt::vformat(value, values)); };
  row("vertices", "{n} ({vertices_merged} merged, {vertices_rounded_together} of these by rounding)");
  row("constraints", "{m} ({constraints_zero} of length zero, {constraints_dropped} dropped)");
  row("pieces", "{constraints_pieces} ({constraints_overlapping} overlapping)");
  const std::uint64_t at_crossings = s.vertices_added - s.refine.added;
  row("crossings", at_crossings + s.constraints_split == 0
                       ? "{crossings}"
                       : "{crossings} (" + std::to_string(at_crossings) +
                             " vertices added, {constraints_split} constraints split, moved "
                             "by {constraint_move} at most)");
  if (measured.refined) refined_rows(s, row);
  row("triangles", "{triangles} ({triangles_removed} removed)");
  if (s.regions != 0)
    row("regions", "{regions}, {deepest} deep ({open_parity} edges open by even-odd, {open_winding} by winding)");
  line("grid", fmt::format("{}, origin {},{}, cell {}, largest move {}", io::kind_name(s.grid.kind), s.grid.origin[0],
                           s.grid.origin[1], s.grid.cell(), s.grid.largest_move));
  if (const auto& given = measured.given)
    line("as given", fmt::format("{}: {} triangles inverted, {} flat, {} vertices lost, {} edges not Delaunay",
                                 given->valid ? "valid" : "not valid", given->triangles_inverted, given->triangles_flat,
                                 given->vertices_lost, given->edges_not_delaunay));
  if (measured.tiles.tiles > 0) {
    line("tiles",
         fmt::format("{}, {} vertices in the seam between them", measured.tiles.tiles, measured.tiles.seam_vertices));
    line("time", fmt::vformat("{ms_call:.1f} ms", values) + fmt::format(", read {:.1f}", s.ms.read));
    row("devices", "{device}");
    return table;
  }
  row("rounds", "{rounds_insert} insert, {rounds_flip} flip ({flips} flips)");
  line("time",
       fmt::vformat("{ms_call:.1f} ms (building {ms_build:.1f}, phases {ms_full:.1f}; core {ms_core:.1f})", values) +
           fmt::format(", read {:.1f}", s.ms.read));
  row("",
      "order {ms_order:.1f}, insert {ms_insert:.1f}, constrain {ms_constrain:.1f}, flip {ms_flip:.1f}, check "
      "{ms_check:.1f}, output {ms_output:.1f}" +
          std::string(measured.refined ? ", refine {ms_refine:.1f}" : ""));
  line("memory", fmt::format("{:.1f} MiB on the device", static_cast<double>(s.peak_device_bytes) / (1 << 20)));
  row("device", "{device} ({platform}, driver {driver})");
  line("plan", measured.plan);
  return table;
}

}  // namespace gcdt::command

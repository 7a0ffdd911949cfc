// SPDX-License-Identifier: Apache-2.0
#include "batch_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace gcdt::command {

void add(const SplitReport& one, SplitReport& all) {
  all.crossings += one.crossings;
  all.vertices_added += one.vertices_added;
  all.constraints_split += one.constraints_split;
  all.constraint_move = std::max(all.constraint_move, one.constraint_move);
}

std::string statistics_json(const Told& told, const gcdt_batch_statistics& s, const Pool& pool) {
  nlohmann::ordered_json devices = nlohmann::ordered_json::array();
  for (const PoolDevice& device : pool.devices())
    devices.push_back({{"device", device.info.name},
                       {"platform", device.info.platform},
                       {"driver", device.info.driver},
                       {"plan", told.plans.at(devices.size())},
                       {"problems", device.problems},
                       {"vertices", device.vertices},
                       {"runs", device.runs},
                       {"ms", device.ms_busy},
                       {"lost", device.lost ? device.lost->what() : ""}});
  const nlohmann::ordered_json json = {{"inputs", told.inputs},
                                       {"failed", told.failed},
                                       {"n", s.vertices},
                                       {"m", s.constraints},
                                       {"triangles", s.triangles},
                                       {"vertices_rounded_together", told.rounded_together},
                                       {"crossings", told.split.crossings},
                                       {"vertices_added", told.split.vertices_added},
                                       {"constraints_split", told.split.constraints_split},
                                       {"constraint_move", told.split.constraint_move},
                                       {"refine_added", told.refine_added},
                                       {"refine_incomplete", told.refine_incomplete},
                                       {"ms", {{"read", told.read}, {"call", s.ms_call}, {"write", told.write}}},
                                       {"devices", std::move(devices)},
                                       {"version", version()}};
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string statistics_table(const Told& told, const gcdt_batch_statistics& s, const Pool& pool) {
  std::string table = fmt::format(
      "inputs        {} ({} failed)\nvertices      {}\nconstraints   {}\ntriangles     {}\n"
      "time          {:.1f} ms, read {:.1f}, write {:.1f}\n",
      told.inputs, told.failed, s.vertices, s.constraints, s.triangles, s.ms_call, told.read, told.write);
  if (told.split.crossings > 0)
    table += fmt::format("crossings     {} ({} vertices added, {} constraints split, moved by {} at most)\n",
                         told.split.crossings, told.split.vertices_added, told.split.constraints_split,
                         told.split.constraint_move);
  if (told.refine_added > 0)
    table += fmt::format("refined       {} vertices added ({} inputs ended by the limit)\n", told.refine_added,
                         told.refine_incomplete);
  for (const PoolDevice& device : pool.devices())
    table += fmt::format("device        {} ({}): {}\n", device.info.name, device.info.platform,
                         device.lost ? "taken out: " + std::string(device.lost->what())
                                     : fmt::format("{} inputs, {} vertices in {} runs, {:.1f} ms", device.problems,
                                                   device.vertices, device.runs, device.ms_busy));
  return table;
}

}  // namespace gcdt::command

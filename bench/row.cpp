// SPDX-License-Identifier: Apache-2.0
#include "row.hpp"

#include <algorithm>
#include <ctime>

#include "results.hpp"

namespace gcdt::bench {

namespace {

struct Spread {
  double least, quarter, median, three_quarters, most;
};

Spread spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {  // between the two nearest
    const double place = share * static_cast<double>(values.size() - 1);
    const std::size_t below = static_cast<std::size_t>(place), above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
  };
  return {at(0), at(0.25), at(0.5), at(0.75), at(1)};
}

std::string text(const Spread& s) {
  return Object()
      .add("min", s.least)
      .add("q1", s.quarter)
      .add("median", s.median)
      .add("q3", s.three_quarters)
      .add("max", s.most)
      .text();
}

std::vector<double> all(const Row& row, double Statistics::Milliseconds::*step) {
  std::vector<double> values;
  for (const auto& ms : row.ms) values.push_back(ms.*step);
  return values;
}

/// The best peer in one place, all of them in another. On a GPU, anchors of peers that do not run here count
/// too; on a CPU, whose cores differ, only where no peer ran.
void add_peers(Object& o, const Row& row, bool gpu, const std::string& file) {
  std::string best, source, list;
  double best_ms = 0;
  bool ran = false;
  const auto consider = [&](const std::string& name, double ms, const std::string& from, const Object& what) {
    list += (list.empty() ? "" : ", ") + what.text();
    if (ms > 0 && (best.empty() || ms < best_ms)) best = name, best_ms = ms, source = from;
  };
  for (const auto& [name, times] : row.peers) {
    Object what;
    what.add("name", name);
    if (!times.error.empty()) {
      consider(name, 0, "", what.add("error", times.error));
      continue;
    }
    const Spread s = spread(times.ms);
    ran = true;
    what.add("ms", s.median).raw("spread", text(s)).add("runs", static_cast<unsigned long long>(times.ms.size()));
    consider(name, s.median, "measured", what.add("triangles", times.triangles).add("source", "measured"));
  }
  if (gpu || !ran)
    for (const Anchor& a : anchors(file, gpu, row.input.name, row.input.size)) {
      bool measured = false;
      for (const auto& [name, times] : row.peers)
        measured |= times.error.empty() && name.compare(0, a.peer.size(), a.peer) == 0;
      if (measured) continue;
      const std::string from = "anchor of " + a.date + ", " + a.machine;
      consider(a.peer, a.ms, from, Object().add("name", a.peer).add("ms", a.ms).add("source", from));
    }
  if (best.empty())
    o.raw("peer", "null").raw("peer_ms", "null");
  else
    o.add("peer", best).add("peer_ms", best_ms).add("peer_source", source);
  o.raw("peers", '[' + list + ']');
}

}  // namespace

double median(const Row& row, double Statistics::Milliseconds::*step) { return spread(all(row, step)).median; }

std::string describe(const Row& row, const DeviceInfo& device, const std::string& fault, const std::string& anchors,
                     const std::string& commit) {
  using Ms = Statistics::Milliseconds;
  const Statistics& s = row.mesh.statistics;
  const auto count = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  Object o;
  o.add("workload", row.input.name).add("size", count(row.input.size));
  o.add("n", count(s.n)).add("m", count(s.m)).add("device", device.name);
  const Spread core = spread(all(row, &Ms::core)), full = spread(all(row, &Ms::full));
  o.add("core_ms", core.median).add("full_ms", full.median);
  add_peers(o, row, device.is_gpu, anchors);
  o.add("verified", fault.empty() && row.same_bytes);
  if (!fault.empty()) o.add("fault", fault);
  o.add("verified_by", s.n > largest_verified ? "device check and sample" : "verify").add("checked", row.options.check);
  o.add("same_bytes", row.same_bytes).add("runs", count(row.ms.size()));
  o.raw("core", text(core)).raw("full", text(full)).raw("call", text(spread(row.call_ms)));
  Object phases;
  phases.add("order", median(row, &Ms::order)).add("insert", median(row, &Ms::insert));
  phases.add("constrain", median(row, &Ms::constrain)).add("clean", median(row, &Ms::clean));
  phases.add("walk", median(row, &Ms::walk)).add("gather", median(row, &Ms::gather));
  phases.add("flip", median(row, &Ms::flip)).add("check", median(row, &Ms::check));
  phases.add("output", spread(row.order_ms).median);
  phases.add("copy", median(row, &Ms::output) - spread(row.order_ms).median);
  o.raw("phases", phases.text());
  if (!row.pinned_ms.empty())
    o.add("pinned_ms", spread(row.pinned_ms).median).raw("pinned", text(spread(row.pinned_ms)));
  o.add("regions_ms", row.regions_ms)
      .add("located", static_cast<unsigned long long>(row.located))
      .add("locate_ms", row.locate_ms);
  o.add("device_locate_ms", row.device_locate_ms).add("verify_ms", row.verify_ms);
  std::string kernels;
  for (const auto& [kernel, spent] : row.kernels)
    kernels += (kernels.empty() ? "" : ", ") + Object()
                                                   .add("name", kernel)
                                                   .add("ms", spent.first)
                                                   .add("launches", static_cast<unsigned long long>(spent.second))
                                                   .text();
  o.raw("kernels", '[' + kernels + ']');
  o.add("triangles", count(s.triangles)).add("insert_rounds", count(s.rounds.insert));
  o.add("flip_rounds", count(s.rounds.flip)).add("flips", count(s.flips));
  o.add("history_depth", count(s.history_depth)).add("location_steps", count(s.location_steps));
  o.add("crossed_pairs", count(s.crossed_pairs)).add("launches", count(s.launches));
  o.add("read_backs", count(s.read_backs)).add("peak_device_bytes", count(s.peak_device_bytes));
  o.add("bytes_per_vertex",
        static_cast<double>(s.peak_device_bytes) / static_cast<double>(std::max<std::uint64_t>(s.n, 1)));
  o.add("merged", count(s.vertices_merged)).add("crossings", count(s.crossings));
  o.add("dropped", count(s.constraints_dropped)).add("version", s.version).add("commit", commit);
  return o.add("date", date()).text();
}

std::string date() {
  const std::time_t now = std::time(nullptr);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now));
  return text;
}

}  // namespace gcdt::bench

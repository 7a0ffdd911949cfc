// SPDX-License-Identifier: Apache-2.0
#include "trace.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace gcdt::command {

namespace {

using Json = nlohmann::ordered_json;

/// The phases in the order in which their rows stand: those of one problem, then all others (of pools, tiles, ranks).
std::vector<std::string> rows_of(const std::vector<TraceSpan>& spans) {
  std::vector<std::string> rows = {"order", "plan", "insert", "constrain", "flip", "check", "domain", "output", "copy"};
  const std::set<std::string> first(rows.begin(), rows.end());
  std::set<std::string> others;
  for (const TraceSpan& span : spans)
    if (first.count(span.phase) == 0) others.insert(span.phase);
  rows.insert(rows.end(), others.begin(), others.end());
  return rows;
}

Json name_of(const char* what, std::uint32_t process, std::size_t row, const std::string& name) {
  return {{"name", what}, {"ph", "M"}, {"pid", process}, {"tid", row}, {"args", {{"name", name}}}};
}

}  // namespace

std::string TraceRecord::json() const {
  std::uint64_t start = ~std::uint64_t{0};
  std::map<std::uint32_t, std::string> devices;
  for (const TraceSpan& span : spans_) {
    start = std::min(start, span.begin_ns);
    devices.emplace(span.device_number, span.device);
  }
  const std::vector<std::string> rows = rows_of(spans_);
  const auto row_of = [&](const std::string& phase) {
    return static_cast<std::size_t>(std::find(rows.begin(), rows.end(), phase) - rows.begin());
  };
  Json events = Json::array();
  for (const auto& [number, name] : devices) {
    events.push_back(name_of("process_name", number, 0, name));
    for (std::size_t row = 0; row < rows.size(); ++row)
      events.push_back(name_of("thread_name", number, row, rows[row]));
  }
  for (const TraceSpan& span : spans_)
    events.push_back({{"name", span.name},
                      {"cat", span.on_device ? "launch" : "phase"},
                      {"ph", "X"},
                      {"ts", double(span.begin_ns - start) / 1e3},
                      {"dur", double(span.end_ns - span.begin_ns) / 1e3},
                      {"pid", span.device_number},
                      {"tid", row_of(span.phase)}});
  const Json file = {{"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}};
  return file.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gcdt::command

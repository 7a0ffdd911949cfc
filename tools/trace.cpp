// SPDX-License-Identifier: Apache-2.0
#include "trace.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

namespace gcdt::command {

namespace {

using Json = nlohmann::ordered_json;

// The order in which rows stand.
constexpr const char* phases[] = {"order", "plan", "insert", "constrain", "flip", "check", "domain", "output", "copy"};

std::size_t row_of(const std::string& phase) {
  return std::size_t(std::find(std::begin(phases), std::end(phases), phase) - std::begin(phases));
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
  Json events = Json::array();
  for (const auto& [number, name] : devices) {
    events.push_back(name_of("process_name", number, 0, name));
    for (const char* phase : phases) events.push_back(name_of("thread_name", number, row_of(phase), phase));
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

// SPDX-License-Identifier: Apache-2.0
// gcdt devices: what --device can choose from.
#include <fmt/format.h>

#include <algorithm>

#include "command.hpp"

namespace gcdt::command {

namespace {

using Row = std::vector<std::string>;

std::string mebibytes(std::uint64_t bytes) { return fmt::format("{} MiB", bytes >> 20); }

Row row_of(std::size_t number, const DeviceInfo& d) {
  return {std::to_string(number),
          d.name,
          d.is_gpu   ? "GPU"
          : d.is_cpu ? "CPU"
                     : "other",
          d.platform,
          d.vendor,
          d.driver,
          mebibytes(d.memory_bytes),
          mebibytes(d.largest_buffer_bytes),
          std::to_string(d.compute_units),
          d.atomics64 ? "yes" : "no",
          d.fp64 ? "yes" : "no"};
}

std::string aligned(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const Row& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c)
      text += c + 1 < row.size() ? fmt::format("{:<{}}  ", row[c], widths[c]) : row[c];
    text += '\n';
  }
  return text;
}

}  // namespace

void list_devices() {
  const std::vector<DeviceInfo> all = devices();
  if (all.empty()) select_device("auto");  // throws, and says what to install
  std::vector<Row> rows{{"number", "name", "type", "platform", "vendor", "driver", "memory", "largest buffer", "units",
                         "64-bit atomics", "fp64"}};
  for (std::size_t i = 0; i < all.size(); ++i) rows.push_back(row_of(i, all[i]));
  print(aligned(rows));
}

}  // namespace gcdt::command

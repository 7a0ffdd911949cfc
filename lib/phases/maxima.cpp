// SPDX-License-Identifier: Apache-2.0
#include "phases/maxima.hpp"

#include <algorithm>

namespace gcdt {

Maxima::Maxima(runtime::Runtime& runtime, std::size_t items, cl_uint column_count)
    : rows(static_cast<cl_uint>(runtime.row_groups_of(items))),
      columns(column_count),
      table(runtime.allocate<cl_ulong>("maxima", std::size_t{rows} * columns)),
      memory{sizeof(cl_ulong) * columns * runtime.geometry().local},
      groups(runtime.over_groups(rows)) {}

std::vector<cl_ulong> Maxima::read(runtime::Runtime& runtime) const {
  std::vector<cl_ulong> values(std::size_t{rows} * columns), most(columns, 0);
  runtime.read(table, values.data(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) most[i % columns] = std::max(most[i % columns], values[i]);
  return most;
}

}  // namespace gcdt

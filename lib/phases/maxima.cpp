// SPDX-License-Identifier: Apache-2.0
#include "phases/maxima.hpp"

#include <algorithm>

namespace gcdt {

Maxima::Maxima(runtime::Runtime& runtime, std::size_t items, cl_uint column_count)
    : rows(static_cast<cl_uint>(runtime.rows_of(items))), columns(column_count) {
  table = runtime.allocate<cl_ulong>("maxima", std::size_t{rows} * columns);
}

std::vector<cl_ulong> Maxima::read(runtime::Runtime& runtime) {
  // Ends: see fewer_rows.
  for (cl_uint folded_rows; (folded_rows = runtime.fewer_rows(rows)) < rows; rows = folded_rows) {
    auto folded = runtime.allocate<cl_ulong>("folded maxima", std::size_t{folded_rows} * columns);
    runtime.launch("order", "fold_maxima", runtime::over(std::size_t{folded_rows} * columns), rows, columns, table,
                   folded_rows, folded);
    table = std::move(folded);
  }
  std::vector<cl_ulong> values(std::size_t{rows} * columns), most(columns, 0);
  runtime.read(table, values.data(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) most[i % columns] = std::max(most[i % columns], values[i]);
  return most;
}

}  // namespace gcdt

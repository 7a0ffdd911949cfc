// SPDX-License-Identifier: Apache-2.0
// Maxima of 64 bits over many items: not every device has 64-bit atomics.
#pragma once

#include <vector>

#include "device/runtime.hpp"

namespace gcdt {

/// A table of maxima, one row for each work-group that the device runs at once, which a kernel writes
/// (kernels/order/maxima.h).
struct Maxima {
  cl_uint rows, columns;
  runtime::Buffer<cl_ulong> table;
  runtime::LocalMemory memory;  ///< of each group
  runtime::Range groups;        ///< to launch

  Maxima(runtime::Runtime& runtime, std::size_t items, cl_uint column_count);

  /// The maximum of each column. Blocks.
  std::vector<cl_ulong> read(runtime::Runtime& runtime) const;
};

}  // namespace gcdt

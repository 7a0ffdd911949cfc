// SPDX-License-Identifier: Apache-2.0
// What one work-item that orders all vertices by itself reports. OpenCL C and C++17.
#ifndef GCDT_FEW_H
#define GCDT_FEW_H

#include "order/grid.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

typedef struct OrderReport {
  Scale scale;         // read if the grid is given, else written
  Decimals decimals;   // if the grid is decimal
  u64 surveyed[6];     // the maxima of kernel `survey`
  u64 quantised[2];    // those of kernel `quantise`; 0 if the grid is decimal
  i32 exponent;        // of the cell, if the grid is neither given nor decimal
  i32 decimal_digits;  // that the input needs to be written, if the grid is decimal, else -1
  u32 distinct;        // vertices
  u32 padding;
} OrderReport;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(OrderReport) == sizeof(Scale) + sizeof(Decimals) + 8 * sizeof(u64) + 4 * sizeof(u32),
              "OrderReport has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif

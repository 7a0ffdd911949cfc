// SPDX-License-Identifier: Apache-2.0
// What one work-item that orders all vertices by itself reports. OpenCL C and C++17.
#ifndef GCDT_FEW_H
#define GCDT_FEW_H

#include "order/grid.h"
#include "order/survey.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

typedef struct OrderReport {
  Scale scale;        // read if the grid is given, else written
  Decimals decimals;  // if the grid is decimal
  u64 surveyed[GCDT_SURVEY_COLUMNS];
  u64 quantised[GCDT_QUANTISE_COLUMNS];  // 0 if the grid is decimal
  i32 decimal_digits;                    // that the input needs to be written, if the grid is decimal, else -1
  u32 distinct;                          // vertices
} OrderReport;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(OrderReport) == sizeof(Scale) + sizeof(Decimals) +
                                         (GCDT_SURVEY_COLUMNS + GCDT_QUANTISE_COLUMNS) * sizeof(u64) + 2 * sizeof(u32),
              "OrderReport has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif

// SPDX-License-Identifier: Apache-2.0
// What the order phase of a forest shares: chunks of problems, and each problem's grid. OpenCL C and C++17.
#ifndef GCDT_PROBLEMS_H
#define GCDT_PROBLEMS_H

#include "order/decimals.h"
#include "order/quantise.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// Vertices of one problem that one work-item takes: [first, end) of all input vertices.
typedef struct Chunk {
  u32 first, end, problem, padding;
} Chunk;

// How a problem's coordinates get to its grid.
typedef struct ProblemGrid {
  Scale scale;
  Decimals decimals;
  u32 is_decimal;  // nonzero: by `decimals`, else by `scale`
  u32 padding;
} ProblemGrid;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(Chunk) == 4 * sizeof(u32), "Chunk has the same layout on host and device");
static_assert(sizeof(ProblemGrid) == sizeof(Scale) + sizeof(Decimals) + 2 * sizeof(u32),
              "ProblemGrid has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif

// SPDX-License-Identifier: Apache-2.0
// What the kernels of the order phase and the host exchange. OpenCL C and C++17.
#ifndef GCDT_ORDER_H
#define GCDT_ORDER_H

#include "order/decimals.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// ---- Columns of tables of maxima, since a maximum does not depend on the order of folding --------------

// By a survey: ~min x, max x, ~min y, max y (ordered keys), and behind them
#define GCDT_SURVEY_TRAILING 4  // the complement of the least trailing exponent - GCDT_LEAST_EXPONENT; 0: all are zero
#define GCDT_SURVEY_BAD 5       // the complement of the least coordinate that is not finite; 0: none
#define GCDT_SURVEY_COLUMNS 6u

// By putting them on the grid:
#define GCDT_QUANTISE_MOVE 0     // the largest move (gcdt_move_key)
#define GCDT_QUANTISE_OUTSIDE 1  // the complement of the least coordinate outside the grid; 0: none
#define GCDT_QUANTISE_COLUMNS 2u

// By looking at vertices that rounding made one, words of a problem (given.cl): how many were given elsewhere than the
// one that stands for them; the least of these; the one that stands for it.
#define GCDT_TOGETHER_WORDS 3u

// ---- Structs --------------------------------------------------------------------------------------------

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

// What one work-item that orders all vertices by itself (by_one_item.cl) reports.
typedef struct OrderReport {
  Scale scale;        // read if the grid is given, else written
  Decimals decimals;  // if the grid is decimal
  u64 surveyed[GCDT_SURVEY_COLUMNS];
  u64 quantised[GCDT_QUANTISE_COLUMNS];  // 0 if the grid is decimal
  i32 decimal_digits;                    // that the input needs to be written, if the grid is decimal, else -1
  u32 distinct;                          // vertices
} OrderReport;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(Chunk) == 4 * sizeof(u32), "Chunk has the same layout on host and device");
static_assert(sizeof(ProblemGrid) == sizeof(Scale) + sizeof(Decimals) + 2 * sizeof(u32),
              "ProblemGrid has the same layout on host and device");
static_assert(sizeof(OrderReport) == sizeof(Scale) + sizeof(Decimals) +
                                         (GCDT_SURVEY_COLUMNS + GCDT_QUANTISE_COLUMNS) * sizeof(u64) + 2 * sizeof(u32),
              "OrderReport has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif

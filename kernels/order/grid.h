// SPDX-License-Identifier: Apache-2.0
// The choice of a grid from what a survey of the input has found, in integer arithmetic (lib/mesh/grid.cpp). OpenCL C
// and C++17. `least` and `most`: the least and largest coordinate by axis, as the bits of doubles, -0 made 0.
#ifndef GCDT_GRID_H
#define GCDT_GRID_H

#include "order/order.h"

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// Cell = 2^k * U / five with U = (units_low, units_high) < 2^116; see quantise.h for the window.
GCDT_INLINE void gcdt_make_scale(GCDT_GLOBAL Scale* scale, const u64* origin, u64 five, u64 units_low, u64 units_high,
                                 i32 k) {
  const i32 log2_units = (units_high ? 64 + gcdt_bit_length(units_high) : gcdt_bit_length(units_low)) - 1;
  const i32 w = log2_units - GCDT_UNIT_BITS < -2 ? log2_units - GCDT_UNIT_BITS : -2;
  scale->five = five;
  scale->cell_low = gcdt_limb(units_low, units_high, -w);
  scale->cell_high = gcdt_limb(units_low, units_high, -w - 64);
  scale->power_of_two = scale->cell_low == 0 && scale->cell_high == (u64)1 << (GCDT_UNIT_BITS - 64);
  scale->offset = -k - w;
  scale->whole = five == 1 && units_low == 1 && units_high == 0 && k == 0 && origin[0] == 0 && origin[1] == 0;
  for (i32 axis = 0; axis < 2; ++axis) {
    u64 window[GCDT_WINDOW_LIMBS] = {0, 0, 0, 0}, low = 0, high = 0;
    scale->origin[axis] = origin[axis];
    scale->origin_fits[axis] = gcdt_place(origin[axis], five, scale->offset, window);
    for (i32 i = 0; i < GCDT_WINDOW_LIMBS; ++i) scale->origin_window[axis][i] = window[i];
    scale->fixed_point[axis] = scale->power_of_two && five == 1 && gcdt_fixed(origin[axis], scale->offset, &low, &high);
    const u32 minus = (origin[axis] & GCDT_SIGN_BIT) != 0;
    scale->origin_fixed[axis][0] = minus ? ~low + 1 : low;
    scale->origin_fixed[axis][1] = minus ? ~high + (low == 0 ? 1 : 0) : high;
  }
}

// The exponent of the ulp of the coordinate of largest magnitude.
GCDT_INLINE i32 gcdt_largest_exponent(const u64* least, const u64* most) {
  i32 exponent = GCDT_LEAST_EXPONENT;
  for (i32 axis = 0; axis < 2; ++axis) {
    const i32 a = gcdt_exponent(least[axis]), b = gcdt_exponent(most[axis]), larger = a > b ? a : b;
    exponent = larger > exponent ? larger : exponent;
  }
  return exponent;
}

GCDT_INLINE u32 gcdt_one_point(const u64* least, const u64* most) { return least[0] == most[0] && least[1] == most[1]; }

// Leaves in *scale that of the least k >= -1074 with round_half_even(extent / 2^k) <= 2^31 - 1 on both axes (0 if both
// extents are 0), and returns that k. |v| < 2^(q + 53) for q = gcdt_largest_exponent, so the extent is below 2^(q + 54)
// and k = q + 24 fits. Ends: the extent is at least 2^(q - 1) (lemma L in quantise.h), so k > q - 33.
GCDT_INLINE i32 gcdt_finest_exponent(const u64* least, const u64* most, GCDT_GLOBAL Scale* scale) {
  i32 k = 0;
  if (!gcdt_one_point(least, most)) {
    k = gcdt_largest_exponent(least, most) + 24;
    for (u32 fits = 1; fits && k > GCDT_LEAST_EXPONENT;) {
      gcdt_make_scale(scale, least, 1, 1, 0, k - 1);
      for (i32 axis = 0; axis < 2; ++axis) fits = fits && !gcdt_quantise(most[axis], scale, axis).outside;
      if (fits) --k;
    }
  }
  gcdt_make_scale(scale, least, 1, 1, 0, k);
  return k;
}

// No decimal grid has more decimals than this (which may be -1), given k = gcdt_finest_exponent and that the binary
// grid does not do.
//
// So k > -1074 and the extent E >= (2^32 - 1) 2^(k-2) does not fit 2^(k-1). Decimals that read as doubles of magnitude
// up to M are within ulp(M) / 2 of them, so their extent is at least E - ulp(M), and at least E/2 >= 2^(k+28) if
// ulp(M) <= 2^(k+28). D decimals then fit only if 2^(k+28) 10^D < 2^31, that is 5^D < 2^(3 - k - D).
GCDT_INLINE i32 gcdt_decimals_limit(const u64* least, const u64* most, i32 k) {
  i32 limit = GCDT_MAX_DECIMALS;
  if (gcdt_largest_exponent(least, most) > k + 28) return limit;
  while (limit >= 0 && gcdt_bit_length(gcdt_powers_of_five[limit]) > 3 - k - limit) --limit;
  return limit;
}

// The cell 2^k that an input gets before its decimals are counted.
typedef struct Cell {
  i32 exponent;        // k
  u32 moves;           // nonzero: not all coordinates are multiples of the cell
  i32 decimals_limit;  // a decimal grid goes before it if so many decimals are enough, and it fits; -1: none does
} Cell;

// `trailing`: all coordinates are multiples of 2^trailing. Leaves in *scale how coordinates get to that cell.
GCDT_INLINE Cell gcdt_choose_cell(const u64* least, const u64* most, i32 trailing, GCDT_GLOBAL Scale* scale) {
  Cell cell;
  cell.exponent = gcdt_finest_exponent(least, most, scale);
  cell.moves = !gcdt_one_point(least, most) && trailing < cell.exponent;
  cell.decimals_limit = cell.moves ? gcdt_decimals_limit(least, most, cell.exponent) : -1;
  return cell;
}

// Whether the decimal grid of an input that needs `digits` decimals to be written fits; then *decimals is how
// coordinates get there.
//
// Reading decimals as doubles is monotone, so the least double has the least decimal; and if the least and the largest
// numerators are below 2^63, all are.
GCDT_INLINE u32 gcdt_make_decimals(const u64* least, const u64* most, i32 digits, GCDT_GLOBAL Decimals* decimals) {
  u64 extent = 0;
  for (i32 axis = 0; axis < 2; ++axis) {
    const i64 first = gcdt_decimal_numerator(least[axis], digits), last = gcdt_decimal_numerator(most[axis], digits);
    if ((u64)first == GCDT_NUMERATOR_OVERFLOW || (u64)last == GCDT_NUMERATOR_OVERFLOW) return 0;
    const u64 length = (u64)last - (u64)first;
    decimals->least[axis] = first;
    extent = length > extent ? length : extent;
  }
  if (extent > GCDT_GRID_LAST) return 0;
  decimals->digits = digits;
  decimals->padding = 0;
  u64 step = 1;
  for (i32 d = digits; d < GCDT_MAX_DECIMALS && extent * step * 10 <= GCDT_GRID_LAST; ++d) step *= 10;
  decimals->step = step;
  return 1;
}

#ifndef __OPENCL_VERSION__
}  // namespace gcdt::device
#endif

#endif

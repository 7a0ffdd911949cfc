// SPDX-License-Identifier: Apache-2.0
// A tile's own vertices among those of the input (docs/scale.md). Each tile looks at all of them, so what is far from
// it is told by comparisons alone: what is placed on the grid grows with what was given, and so a tile's box is one of
// numbers that were given, too (KeyBox of lib/tiles/placed.hpp).
#include "common/levels.h"
#include "order/decimals.h"
#include "order/maxima.h"
#include "order/order.h"

// Whether both coordinates, as the bits of doubles, are in the box, as keys in the order of doubles: least x, most x,
// least y, most y.
static inline bool is_near(ulong x, ulong y, ulong4 near) {
  const ulong kx = gcdt_ordered(x), ky = gcdt_ordered(y);
  return kx >= near.x && kx <= near.y && ky >= near.z && ky <= near.w;
}

// One work-group per row of the table, over its share of the points. Reads coordinates, all finite, and the scale.
// Writes flags[v]: whether point v is the tile's, then its code to codes[v]; maxima[row]: the greatest move key of the
// row's own. `memory`: see put_greatest. A row has one work-group, and a point one work-item.
kernel void take_codes(const uint count, const uint type, global const ulong* coordinates, global const Scale* scale,
                       const ulong4 near, const ulong first_code, const ulong last_code, const uint rows,
                       global uint* flags, global ulong* codes, global ulong* maxima, local ulong* memory) {
  FOR_EACH_OF_GROUPS(row, 0u, rows) {
    const Items items = items_of_row(count, row, rows);
    ulong move = 0, most_rest = 0;
    FOR_ITEMS(v, items) {
      const ulong x = gcdt_coordinate(coordinates, type, 2 * v), y = gcdt_coordinate(coordinates, type, 2 * v + 1);
      flags[v] = 0u;
      if (!is_near(x, y, near)) continue;
      ulong rest_x, rest_y;
      const Quantised on_x = gcdt_quantise_rest(x, scale, 0, &rest_x);
      const Quantised on_y = gcdt_quantise_rest(y, scale, 1, &rest_y);
      const ulong code = gcdt_morton(on_x.value, on_y.value);
      if (code < first_code || code > last_code) continue;
      flags[v] = 1u;
      codes[v] = code;
      move = max(move, max(on_x.move, on_y.move));
      most_rest = max(most_rest, max(rest_x, rest_y));
    }
    const ulong most = max(move, gcdt_rest_key(most_rest));
    put_greatest(&most, 1u, memory, maxima + row);
  }
}

// One work-item per point, on a decimal grid, where nothing moves. Reads coordinates. Writes flags[v] and codes[v] as
// take_codes does. Words v have one writer.
kernel void take_decimals(const uint count, const uint type, global const ulong* coordinates,
                          global const Decimals* decimals, const ulong4 near, const ulong first_code,
                          const ulong last_code, global uint* flags, global ulong* codes) {
  FOR_EACH(v, count) {
    const ulong x = gcdt_coordinate(coordinates, type, 2 * v), y = gcdt_coordinate(coordinates, type, 2 * v + 1);
    flags[v] = 0u;
    if (!is_near(x, y, near)) continue;
    const ulong code = gcdt_morton(gcdt_place_decimal(x, 0u, decimals), gcdt_place_decimal(y, 1u, decimals));
    if (code < first_code || code > last_code) continue;
    flags[v] = 1u;
    codes[v] = code;
  }
}

// One work-item per point. Reads codes of own ones, and the scan of flags. Writes coordinates and ids from `at` on:
// places differ, by the scan. `first_id`: the input number of point 0.
kernel void take_own(const uint count, const uint first_id, const uint at, global const ulong* codes,
                     global const uint* before, global ulong* coordinates, global uint* ids) {
  FOR_EACH(i, count) {
    if (before[i + 1u] == before[i]) continue;
    const uint place = at + before[i];
    coordinates[place] = (ulong)gcdt_gather_bits(codes[i]) | ((ulong)gcdt_gather_bits(codes[i] >> 1) << 32);
    ids[place] = first_id + i;
  }
}

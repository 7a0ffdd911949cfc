// SPDX-License-Identifier: Apache-2.0
// Finding a piece of a constraint by its ends. OpenCL C only.
#ifndef GCDT_PIECES_H
#define GCDT_PIECES_H

#include "common/levels.h"

// The number of the piece between vertices of ranks `lower` and `upper`, of pieces low .. high - 1; GCDT_NONE if it is
// none of them. Pieces are sorted by (rank of the lower end, rank of the other). Ends: high - low shrinks.
GCDT_INLINE uint find_piece_among(global const Levels* levels, uint low, uint high, global const uint2* ends,
                                  uint lower, uint upper) {
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    const uint2 e = ends[middle];
    uint found = gcdt_rank_of_vertex(levels, e.x), wanted = lower;
    if (found == wanted) {
      found = gcdt_rank_of_vertex(levels, e.y);
      wanted = upper;
      if (found == wanted) return middle;
    }
    if (found < wanted)
      low = middle + 1u;
    else
      high = middle;
  }
  return GCDT_NONE;
}

// The number of piece ab, whichever end comes first; GCDT_NONE if there is none.
GCDT_INLINE uint find_piece(global const Levels* levels, uint pieces, global const uint2* ends, uint a, uint b) {
  const uint ra = gcdt_rank_of_vertex(levels, a), rb = gcdt_rank_of_vertex(levels, b);
  return find_piece_among(levels, 0u, pieces, ends, min(ra, rb), max(ra, rb));
}

#endif

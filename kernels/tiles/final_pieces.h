// SPDX-License-Identifier: Apache-2.0
// A tile's pieces of constraints: those along final triangles stay on the device until their places in the result are
// known, the others are the seam's. OpenCL C only.
#ifndef GCDT_FINAL_PIECES_H
#define GCDT_FINAL_PIECES_H

#include "tiles/shares.h"

// One work-item per piece. Reads the scan of kept, and offsets. Writes counts[p]: how many sources piece p has if it is
// kept, else 0. Word p has one writer.
kernel void pieces_sources(const uint pieces, global const uint* before, global const uint* offsets,
                           global uint* counts) {
  FOR_EACH(p, pieces) counts[p] = before[p + 1u] == before[p] ? 0u : offsets[p + 1u] - offsets[p];
}

// One work-item per piece. Reads the pieces, and the scans of kept and of pieces_sources' counts. Writes those that are
// kept to one set of arrays, the others to another one, in their order: places differ, by the scans. Ends: a piece has
// finitely many sources.
kernel void pieces_part(const uint pieces, global const uint* before, global const uint* sources_before,
                        global const uint2* ends, global const uint* offsets, global const uint* sources,
                        global uint2* kept_ends, global uint* kept_offsets, global uint* kept_sources,
                        global uint2* seam_ends, global uint* seam_offsets, global uint* seam_sources) {
  FOR_EACH(p, pieces) {
    const bool is_kept = before[p + 1u] != before[p];
    const uint first = offsets[p], end = offsets[p + 1u];
    const uint place = is_kept ? before[p] : p - before[p],
               at = is_kept ? sources_before[p] : first - sources_before[p];
    global uint* const out = is_kept ? kept_sources : seam_sources;
    if (is_kept)
      kept_ends[place] = ends[p], kept_offsets[place] = at;
    else
      seam_ends[place] = ends[p], seam_offsets[place] = at;
    for (uint i = first; i < end; ++i) out[at + i - first] = sources[i];
  }
}

// One work-item per piece of the seam that begins in the tile. Reads its key, the codes of its ends, and the kept
// pieces, which are in the order of theirs; offsets, if `with_offsets`, else each has one source. Writes how many kept
// ones come before it, and how many sources these have. Words i have one writer. Ends: the range halves.
kernel void pieces_before(const uint count, const uint kept, const uint with_offsets, global const ulong2* keys,
                          global const uint2* ends, global const uint* offsets, global const int2* points,
                          global uint* counts, global uint* source_counts) {
  FOR_EACH(i, count) {
    uint low = 0, high = kept;
    while (low < high) {
      const uint middle = low + (high - low) / 2u;
      if (is_before_key(points, ends[middle].x, ends[middle].y, keys[i]))
        low = middle + 1u;
      else
        high = middle;
    }
    counts[i] = low;
    source_counts[i] = with_offsets ? offsets[low] : low;
  }
}

// One work-item per kept piece. Reads `before` of `count` pieces of the seam, which ascend, and seam_offsets, how many
// sources come before each of those, and all of them have; the kept pieces, and ids. Writes the piece at its place
// among all that begin in the tile: its ends as input numbers, its offset, counted from `first_source`, and its
// sources. Places differ. Those of the seam's pieces are not written. Ends: a piece has finitely many sources.
kernel void pieces_write(const uint kept, const uint count, const uint with_offsets, const uint first_source,
                         global const uint* before, global const uint* seam_offsets, global const uint* ids,
                         global const uint2* ends, global const uint* offsets, global const uint* sources,
                         global uint2* out_ends, global uint* out_offsets, global uint* out_sources) {
  FOR_EACH(p, kept) {
    const uint earlier = count_up_to(before, count, p), shift = seam_offsets[earlier];
    const uint first = with_offsets ? offsets[p] : p, end = with_offsets ? offsets[p + 1u] : p + 1u;
    out_ends[p + earlier] = (uint2)(ids[ends[p].x], ids[ends[p].y]);
    out_offsets[p + earlier] = first_source + first + shift;
    for (uint i = first; i < end; ++i) out_sources[i + shift] = sources[i];
  }
}

#endif

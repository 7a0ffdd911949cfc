// SPDX-License-Identifier: Apache-2.0
// Regions: the triangles that are joined by unconstrained edges, labelled by parallel union.
//
// label[t] is a triangle of t's region that is not larger: a forest, whose roots have label[t] = t. Roots are
// hooked below smaller roots only, by atomic_cmpxchg, which fails if the word is no root any more. So labels
// fall, no cycle arises, no union is lost, and in the end the one root of a region is its least triangle,
// whatever the order was.
#include "domain/domain.h"

// One work-item per triangle. Writes label[t] = t. Word t has one writer.
kernel void label_start(const uint count, global uint* label) { FOR_EACH(t, count) label[t] = t; }

// Joins the regions of triangles a and b; 0 if it did not come to an end in GCDT_LABEL_STEPS steps. A word that
// is no root stays none, so shortening the way over it (label[a] = label[label[a]]) races with nothing but
// others that shorten it: any of their values is an ancestor.
GCDT_INLINE uint join(volatile global uint* label, uint a, uint b) {
  for (uint step = 0; step < GCDT_LABEL_STEPS; ++step) {
    const uint above_a = label[a], above_b = label[b];
    if (above_a != a) {
      const uint next = label[above_a];
      label[a] = next;
      a = next;
    } else if (above_b != b) {
      const uint next = label[above_b];
      label[b] = next;
      b = next;
    } else if (a == b) {
      return 1u;
    } else {
      const uint high = max(a, b), low = min(a, b);
      const uint old = atomic_cmpxchg(&label[high], high, low);
      if (old == high) return 1u;
      a = old;
      b = low;
    }
  }
  return 0u;
}

// One work-item per triangle.
// Reads neighbours and flags. Writes label by the rules above, and report->pending by atomic_or.
// After this kernel, unless pending, the two triangles of every unconstrained edge are in one tree.
kernel void label_join(const uint count, global const int* neighbours, global const uchar* constrained,
                       volatile global uint* label, volatile global DomainReport* report) {
  FOR_EACH(t, count)
  for (uint k = 0; k < 3; ++k) {
    const int u = neighbours[3u * t + k];
    if (u < 0 || (uint)u > t || ((constrained[t] >> k) & 1u)) continue;
    if (!join(label, t, (uint)u)) atomic_or(&report->pending, 1u);
  }
}

// One work-item per triangle.
// Reads and writes label; a word is replaced by an ancestor only, by its own work-item.
// After this kernel label[t] is t's root, or GCDT_LABEL_STEPS labels nearer to it and report->pending is 1.
kernel void label_jump(const uint count, volatile global uint* label, volatile global DomainReport* report) {
  FOR_EACH(t, count) {
    uint root = label[t], step = 0;
    for (uint above = label[root]; above != root && step < GCDT_LABEL_STEPS; ++step) {
      root = above;
      above = label[root];
    }
    label[t] = root;
    if (label[root] != root) atomic_or(&report->pending, 1u);
  }
}

// One work-item per triangle. Reads label. Writes roots[t]. Word t has one writer.
// After this kernel the scan of `roots` numbers the regions in the order of their least triangles.
kernel void label_roots(const uint count, global const uint* label, global uint* roots) {
  FOR_EACH(t, count) roots[t] = label[t] == t ? 1u : 0u;
}

// One work-item per triangle. Reads numbers, the scan of label_roots. Replaces label[t], which only it reads, by
// the number of the region.
kernel void label_number(const uint count, global const uint* numbers, global uint* label) {
  FOR_EACH(t, count) label[t] = numbers[label[t]];
}

// SPDX-License-Identifier: Apache-2.0
// Regions and domains: what host and kernels share. OpenCL C and C++17.
#ifndef GCDT_DOMAIN_H
#define GCDT_DOMAIN_H

#include "common/shared.h"

// Steps along labels that a work-item makes in one launch at most.
#define GCDT_LABEL_STEPS 1024u

// What one work-group does in one launch at most: rounds of the search from outside; nodes and arcs of each, which
// bound the nodes of the next. With 64 work-items and 200 rounds of loops for a piece looked up among 2^20, that is
// below 8 * (4 * 32 + 256 + 32 + 32 * 200) = 55k rounds of all loops together: Mesa's CPU driver ends the loops
// of a work-item after 65,535 without a word.
#define GCDT_DEPTH_ROUNDS 8u
#define GCDT_DEPTH_NODES 256u
#define GCDT_DEPTH_ARCS 2048u

// Up to so many arcs of a node are one work-item's; up to so many nodes are shared out over a whole launch.
#define GCDT_FEW_ARCS 32u
#define GCDT_FEW_NODES 64u

// Which regions are kept; the numbers are those of GCDT_DOMAIN_... in gcdt.h.
#define GCDT_KEEP_ALL 0u
#define GCDT_KEEP_EVEN_ODD 1u
#define GCDT_KEEP_NONZERO 2u
#define GCDT_KEEP_HOLES 3u
#define GCDT_KEEP_OUTER 4u
#define GCDT_KEEP_OUTER_HOLES 5u

#ifndef __OPENCL_VERSION__
namespace gcdt::device {
#endif

// What the kernels report; zeroed before.
typedef struct DomainReport {
  u32 pending;       // 1: labels are not final
  u32 frontier[3];   // nodes of a round, by round modulo 3
  u32 arcs[3];       // arcs that leave them
  u32 rounds;        // rounds done inside one work-group
  u32 settled;       // regions that were reached
  u32 deepest;       // the largest depth
  u32 open_parity;   // edges beside which even-odd is not as the edge says
  u32 open_winding;  // edges beside which the winding numbers are not as the edge says
  u32 regions;       // found problem by problem
  u32 reserved[3];
} DomainReport;

// Whether a rule keeps the triangles of a region. `hole`: a hole seed lies in it.
GCDT_INLINE u32 domain_keeps(u32 rule, u32 depth, i32 winding, u32 hole) {
  if (rule == GCDT_KEEP_EVEN_ODD) return (u32)winding & 1u;
  if (rule == GCDT_KEEP_NONZERO) return winding != 0 ? 1u : 0u;
  const u32 inside = depth != 0u ? 1u : 0u;
  if (rule == GCDT_KEEP_HOLES) return 1u - hole;
  if (rule == GCDT_KEEP_OUTER) return inside;
  if (rule == GCDT_KEEP_OUTER_HOLES) return inside & (1u - hole);
  return 1u;
}

// Where the words by node of a problem of many begin, if its triangles begin at `first`. It has at most as many regions
// as triangles; outside is a node, too, and the last node's end has a word.
GCDT_INLINE u32 gcdt_first_node(u32 first, u32 problem) { return first + 2u * problem; }

#ifndef __OPENCL_VERSION__
static_assert(sizeof(DomainReport) == 16 * sizeof(u32), "DomainReport has the same layout on host and device");
}  // namespace gcdt::device
#endif

#endif

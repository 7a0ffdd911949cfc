// SPDX-License-Identifier: Apache-2.0
// The corners of a face. OpenCL C only.
#ifndef GCDT_CORNERS_H
#define GCDT_CORNERS_H

// Corner numbers are 0, 1, 2, cyclic.
static inline uint next_corner(uint k) { return k == 2u ? 0u : k + 1u; }
static inline uint previous_corner(uint k) { return k == 0u ? 2u : k - 1u; }

static inline uint element(uint4 a, uint k) { return k == 0u ? a.x : k == 1u ? a.y : a.z; }

// a with element k replaced.
static inline uint4 with_element(uint4 a, uint k, uint value) {
  return (uint4)(k == 0u ? value : a.x, k == 1u ? value : a.y, k == 2u ? value : a.z, a.w);
}

// (a[k], a[k+1], a[k+2]); w stays. On threads without branches, which nobody could foretell.
static inline uint4 rotate_to(uint4 a, uint k) {
#ifdef GCDT_CONTIGUOUS
  const uint4 second = (uint4)(0u - (uint)(k == 1u)), third = (uint4)(0u - (uint)(k == 2u));
  return select(select(a, a.yzxw, second), a.zxyw, third);
#else
  return k == 0u ? a : k == 1u ? a.yzxw : a.zxyw;
#endif
}

// The corner with the least of three distinct ranks. Without branches, which nobody could foretell.
static inline uint least_corner(uint r0, uint r1, uint r2) {
  return (uint)((r1 < r0) & (r1 < r2)) | (uint)((r2 < r0) & (r2 < r1)) << 1;
}

#endif

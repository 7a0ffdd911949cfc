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

// (a[k], a[k+1], a[k+2]); w stays.
static inline uint4 rotate_to(uint4 a, uint k) { return k == 0u ? a : k == 1u ? a.yzxw : a.zxyw; }

// The corner with the least of three distinct ranks.
static inline uint least_corner(uint r0, uint r1, uint r2) {
  return r0 < r1 ? (r0 < r2 ? 0u : 2u) : (r1 < r2 ? 1u : 2u);
}

#endif

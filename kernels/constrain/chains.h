// SPDX-License-Identifier: Apache-2.0
// Where chains stand: see constrain.cl. OpenCL C only.
#ifndef GCDT_CHAINS_H
#define GCDT_CHAINS_H

// Where a part of piece c begins in the chains. The scan of both counts has all left ones before the right ones, and
// each piece before c has two places for its ends on each side.
static inline uint left_begin(global const uint* starts, uint part, uint c) { return starts[part] + 2u * c; }
static inline uint right_begin(global const uint* starts, uint capacity, uint pieces, uint part, uint c) {
  return starts[capacity + part] + 2u * (pieces + c);
}

#endif

// SPDX-License-Identifier: Apache-2.0
// Cells into which constraints are put, and what a launch of clean_walk does with the parts (clean.cl). OpenCL C and
// C++17.
#ifndef GCDT_CLEAN_H
#define GCDT_CLEAN_H

// Bits of the number of a cell of the curve into which constraints are put on GPUs. A group counts all cells in local
// memory: 16 KiB of the 32 that every device has.
#define GCDT_CLEAN_CELL_BITS 12u
#define GCDT_CLEAN_CELLS (1u << GCDT_CLEAN_CELL_BITS)

#define GCDT_CLEAN_ALL 0u    // counts the vertices on each; where a walk fails, says so, since it may want fans
#define GCDT_CLEAN_REST 1u   // counts those of the parts that failed, and takes over the others' counts
#define GCDT_CLEAN_WRITE 2u  // writes the vertices of parts that have several, and copies the others

#endif

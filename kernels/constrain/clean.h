// SPDX-License-Identifier: Apache-2.0
// What a launch of clean_walk does with the parts (clean.cl). OpenCL C and C++17.
#ifndef GCDT_CLEAN_H
#define GCDT_CLEAN_H

#define GCDT_CLEAN_ALL 0u    // counts the vertices on each; where a walk fails, says so, since it may want fans
#define GCDT_CLEAN_REST 1u   // counts those of the parts that failed, and takes over the others' counts
#define GCDT_CLEAN_WRITE 2u  // writes the vertices of parts that have several, and copies the others

#endif

// SPDX-License-Identifier: Apache-2.0
// The raster by which triangles near open constraints are found. OpenCL C and C++17.
#ifndef GCDT_PASSAGES_H
#define GCDT_PASSAGES_H

// Its cells are squares of 2^21 grid points a side, 1024 in a row: fewer are beside a constraint than a tile has
// triangles, and a row is 32 words.
#define GCDT_PASSAGE_SHIFT 21
#define GCDT_PASSAGE_ROWS 1024u
#define GCDT_PASSAGE_WORDS (GCDT_PASSAGE_ROWS / 32u)
#define GCDT_PASSAGE_LAST 0x7FFFFFFF

// What is near a constraint that may be replaced by its route is at most two cells of the grid from it, or a little
// more (Walker::is_near).
#define GCDT_PASSAGE_MARGIN 4

// A triangle that is in more rows counts as near without a search: few are.
#define GCDT_PASSAGE_ROWS_SEARCHED 64u

#endif

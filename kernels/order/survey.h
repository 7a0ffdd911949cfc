// SPDX-License-Identifier: Apache-2.0
// What surveying and quantising find of coordinates: columns of tables of maxima, since a maximum does not depend on
// the order of folding. OpenCL C and C++17.
#ifndef GCDT_SURVEY_H
#define GCDT_SURVEY_H

// By a survey: ~min x, max x, ~min y, max y (ordered keys), and behind them
#define GCDT_SURVEY_TRAILING 4  // the complement of the least trailing exponent - GCDT_LEAST_EXPONENT; 0: all are zero
#define GCDT_SURVEY_BAD 5       // the complement of the least coordinate that is not finite; 0: none
#define GCDT_SURVEY_COLUMNS 6u

// By putting them on the grid:
#define GCDT_QUANTISE_MOVE 0     // the largest move (gcdt_move_key)
#define GCDT_QUANTISE_OUTSIDE 1  // the complement of the least coordinate outside the grid; 0: none
#define GCDT_QUANTISE_COLUMNS 2u

// By looking at vertices that rounding made one, words of a problem (given.cl): how many were given elsewhere than the
// one that stands for them; the least of these; the one that stands for it.
#define GCDT_TOGETHER_WORDS 3u

#endif

// SPDX-License-Identifier: Apache-2.0
// What every triangulation inserts a level's vertices by where loops are not contiguous, as one program: a GPU's driver
// takes a tenth of a second for each program of a first call, whatever is in it (bench/NOTES.md).
#include "insert/freeze.cl"
#include "insert/insert.cl"

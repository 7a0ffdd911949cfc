// SPDX-License-Identifier: Apache-2.0
// What the host reads of a tile. OpenCL C and C++17.
#ifndef GCDT_TILES_H
#define GCDT_TILES_H

// The last grid point of an axis.
#define GCDT_TILE_LAST 0x7FFFFFFFu

// Cells of the raster that says where a tile is, along an axis.
#define GCDT_TILE_ROW 256u

// With the k of an edge of the border.
#define GCDT_TILE_CONSTRAINED 4u
#define GCDT_TILE_ON_HULL 8u

// Of so many final triangles that leave the device, the host gets the code of one.
#define GCDT_TILE_STEP 32u

#endif

// SPDX-License-Identifier: Apache-2.0
// What a tile takes from the input.
#pragma once

#include "tiles/tile.hpp"

namespace gcdt::tiles {

/// A tile's vertices: its own by ascending input number, then foreign ones.
struct Taken {
  InputPoints points;  ///< on the grid, as integers
  runtime::Buffer<cl_uint> ids;
  cl_uint own = 0, all = 0;  ///< without and with foreign ones
  // Where devices share out constraints: the tile's, as its vertices, and their places among all of the process.
  runtime::Buffer<cl_uint2> constraints;
  runtime::Buffer<cl_uint> constraint_places;
  cl_uint constraint_count = 0;
  std::uint64_t move_key = 0;  ///< the greatest of its own vertices (gcdt_move_key)
};

/// Of what has these places, the numbers, of which so many at once go to the device; anything above all for a place
/// that is none.
runtime::Buffer<cl_uint> numbers_at(runtime::Runtime& runtime, const runtime::Buffer<cl_uint>& places,
                                    Span<std::uint32_t> numbers, std::size_t at_once);

/// On the device; the whole input goes there chunk by chunk, which keeps what is the tile's. A tile without vertices of
/// its own gets no foreign ones.
Taken take(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile);

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
// The triangles of a tile that are of the whole result, from the tile's run until they are written there.
#pragma once

#include "batch/device_pool.hpp"
#include "tiles/spill.hpp"

namespace gcdt::tiles {

using Triangle = std::array<std::uint32_t, 3>;
using Neighbours = std::array<std::int32_t, 3>;

/// The final triangles, as long as their places in the result are not known: on the device, or spilled to the host.
class FinalTriangles {
 public:
  std::uint32_t count = 0;
  runtime::Buffer<cl_uint> corners;  ///< the tile's vertices
  runtime::Buffer<cl_int> neighbours;
  runtime::Buffer<cl_uchar> constrained;
  runtime::Buffer<cl_uint> ids;     ///< by vertex: input numbers
  runtime::Buffer<cl_int2> points;  ///< by vertex

  bool on_device() const { return corners.allocated(); }
  /// `directory`: see Spill. After an error all is on the device as before.
  void spill(runtime::Runtime& runtime, const std::string& directory);
  bool is_spilled() const { return spilled_ != nullptr; }
  /// Back to a device, any of the pool's.
  void load(runtime::Runtime& runtime);
  /// Gives all memory back; `count` stays.
  void release();

 private:
  std::unique_ptr<Spill> spilled_;
};

/// Where the triangles of a tile go in the result.
struct TilePlaces {
  std::uint32_t first;  ///< the place of the tile's first triangle, be it final or of the seam
  /// Of the seam's triangles among those of the tile, in their order: the codes of their first two vertices.
  std::vector<std::array<std::uint64_t, 2>> keys;
};

/// Writes the final triangles to their places in arrays that begin with the tile's first triangle, on the device that
/// has them. Returns for each triangle of the seam how many final ones come before it.
std::vector<std::uint32_t> write_tile(DevicePool::Lent& lent, FinalTriangles& final, const TilePlaces& places,
                                      Triangle* triangles, Neighbours* neighbours, std::uint8_t* constrained);

}  // namespace gcdt::tiles

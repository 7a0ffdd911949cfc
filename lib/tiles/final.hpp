// SPDX-License-Identifier: Apache-2.0
// The triangles of a tile that are of the whole result, from the tile's run until they are written there.
#pragma once

#include "batch/device_pool.hpp"

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
  void spill(runtime::Runtime& runtime);
  bool is_spilled() const { return !on_device() && spilled_[0].bytes; }
  /// Back to a device, any of the pool's.
  void load(runtime::Runtime& runtime);
  /// Gives all memory back; `count` stays.
  void release();

 private:
  template <class Use>
  void for_arrays(Use&& use);
  template <class T>
  void spill_one(runtime::Runtime& runtime, runtime::Buffer<T>& buffer, std::size_t slot);
  template <class T>
  void load_one(runtime::Runtime& runtime, runtime::Buffer<T>& buffer, std::size_t slot);
  std::array<HostArray, 5> spilled_;
  std::array<std::size_t, 5> counts_{};
};

/// Where the triangles of a tile go in the result.
struct TilePlaces {
  std::uint32_t first;  ///< the place of the tile's first triangle, be it final or of the seam
  /// Of the seam's triangles among those of the tile, in their order: the codes of their first two vertices.
  std::vector<std::array<std::uint64_t, 2>> keys;
};

/// Writes the final triangles to their places in the result's arrays, which begin at place 0, on the device that has
/// them. Returns for each triangle of the seam how many final ones come before it.
std::vector<std::uint32_t> write_tile(DevicePool::Lent& lent, FinalTriangles& final, const TilePlaces& places,
                                      Triangle* triangles, Neighbours* neighbours, std::uint8_t* constrained);

}  // namespace gcdt::tiles

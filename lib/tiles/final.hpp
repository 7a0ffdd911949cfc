// SPDX-License-Identifier: Apache-2.0
// The triangles of a tile that are of the whole result, from the tile's run until they are written there.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "batch/device_pool.hpp"
#include "tiles/final_pieces.hpp"

namespace gcdt::tiles {

using Triangle = std::array<std::uint32_t, 3>;
using Neighbours = std::array<std::int32_t, 3>;

/// Where triangles are, or are to be, in the host's memory.
struct Berth {
  Triangle* triangles = nullptr;
  Neighbours* neighbours = nullptr;
  std::uint8_t* constrained = nullptr;

  Berth from(std::size_t triangle) const {
    return {triangles + triangle, neighbours + triangle, constrained + triangle};
  }
};

/// Where a tile goes that is spilled.
struct SpillTo {
  std::string directory;  ///< of a file (see Spill); empty: to memory
  Berth in_result{};      ///< if it can be there; else to memory of its own
};

/// The final triangles, as long as their places in the result are not known: on the device, or spilled to the host.
class FinalTriangles {
 public:
  std::uint32_t count = 0;
  // Of the tile's triangles; from compact() on of the final ones, which neighbours are numbers of then.
  std::uint32_t triangles = 0;
  runtime::Buffer<cl_uint> corners;  ///< the tile's vertices; input numbers from begin_spill() on
  runtime::Buffer<cl_int> neighbours;
  runtime::Buffer<cl_uchar> constrained;
  runtime::Buffer<cl_uint> before;  ///< how many final ones come before each, and in all; until compact()
  // Until begin_spill().
  runtime::Buffer<cl_uint> ids;     ///< by vertex: input numbers
  runtime::Buffer<cl_int2> points;  ///< by vertex
  /// The pieces along these triangles: they leave the device with them, but are not given back with them.
  FinalPieces pieces;
  /// From begin_spill() on: the code of the first corner of each GCDT_TILE_STEP-th triangle.
  Array<cl_ulong> codes;

  /// Of a tile of so many vertices, at most, while it is spilled.
  static constexpr std::uint64_t bytes_that_leave(std::uint64_t vertices) { return 2 * (12 + 12 + 1) * vertices; }
  bool on_device() const { return corners.allocated(); }
  std::uint64_t device_bytes() const;
  /// Gives back what others than final ones have. A tile that is written soon does without.
  void compact(runtime::Runtime& runtime);

  /// The first step of a spill, on the device's first queue, which is finished afterwards. Returns the second, which
  /// any queue of the device can take, in any thread, while nothing else here is called but on_device().
  std::function<void(runtime::Runtime& runtime)> begin_spill(runtime::Runtime& runtime, const SpillTo& to);
  /// The last step: gives back the device's memory if the second one has come to its end; else all is on the device
  /// yet, and can be spilled again.
  void end_spill();
  /// All steps.
  void spill(runtime::Runtime& runtime, const SpillTo& to);
  /// Whether it has begun and all is on the device yet: it cannot be written from there any more.
  bool spill_failed() const { return on_device() && corners_numbered_; }
  bool is_spilled() const { return !on_device() && spilled_; }
  bool is_in_result() const { return is_spilled() && !spilled_->file && !spilled_->triangles.bytes; }
  /// What has been spilled: in this file, or in memory.
  Spill* file() { return spilled_->file ? &*spilled_->file : nullptr; }
  const Berth& berth() const { return spilled_->berth; }
  /// From the result's arrays to memory of its own.
  void leave_result();
  /// Gives all memory back, but of pieces that have been spilled; `count` stays.
  void release();

 private:
  void take_codes(runtime::Runtime& runtime);

  struct Spilled {
    std::optional<Spill> file;
    HostArray triangles, neighbours, constrained;  ///< of its own
    Berth berth;
    bool done = false;
  };
  std::shared_ptr<Spilled> spilled_;
  bool corners_numbered_ = false;  ///< corners are input numbers
};

/// Where the triangles of a tile go in the result.
struct TilePlaces {
  std::uint32_t first = 0;    ///< the place of the tile's first triangle, be it final or of the seam
  std::uint32_t of_seam = 0;  ///< how many are of the seam
  /// From any thread. Made when they are wanted: those of all tiles together are a third of what the seam takes.
  std::function<SeamKeys()> make_keys;
};

/// Writes the final triangles to their places behind `to`, where the tile's first triangle is to be, by the device that
/// has them. Returns for each triangle of the seam how many final ones come before it. `behind`: what is read besides.
std::vector<std::uint32_t> write_tile(DevicePool::Lent& lent, FinalTriangles& final, const TilePlaces& places,
                                      const Berth& to, const std::vector<runtime::HostRead>& behind);

}  // namespace gcdt::tiles

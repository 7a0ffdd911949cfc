// SPDX-License-Identifier: Apache-2.0
// The pieces of constraints along a tile's final triangles, until they are in the result.
#pragma once

#include <optional>
#include <vector>

#include "batch/device_pool.hpp"
#include "tiles/spill.hpp"

namespace gcdt::tiles {

/// Of what the seam has among a tile's triangles, or pieces, in their order: the codes of their first two vertices.
using SeamKeys = std::vector<std::array<std::uint64_t, 2>>;

/// The seam's pieces that begin in a tile, in Z-order, without those of the border alone.
struct SeamPieces {
  SeamKeys keys;                                 ///< none where the process has all vertices
  Array<Constraint> pieces;                      ///< input numbers
  Array<std::uint32_t> source_offsets, sources;  ///< input numbers; as many offsets as pieces, and one more
};

/// Where the pieces of a tile go, its own and the seam's.
struct PieceBerth {
  Constraint* ends = nullptr;
  std::uint32_t *offsets = nullptr, *sources = nullptr;
  std::uint32_t first_source = 0;  ///< the place in the result of the first source
};

/// Pieces on the host, in Z-order.
struct HostPieces {
  Array<Constraint> ends;                 ///< input numbers
  Array<std::uint32_t> offsets, sources;  ///< input numbers; no offsets: each has one source

  std::uint32_t offset(std::size_t piece) const {
    return offsets.empty() ? static_cast<std::uint32_t>(piece) : offsets[piece];
  }
  Span<std::uint32_t> sources_of(std::size_t piece) const {
    return {sources.data() + offset(piece), std::size_t{offset(piece + 1)} - offset(piece)};
  }
};

/// For each of the seam's pieces that begin in a tile, how many of the tile's come before it, and their sources.
struct PiecesBefore {
  std::vector<std::uint32_t> pieces, sources;
};

/// In Z-order. On the device that has solved the tile, or spilled to the host's memory, or to a file.
class FinalPieces {
 public:
  std::uint32_t count = 0, source_count = 0;
  runtime::Buffer<cl_uint2> ends;    ///< the tile's vertices; input numbers from number_ends() on
  runtime::Buffer<cl_uint> offsets;  ///< none allocated: each has one source
  runtime::Buffer<cl_uint> sources;  ///< input numbers

  std::uint64_t device_bytes() const;
  /// Makes ends input numbers: before they leave the device.
  void number_ends(runtime::Runtime& runtime, const runtime::Buffer<cl_uint>& ids);
  /// Reads them to a file in this directory, or without one to memory; they stay on the device, too, until leave().
  void spill(runtime::Runtime& runtime, const std::string& directory);
  void leave() { ends = {}, offsets = {}, sources = {}; }
  bool is_spilled() const { return spilled_.has_value(); }
  /// What has been spilled, to be taken once. `n` vertices and so many `constraints` are in the input: throws
  /// check_failed if a number is none of these.
  HostPieces take(std::uint64_t n, std::uint64_t constraints);
  /// What is on its way from the device to the result.
  struct OnItsWay {
    runtime::Buffer<cl_uint> before, sources_before, offsets, sources;
    runtime::Buffer<cl_uint2> ends;
    std::vector<runtime::HostRead> reads;  ///< to be made before end_write()
    cl_uint of_seam = 0;
  };
  /// Writes those on the device to their places; those of the seam's are undefined then. `keys`: of the seam's.
  OnItsWay begin_write(runtime::Runtime& runtime, const runtime::Buffer<cl_uint>& ids,
                       const runtime::Buffer<cl_int2>& points, const SeamPieces& seam, const SeamKeys& keys,
                       const PieceBerth& to) const;
  PiecesBefore end_write(runtime::Runtime& runtime, const OnItsWay& written) const;

 private:
  struct Spilled {
    HostPieces in_memory;
    std::optional<Spill> file;
    bool with_offsets = false;
  };
  std::optional<Spilled> spilled_;
};

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
// Regions and domains (kernels/domain/regions.cl, domain.cl; docs/domains.md): labels, depth, winding, removal.
#pragma once

#include <optional>

#include "phases/output.hpp"

namespace gcdt {

/// The regions that select_domain() found. Arrays have one element for each kept triangle.
struct Regions {
  std::uint32_t count = 0;                          ///< regions of the whole hull, numbered by their least triangles
  std::uint32_t deepest = 0;                        ///< the largest depth
  std::uint64_t open_parity = 0, open_winding = 0;  ///< see Statistics
  std::optional<std::size_t> seeds;                 ///< Options::region_seeds that were given, if regions were wanted
  runtime::Buffer<cl_uint> region, depth;
  runtime::Buffer<cl_int> winding, seed;
};

struct SelectedDomain {
  Regions regions;
  OrderedMesh mesh;              ///< the kept triangles in their order; not allocated if the domain is the hull
  runtime::Buffer<cl_int> kept;  ///< by triangle of the hull: its place in `mesh`, or -1
  runtime::Buffer<cl_uint> region_of_hull;  ///< by triangle of the hull
};

/// The direction of each piece: the number of sources that run from its first end to its second, minus the number that
/// run back. `constraints` are pairs of input points.
runtime::Buffer<cl_int> count_turns(runtime::Runtime& runtime, const Vertices& vertices, const Pieces& pieces,
                                    const runtime::Buffer<cl_uint2>& constraints);

/// Labels the regions of `ordered`, which covers the hull and has vertices for corners, and chooses by
/// options.domain. `turns`: count_turns, one a piece. Seeds are located as queries are (locate.hpp).
SelectedDomain select_domain(runtime::Runtime& runtime, Primitives& primitives, const OrderedMesh& ordered,
                             const Vertices& vertices, const Pieces& pieces, const runtime::Buffer<cl_int>& turns,
                             const Options& options);

}  // namespace gcdt

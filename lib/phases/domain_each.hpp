// SPDX-License-Identifier: Apache-2.0
// Regions and domains of many problems, each by one work-item (kernels/domain/domain_each.cl).
#pragma once

#include "phases/domain.hpp"

namespace gcdt {

struct SelectedDomains {
  Regions regions;  ///< numbered problem by problem; of the counts only that of all regions is known
  OrderedMesh
      mesh;  ///< the kept triangles, none if the domain is the hull; neighbours are numbered through all problems
  runtime::Buffer<cl_uint> first_triangle;  ///< the first kept triangle of each problem, and their end
};

/// As select_domain(), without seeds, of a forest in canonical order, whose triangles and pieces begin at
/// `first_triangle` and `first_piece` for each problem.
SelectedDomains select_domains(runtime::Runtime& runtime, Primitives& primitives, const OrderedMesh& ordered,
                               const Vertices& vertices, const Pieces& pieces, const runtime::Buffer<cl_int>& turns,
                               const runtime::Buffer<cl_uint>& first_triangle,
                               const runtime::Buffer<cl_uint>& first_piece, Domain domain);

}  // namespace gcdt

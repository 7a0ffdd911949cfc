// SPDX-License-Identifier: Apache-2.0
// What walks need of each edge that they cross, in one place (kernels/constrain/gates.h).
#pragma once

#include "mesh/phase.hpp"

namespace gcdt {

/// Made where walks will cross more edges than there are (Plan::crossings_gated), and valid until the mesh changes.
/// Never beside fans: each has the room that the other takes (solve/memory.cpp).
struct Gates {
  runtime::Buffer<cl_int4> at;  ///< by side code
  bool made = false;
};

/// Gates that are not made; kernels get their buffer all the same.
Gates no_gates(runtime::Runtime& runtime);
/// Whether so many crossed edges pay for them.
bool pays_for_gates(const Plan& plan, const Mesh& mesh, std::uint64_t crossings);
/// Makes them, if they are not made: 96 bytes a vertex.
void make_gates(runtime::Runtime& runtime, const Vertices& vertices, const Mesh& mesh, Gates& gates);

}  // namespace gcdt

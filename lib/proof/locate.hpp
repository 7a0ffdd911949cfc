// SPDX-License-Identifier: Apache-2.0
// Points in the rebuilt mesh, for the proof of domains: a sweep.
#pragma once

#include "proof/complete.hpp"

namespace gcdt::proof {

/// For each of the places the least triangle that holds it, border included; `none` outside of the mesh.
/// O((n + s) log n); `steps` grows by the edges and triangles that are looked at, once for equal places.
std::vector<std::uint32_t> least_triangles(const Sites& sites, const Completion& mesh,
                                           const std::vector<Vertex>& places, std::uint64_t& steps);

}  // namespace gcdt::proof

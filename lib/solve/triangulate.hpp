// SPDX-License-Identifier: Apache-2.0
// The paper on one screen: order, insert, constrain, flip, then output, check and domain.
#pragma once

#include "phases/triangulation.hpp"

namespace gcdt {

/// Triangulates one problem on one device, and refines the triangles of the domain if `wanted` is not null. Throws
/// Error; see gcdt_triangulate.
DeviceTriangulation triangulate(runtime::Runtime& runtime, Primitives& primitives, const InputSource& source,
                                const Options& options, const Refinement* wanted = nullptr);

}  // namespace gcdt

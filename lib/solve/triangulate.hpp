// SPDX-License-Identifier: Apache-2.0
// The paper on one screen: order, insert, constrain, flip, then output, check and domain; refine.
#pragma once

#include "phases/triangulation.hpp"

namespace gcdt {

/// Triangulates one problem on one device, and refines it if that is wanted. Throws Error; see gcdt_triangulate.
DeviceTriangulation triangulate(runtime::Runtime& runtime, Primitives& primitives, const InputSource& source,
                                const Options& options);

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// Refinement of a result that is there.
#pragma once

#include "phases/triangulation.hpp"

namespace gcdt {

/// What triangulate() would have made with options.refine, of what `made` was made of. Of `options` refine, check,
/// canonical and progress are read. `made` stays as it is, whatever happens, and shares nothing with what is returned.
/// Throws invalid_argument as check_refinement() does, and if `made` was adopted or refined.
DeviceTriangulation refine_result(runtime::Runtime& runtime, Primitives& primitives, const DeviceTriangulation& made,
                                  const Options& options);

}  // namespace gcdt

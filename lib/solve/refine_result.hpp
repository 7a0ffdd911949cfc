// SPDX-License-Identifier: Apache-2.0
// Refinement of a result that is there.
#pragma once

#include "phases/triangulation.hpp"

namespace gcdt {

/// What triangulate() would have made with options.refine, of what `made` was made of. One that was refined is refined
/// further: its vertices stay. Of one that was adopted the domain is what it covers, and its edges may be flipped but
/// for constraints. Of `options` refine, check, canonical and progress are read. `made` stays as it is, whatever
/// happens, and shares nothing with what is returned. Throws invalid_argument as check_refinement() does.
DeviceTriangulation refine_result(runtime::Runtime& runtime, Primitives& primitives, const DeviceTriangulation& made,
                                  const Options& options);

}  // namespace gcdt

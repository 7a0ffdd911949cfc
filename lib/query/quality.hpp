// SPDX-License-Identifier: Apache-2.0
// Areas and angles of a mesh, measured exactly on the device.
#pragma once

#include "phases/output.hpp"
#include "query/quality.h"

namespace gcdt {

/// Of all triangles of `mesh`, whose corners are input numbers; joined on the host from at most 64 rows. Blocks.
device::Quality measure_quality(runtime::Runtime& runtime, const Vertices& vertices, const OrderedMesh& mesh);

/// The angle whose cotangent is dot / area, in degrees.
double degrees(std::int64_t dot, std::uint64_t area);

}  // namespace gcdt

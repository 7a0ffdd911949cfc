// SPDX-License-Identifier: Apache-2.0
// Phases of few vertices on CPUs, launched one behind the other: there a wait of the host takes as long as a kernel,
// since the driver's threads and the host's sleep meanwhile. The device's clock then tells phases apart
// (LaunchTimes).
#pragma once

#include "solve/run.hpp"

namespace gcdt {

/// Whether order() and insert() may be launched at once.
bool may_begin_at_once(const Run& run, std::uint32_t inputs);
/// Launches order and insertion, as if all inputs were distinct; without constraints all that follows, too. Waits, and
/// returns what order() would. If some inputs are not distinct, only order has been done. Throws as order().
OrderResult begin_at_once(Run& run, InputPoints points);

/// Whether what follows the last flip may be launched at once, or has been.
bool may_finish_at_once(const Run& run);
/// Output, check and numbers. Throws as check().
void finish_at_once(Run& run);

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// Copies the problems of a run from the caller's arrays to the device, one after the other.
#pragma once

#include "batch/problems.hpp"
#include "device/upload.hpp"

namespace gcdt {

/// Where each problem's vertices and constraints will be on the device.
ProblemRanges ranges_of(const BatchInput& batch, const std::vector<std::uint32_t>& numbers);

/// Copies them there, and numbers the ends of constraints through all vertices of the run. Throws InvalidProblems if a
/// constraint has an end that is no vertex.
DeviceInput gather(runtime::Runtime& runtime, const BatchInput& batch, const std::vector<std::uint32_t>& numbers,
                   const ProblemRanges& ranges, runtime::TransferChunks& chunks);

}  // namespace gcdt

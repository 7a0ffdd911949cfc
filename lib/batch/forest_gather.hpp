// SPDX-License-Identifier: Apache-2.0
// The problems of a run one after the other, from the caller's arrays to the device.
#pragma once

#include "batch/forest.hpp"

namespace gcdt {

/// Where each problem's vertices and constraints will be.
ProblemRanges ranges_of(const BatchInput& batch, const std::vector<std::uint32_t>& numbers);

/// Takes them there; ends of constraints count through the run. Throws InvalidProblems if any has an end that is no
/// vertex.
DeviceInput gather(runtime::Runtime& runtime, const BatchInput& batch, const std::vector<std::uint32_t>& numbers,
                   const ProblemRanges& ranges, runtime::UploadChunks& chunks);

}  // namespace gcdt

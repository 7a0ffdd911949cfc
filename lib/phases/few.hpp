// SPDX-License-Identifier: Apache-2.0
// What is few vertices.
#pragma once

#include "device/runtime.hpp"

namespace gcdt {

/// Whether one work-item is to order, put out and check so many vertices by itself (kernels/programs/few.cl).
inline bool are_few(const runtime::Runtime& runtime, std::uint32_t n) {
  return runtime.contiguous() && n <= runtime.tuning().few_vertices;
}

}  // namespace gcdt

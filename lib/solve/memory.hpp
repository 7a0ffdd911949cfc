// SPDX-License-Identifier: Apache-2.0
// How much device memory a run needs.
#pragma once

#include <cstdint>

namespace gcdt {

/// See gcdt_required_bytes.
std::uint64_t device_bytes_needed(std::uint64_t n, std::uint64_t m, std::uint64_t crossed);

/// See gcdt_required_bytes_refined.
std::uint64_t refined_bytes_needed(std::uint64_t n, std::uint64_t m, std::uint64_t crossed, std::uint64_t added);

}  // namespace gcdt

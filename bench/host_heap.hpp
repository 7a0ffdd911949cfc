// SPDX-License-Identifier: Apache-2.0
// What this program, with the library in it, has of the host's heap: not what drivers have, so neither device memory of
// a CPU nor the compiler of kernels.
#pragma once

#include <cstdint>

namespace gcdt::bench {

/// Bytes in use now.
std::int64_t heap_in_use();
/// The most that were in use since the last call of it, which begins anew.
std::int64_t take_heap_peak();
/// Whether they are counted on this platform; else both are 0.
bool counts_heap();

}  // namespace gcdt::bench

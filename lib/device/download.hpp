// SPDX-License-Identifier: Apache-2.0
// Reads from a device through chunks of host memory.
#pragma once

#include "device/transfer_chunks.hpp"

namespace gcdt::runtime {

/// Makes the reads, of which `threads` threads, the caller's included, copy from the chunks, which must be pinned. When
/// it returns, or throws, nothing is written to the host's memory any more but to the chunks. Other threads can use the
/// context meanwhile: NVIDIA's driver has one lock for each, and a thread holds it as long as it waits in a blocking
/// read; so reads are queued, to memory of the driver's own, since others block all the same, and Runtime::wait asks
/// whether they are done.
void read_through(TransferChunks& chunks, unsigned threads, const std::vector<HostRead>& reads);

}  // namespace gcdt::runtime

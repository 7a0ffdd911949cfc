// SPDX-License-Identifier: Apache-2.0
// The handles of pools and batches.
#pragma once

#include <gcdt/gcdt_pool.h>

#include "api/state.hpp"
#include "batch/device_pool.hpp"

struct gcdt_pool {
  std::unique_ptr<gcdt::DevicePool> devices;
  std::atomic_flag in_call = ATOMIC_FLAG_INIT;
};

struct gcdt_batch {
  gcdt::PoolResult made;
  gcdt_batch_statistics statistics = {};
};

namespace gcdt::api {

constexpr std::uint64_t most_problems = std::uint64_t{1} << 30;

/// Makes a pool of the members, whatever the options say of devices.
void make_pool(std::vector<DevicePool::Member> members, const gcdt_pool_options& options, gcdt_pool** pool);

/// See gcdt_batch_copy.
void copy_batch(const gcdt_batch& batch, std::int32_t array, void* destination, std::uint64_t capacity,
                std::uint64_t* offsets);

/// `options` may be null.
gcdt_pool_options read_pool_options(const gcdt_pool_options* options);

}  // namespace gcdt::api

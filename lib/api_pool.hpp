// SPDX-License-Identifier: Apache-2.0
// The handles of pools and batches.
#pragma once

#include <gcdt/gcdt_pool.h>

#include "api.hpp"
#include "device_pool.hpp"

struct gcdt_pool {
  std::unique_ptr<gcdt::DevicePool> devices;
  std::atomic_flag in_call = ATOMIC_FLAG_INIT;
};

struct gcdt_batch {
  gcdt::PoolResult made;
  gcdt_batch_statistics statistics = {};
};

namespace gcdt::api {

/// Makes a pool of the members, whatever the options say of devices.
void make_pool(std::vector<DevicePool::Member> members, const gcdt_pool_options& options, gcdt_pool** pool);

}  // namespace gcdt::api

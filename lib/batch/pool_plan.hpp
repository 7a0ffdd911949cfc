// SPDX-License-Identifier: Apache-2.0
// How a pool uses its devices: every choice that depends on what they are, made in one place before a batch is shared
// out (schedule.hpp). No result depends on it.
#pragma once

#include <string>
#include <vector>

#include "device/runtime.hpp"

namespace gcdt {

/// What the plan knows of a device of a pool.
struct PooledDevice {
  DeviceKind kind = DeviceKind::accelerator;
  std::uint64_t memory_bytes = 0;
  std::uint32_t compute_units = 1;
  bool given_context = false;  ///< the context is the application's
  bool lost = false;           ///< the device was taken out of the pool
  Tuning tuning;
};

/// How a pool uses one device. A pool makes its workers and contexts once, by a plan in which no device is lost, and
/// plans each batch anew.
struct DevicePlan {
  std::uint32_t workers = 1;          ///< runs at once, each with a queue, memory and a thread of its own
  bool shares_context = false;        ///< the workers have one context, and its programs
  bool polls = false;                 ///< they ask whether commands have ended, since a wait would hold the others up
  std::uint32_t rounds_per_read = 0;  ///< rounds of insertion and of flips between two blocking reads
  std::uint32_t cores_left = 0;       ///< compute units that a CPU leaves to the threads that feed GPUs
  std::uint64_t capacity = 0;         ///< bytes that one problem may need
  std::uint64_t job_bytes = 0;        ///< bytes that a job of several problems may need: the workers share the memory
  std::uint64_t job_weight = 0;       ///< the greatest weight of a job of several problems (Schedule)
  double job_overhead = 0;            ///< milliseconds that every job takes, whatever it holds
  bool beside_gpus = false;           ///< the device is no GPU, and the pool has one that is not lost
  bool warms_up = false;              ///< the workers launch all kernels once before they take part (warmup.hpp)

  /// In words, for the log, the trace and --stats.
  std::string text() const;
};

/// The plan of each device.
std::vector<DevicePlan> plan_pool(const std::vector<PooledDevice>& devices);

}  // namespace gcdt

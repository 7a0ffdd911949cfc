// SPDX-License-Identifier: Apache-2.0
// Batches on pools for tests: what problems have alone, devices in halves, and devices that fail.
#pragma once

#include <doctest/doctest.h>

#include <atomic>

#include "batch/device_pool.hpp"
#include "batch_cases.hpp"
#include "opencl_app.hpp"

#include <gcdt/gcdt_pool.hpp>

namespace gcdt::test {

Batch batch_of(const std::vector<Workload>& problems);

/// What problems have alone: a mesh or an error.
struct Singles {
  std::vector<Triangulation> meshes;
  std::vector<std::string> errors;

  explicit Singles(const std::vector<Workload>& problems, const Options& options = {});

  void check(const BatchResult& result) const;
  void check(const PoolResult& result) const;
};

/// Two halves of PoCL's CPU. A device that cannot be divided is taken twice.
std::vector<cl::CommandQueue> half_devices();

/// Of a device that works.
runtime::CallHook healthy();

/// Fails the k-th OpenCL call of a device, and, as a lost one would, all that follow if `for_good`.
runtime::CallHook failing(std::shared_ptr<std::atomic<std::uint64_t>> calls, std::uint64_t k, bool for_good,
                          cl_int code);

/// Works, but launches nothing, for half a second at most, before another device has made its k-th call: however they
/// are scheduled, that one gets work enough to reach the call that fails.
runtime::CallHook behind(std::shared_ptr<std::atomic<std::uint64_t>> calls, std::uint64_t k);

/// How a batch on a pool went.
struct Outcome {
  bool right = false;    ///< every byte
  bool refused = false;  ///< some problem has an error, all others are right
  std::string message;   ///< of the call, if it failed
};

Outcome outcome_of(DevicePool& pool, const RaggedBatch& batch, const std::vector<Triangulation>& expected,
                   const Options& options = {});

/// Every `1 + calls / samples`-th OpenCL call of a device fails, by turns once and for good, with the codes by turns,
/// and another device does its work: no byte changes, and who works is not lost.
void check_failing_calls(const std::vector<Workload>& problems, const Options& options, std::uint64_t samples,
                         const std::vector<cl_int>& codes, std::uint32_t most_workers);

/// Without errors of their own.
std::vector<Workload> valid_problems();

}  // namespace gcdt::test

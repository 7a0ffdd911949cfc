// SPDX-License-Identifier: Apache-2.0
#include "batch/pool_plan.hpp"

#include <algorithm>

namespace gcdt {

namespace {

// A CPU has one beside GPUs, whose threads want its cores, and in the application's context, which has one way of
// waiting.
std::uint32_t workers_of(const PooledDevice& device, bool with_gpus) {
  if (device.kind == DeviceKind::gpu) return Tuning::gpu_workers;
  return device.kind == DeviceKind::threads && device.compute_units > 1 && !device.given_context && !with_gpus
             ? Tuning::cpu_workers
             : 1;
}

}  // namespace

std::vector<DevicePlan> plan_pool(const std::vector<PooledDevice>& devices) {
  std::vector<DevicePlan> plans;
  std::uint32_t cores = 0;  // for the threads that feed GPUs
  bool gpus = false;
  const bool with_gpus =
      std::any_of(devices.begin(), devices.end(), [](const PooledDevice& d) { return d.kind == DeviceKind::gpu; });
  for (const PooledDevice& device : devices) {
    const Tuning& tuning = device.tuning;
    const bool gpu = device.kind == DeviceKind::gpu;
    DevicePlan plan;
    plan.workers = std::max<std::uint32_t>(1, tuning.workers.value_or(workers_of(device, with_gpus)));
    const bool threads = device.kind == DeviceKind::threads;
    plan.shares_context = plan.workers > 1 && (device.given_context || tuning.shares_context.value_or(gpu || threads));
    plan.polls = plan.shares_context && (gpu || device.given_context || tuning.shares_context.has_value());
    plan.rounds_per_read = std::max(tuning.rounds_per_read, gpu ? Tuning::gpu_rounds_per_read : 0);
    // Not all of the memory, because others use the device as well, and because the need of a run is an estimate.
    plan.capacity = device.memory_bytes / 4 * 3;
    plan.job_bytes = plan.capacity / plan.workers;
    plan.job_weight = gpu ? Tuning::gpu_weight : Tuning::cpu_weight;
    plan.job_overhead = tuning.job_overhead.value_or(gpu ? Tuning::gpu_overhead : 0);
    if (gpu) cores += Tuning::cores_per_gpu_worker * plan.workers;
    gpus = gpus || (gpu && !device.lost);
    plans.push_back(plan);
  }
  for (std::size_t i = 0; i < devices.size(); ++i) {
    plans[i].beside_gpus = gpus && devices[i].kind != DeviceKind::gpu;
    plans[i].warms_up = devices[i].tuning.warms_up.value_or(plans[i].beside_gpus);
    if (is_cpu(devices[i].kind) && !devices[i].given_context) plans[i].cores_left = cores;
  }
  return plans;
}

std::string DevicePlan::text() const {
  std::string all = std::to_string(workers) + (workers == 1 ? " worker" : " workers");
  if (workers > 1) all += shares_context ? " in one context" : " with a context each";
  if (polls) all += ", which poll";
  all += "; jobs of weight " + std::to_string(job_weight) + " and " + std::to_string(job_bytes) + " bytes at most";
  all += "; " + std::to_string(rounds_per_read) + " rounds between reads";
  if (beside_gpus) all += "; beside GPUs";
  if (cores_left > 0) all += "; " + std::to_string(cores_left) + " compute units left to the threads that feed GPUs";
  return all + (warms_up ? "; warms up" : "");
}

}  // namespace gcdt

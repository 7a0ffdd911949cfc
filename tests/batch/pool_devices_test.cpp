// SPDX-License-Identifier: Apache-2.0
// The corpus as one batch on several devices, of which each does its part: the bytes that problems have alone.
#include <doctest/doctest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "device_list.hpp"
#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

// Before any test lists devices.
const std::vector<cl::Device> all_of_them = every_device();

std::vector<Workload> mixed_problems() {
  std::vector<Workload> all = corpus({"ok", "crossing", "invalid"});
  for (const Workload& problem : generated_problems()) all.push_back(problem);
  for (const Workload& problem : smallest_problems()) all.push_back(problem);
  return all;
}

/// Holds all devices of a pool but one back until that one has made a job: a fast device would be done with the batch
/// before a slow one has compiled its kernels.
class Turn {
 public:
  void give(std::size_t device) {
    const std::lock_guard<std::mutex> lock(mutex_);
    holder_ = device, over_ = false;
  }
  void end() {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
    changed_.notify_all();
  }
  runtime::CallHook hook_of(std::size_t device) {
    runtime::CallHook hook;
    hook.tuning.warms_up = false;
    hook.before = [this, device](const char* call, const char*) {
      if (std::string(call) == "clEnqueueNDRangeKernel") launch(device);
      return CL_SUCCESS;
    };
    return hook;
  }

 private:
  // If the holder never made a job the wait would end all the same, and the holder be found to have done nothing.
  void launch(std::size_t device) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, std::chrono::minutes(5), [&] { return over_ || device == holder_; });
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t holder_ = 0;
  bool over_ = true;
};

/// Every device in turn makes the first job of a pool's first batch, in which nobody takes all that there is, as no
/// throughputs are known; then all do what they can.
void check_each_takes_part(const std::vector<std::pair<cl::Context, cl::Device>>& devices) {
  const std::vector<Workload> problems = mixed_problems();
  const Singles singles(problems);
  const RaggedBatch batch(problems);
  for (std::size_t holder = 0; holder < devices.size(); ++holder) {
    CAPTURE(holder);
    Turn turn;
    std::vector<DevicePool::Member> members;
    for (std::size_t i = 0; i < devices.size(); ++i)
      members.push_back({devices[i].first, devices[i].second, turn.hook_of(i)});
    DevicePool pool(std::move(members), {}, {});
    turn.give(holder);
    Options options;
    options.progress = [&](const char*, double done) {
      if (done > 0) turn.end();  // which nobody else can have done
      return true;
    };
    singles.check(pool.triangulate(batch.view(), options));
    CHECK(pool.report(holder).problems > 0);
    std::uint64_t done = 0;
    for (std::size_t i = 0; i < pool.size(); ++i) {
      CHECK(!pool.report(i).lost);
      done += pool.report(i).problems;
    }
    CHECK(done == problems.size());
  }
}

}  // namespace

TEST_CASE("the corpus, generated and smallest problems as one batch: one device") {
  const std::vector<Workload> problems = mixed_problems();
  Pool one(test_device());
  Singles(problems).check(one.triangulate(batch_of(problems)));
}

TEST_CASE("the same on two sub-devices") {
  std::vector<std::pair<cl::Context, cl::Device>> halves;
  for (const cl::CommandQueue& queue : half_devices())
    halves.emplace_back(queue.getInfo<CL_QUEUE_CONTEXT>(), queue.getInfo<CL_QUEUE_DEVICE>());
  REQUIRE(halves.size() == 2);
  check_each_takes_part(halves);
}

// Four GPUs where there are four; else each is taken several times, in contexts of its own.
TEST_CASE("the same on four devices") {
  std::vector<cl::Device> each;
  for (const cl::Device& device : all_of_them)
    if (app_device().getInfo<CL_DEVICE_TYPE>() & device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU)
      each.push_back(device);
  if (each.empty())
    for (const cl::CommandQueue& queue : half_devices()) each.push_back(queue.getInfo<CL_QUEUE_DEVICE>());
  std::vector<std::pair<cl::Context, cl::Device>> four;
  for (std::size_t i = 0; i < 4; ++i) four.emplace_back(cl::Context(each[i % each.size()]), each[i % each.size()]);
  check_each_takes_part(four);
}

TEST_CASE("the same on all devices of all vendors") {
  REQUIRE_MESSAGE(all_of_them.size() >= 2, "this needs a second OpenCL driver (Debian and Ubuntu: mesa-opencl-icd)");
  std::vector<std::pair<cl::Context, cl::Device>> devices;
  for (const cl::Device& device : all_of_them) devices.emplace_back(cl::Context(), device);
  check_each_takes_part(devices);
}

TEST_CASE("a pool of all devices by their name") {
  const std::vector<Workload> problems = smallest_problems();
  Pool all("all");
  CHECK(all.devices().size() == all_of_them.size());
  Singles(problems).check(all.triangulate(batch_of(problems)));
  for (const PoolDevice& device : all.devices()) CHECK(!device.lost);
}

// SPDX-License-Identifier: Apache-2.0
// Pools of devices whose contexts are the application's.
#include "api/pool.hpp"

// Its header last: opencl.hpp chooses the version of OpenCL.
#include <gcdt/gcdt_cl.h>

using namespace gcdt;
using namespace gcdt::api;

int32_t gcdt_cl_pool_create(cl_uint count, const cl_command_queue* queues, const gcdt_pool_options* options,
                            gcdt_pool** pool) {
  return guarded(nullptr, [&] {
    require(pool, "pool is null");
    require(queues || count == 0, "queues is null");
    const gcdt_pool_options given = read_pool_options(options);
    require(!given.devices, "gcdt_pool_options.devices must be null: the queues have devices");
    std::vector<DevicePool::Member> members;
    for (cl_uint i = 0; i < count; ++i) {
      require(queues[i], ("queue " + std::to_string(i) + " is null").c_str());
      const cl::CommandQueue queue(queues[i], true);
      DevicePool::Member member;
      const cl_int code = queue.getInfo(CL_QUEUE_CONTEXT, &member.context);
      if (code != CL_SUCCESS || queue.getInfo(CL_QUEUE_DEVICE, &member.device) != CL_SUCCESS)
        throw Error(Status::device_failed, "queue " + std::to_string(i) + " is no queue", {}, 0, code);
      if (!runtime::usable(member.device))
        throw Error(Status::no_device, "the device of queue " + std::to_string(i) + " has no compiler or no OpenCL 1.2",
                    {i});
      members.push_back(std::move(member));
    }
    make_pool(std::move(members), given, pool);
  });
}

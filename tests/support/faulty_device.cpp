// SPDX-License-Identifier: Apache-2.0
#include "faulty_device.hpp"

namespace gcdt::test {

Solver hooked_solver(const runtime::CallHook& hook, const cl::CommandQueue& queue, const cl::Device& device) {
  auto made = std::make_unique<gcdt_solver>();
  const cl::Context context = queue() ? queue.getInfo<CL_QUEUE_CONTEXT>() : cl::Context();
  made->state = std::make_shared<api::State>(context, device, runtime::Log(), Trace(), hook);
  made->state->their_queue = queue;
  return Solver(made.release());
}

std::unique_ptr<gcdt_pool> hooked_pool(const std::vector<runtime::CallHook>& hooks, runtime::Log log) {
  std::vector<DevicePool::Member> members;
  for (const runtime::CallHook& hook : hooks) members.push_back({cl::Context(), app_device(), hook});
  auto pool = std::make_unique<gcdt_pool>();
  pool->devices = std::make_unique<DevicePool>(std::move(members), std::move(log), Trace());
  return pool;
}

runtime::CallHook editing(const std::vector<TextEdit>& edits) {
  runtime::CallHook hook;
  hook.edit = [edits](std::string& text) {
    for (const TextEdit& edit : edits) edit(text);
  };
  return hook;
}

}  // namespace gcdt::test

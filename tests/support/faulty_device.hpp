// SPDX-License-Identifier: Apache-2.0
// Solvers and pools on devices that compute wrongly or whose calls fail, behind the public interface: only the
// runtime's hook differs from what gcdt_solver_create and gcdt_pool_create make.
#pragma once

#include "api/pool.hpp"
#include "opencl_app.hpp"

namespace gcdt::test {

/// On the application's queue if there is one.
inline Solver hooked_solver(const runtime::CallHook& hook, const cl::CommandQueue& queue = {},
                            const cl::Device& device = app_device()) {
  auto made = std::make_unique<gcdt_solver>();
  const cl::Context context = queue() ? queue.getInfo<CL_QUEUE_CONTEXT>() : cl::Context();
  made->state = std::make_shared<api::State>(context, device, runtime::Log(), Trace(), hook);
  made->state->their_queue = queue;
  return Solver(made.release());
}

/// A pool of PoCL's device, once for each hook.
inline std::unique_ptr<gcdt_pool> hooked_pool(const std::vector<runtime::CallHook>& hooks, runtime::Log log = {}) {
  std::vector<DevicePool::Member> members;
  for (const runtime::CallHook& hook : hooks) members.push_back({cl::Context(), app_device(), hook});
  auto pool = std::make_unique<gcdt_pool>();
  pool->devices = std::make_unique<DevicePool>(std::move(members), std::move(log), Trace());
  return pool;
}

/// Replaces every `from` in the text, and counts in how many texts there was one.
struct TextEdit {
  std::string from, to;
  std::shared_ptr<std::atomic<int>> matched = std::make_shared<std::atomic<int>>(0);

  void operator()(std::string& text) const {
    std::size_t at = text.find(from);
    if (at == std::string::npos) return;
    for (; at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
    ++*matched;
  }
};

inline runtime::CallHook editing(const std::vector<TextEdit>& edits) {
  runtime::CallHook hook;
  hook.edit = [edits](std::string& text) {
    for (const TextEdit& edit : edits) edit(text);
  };
  return hook;
}

}  // namespace gcdt::test

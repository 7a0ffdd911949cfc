// SPDX-License-Identifier: Apache-2.0
// Solvers and pools on devices that compute wrongly or whose calls fail, behind the public interface: only the
// runtime's hook differs from what gcdt_solver_create and gcdt_pool_create make.
#pragma once

#include "api/pool.hpp"
#include "opencl_app.hpp"

namespace gcdt::test {

/// On the application's queue if there is one.
Solver hooked_solver(const runtime::CallHook& hook, const cl::CommandQueue& queue = {},
                     const cl::Device& device = app_device());

/// A pool of PoCL's device, once for each hook.
std::unique_ptr<gcdt_pool> hooked_pool(const std::vector<runtime::CallHook>& hooks, runtime::Log log = {});

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

runtime::CallHook editing(const std::vector<TextEdit>& edits);

}  // namespace gcdt::test

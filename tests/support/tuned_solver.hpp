// SPDX-License-Identifier: Apache-2.0
// A solver on one of the two devices that every test machine has, with other choices than everybody's.
#pragma once

#include <memory>

#include <gcdt/gcdt.hpp>

#include "api/state.hpp"
#include "device_list.hpp"

namespace gcdt::test {

/// On PoCL (`really`: threads), or on llvmpipe (lanes). Throws if it is missing.
inline Solver tuned_solver(DeviceKind really, const Tuning& tuning, Trace trace = {}) {
  runtime::CallHook hook;
  hook.tuning = tuning;
  auto handle = std::make_unique<gcdt_solver>();
  handle->state =
      std::make_shared<api::State>(cl::Context(), device_of(really), runtime::Log(), std::move(trace), hook);
  return Solver(handle.release());
}

/// Vertices up to which the calling thread triangulates by itself on PoCL (Runtime::most_here).
inline std::size_t most_here() {
  return static_cast<std::size_t>(runtime::Runtime(device_of(DeviceKind::threads)).most_here());
}

/// Few vertices go the way of many: work-items share out what else one does.
inline Tuning shared_out() {
  Tuning tuning;
  tuning.one_item_vertices = 0;
  return tuning;
}

}  // namespace gcdt::test

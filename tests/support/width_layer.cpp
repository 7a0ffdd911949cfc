// SPDX-License-Identifier: Apache-2.0
// An OpenCL layer that compares each launch with the first one of the same kernel: of its name, of the options that its
// program was built with, and of the size of its work-groups, by which drivers load code. Whose runtime, context and
// thread a launch is does not matter.
#include "width_layer.hpp"

#include <utility>

#include "named_kernels.hpp"

namespace {

struct State {
  std::map<std::string, size_t> first;  ///< work-items of the first launch
  std::vector<std::string> wider;
};
State& state() {
  static auto* const all = new State;  // for good, as the names
  return *all;
}

std::vector<std::string> wider() {
  const Lock lock(named_kernels().mutex);
  state().first.clear();
  return std::exchange(state().wider, {});
}

}  // namespace

extern "C" gcdt::test::Widths* gcdt_test_widths() {
  static auto* const all = new gcdt::test::Widths;
  all->wider = wider;
  return all;
}

namespace {

cl_int CL_API_CALL enqueue(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                           const size_t* global, const size_t* local, cl_uint waits, const cl_event* events,
                           cl_event* event) {
  if (dimensions == 1 && global && local) {
    const Lock lock(named_kernels().mutex);
    const std::string key = std::to_string(*local) + " " + named_kernels().names[kernel];
    const size_t first = state().first.try_emplace(key, *global).first->second;
    ++gcdt_test_widths()->launches;
    gcdt_test_widths()->narrower += *global < first;
    if (*global > first)
      state().wider.push_back(std::to_string(*global) + " work-items, at first " + std::to_string(first) + ": " + key);
  }
  return next->clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local, waits, events, event);
}

void replace(cl_icd_dispatch& functions) {
  name_kernels(functions);
  functions.clEnqueueNDRangeKernel = enqueue;
}

}  // namespace

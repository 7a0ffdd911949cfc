// SPDX-License-Identifier: Apache-2.0
// What a test and the OpenCL layer beside it (width_layer.cpp) tell each other: which kernels were launched wider than
// they were at first.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "said_by_layer.hpp"

namespace gcdt::test {

struct Widths {
  std::atomic<std::uint64_t> launches{0};
  std::atomic<std::uint64_t> narrower{0};  ///< than the first of the same kernel, options and group size was
  /// A line for each that was wider than the first. It is forgotten then, and so is which were the first.
  std::vector<std::string> (*wider)() = nullptr;
};

/// Those of the layer in the file `layer`, which the loader must have loaded: call it after the first OpenCL call.
inline Widths& widths_of(const std::string& layer) { return said_by_layer<Widths>(layer, "gcdt_test_widths"); }

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
// What a test and the OpenCL layer beside it (guard_layer.cpp) tell each other: what fresh buffers hold, and which
// bytes beside buffers were written.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "said_by_layer.hpp"

namespace gcdt::test {

struct Guards {
  /// What fresh buffers are filled with, and guards are made of.
  std::atomic<unsigned char> poison{0xA5};
  std::atomic<std::uint64_t> buffers{0};  ///< that have been made with guards
  std::atomic<std::uint64_t> looks{0};    ///< at guards of a buffer, once each time
  /// Waits for all queues, looks at the guards of all buffers that there are, and returns what is wrong with those and
  /// was with others that are gone: a line each. It is forgotten then.
  std::vector<std::string> (*check)() = nullptr;
};

/// Those of the layer in the file `layer`, which the loader must have loaded: call it after the first OpenCL call.
inline Guards& guards_of(const std::string& layer) { return said_by_layer<Guards>(layer, "gcdt_test_guards"); }

}  // namespace gcdt::test

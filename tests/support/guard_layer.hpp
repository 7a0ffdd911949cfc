// SPDX-License-Identifier: Apache-2.0
// What a test and the OpenCL layer beside it (guard_layer.cpp) tell each other: what fresh buffers hold, and which
// bytes beside buffers were written.
#pragma once

#include <dlfcn.h>

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

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
inline Guards& guards_of(const std::string& layer) {
  void* const library = dlopen(layer.c_str(), RTLD_NOW | RTLD_NOLOAD);
  if (!library) throw std::runtime_error("the OpenCL loader has not loaded " + layer + " (OPENCL_LAYERS)");
  const auto guards = reinterpret_cast<Guards* (*)()>(dlsym(library, "gcdt_test_guards"));
  if (!guards) throw std::runtime_error(layer + " is another layer");
  return *guards();
}

}  // namespace gcdt::test

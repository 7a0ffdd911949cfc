// SPDX-License-Identifier: Apache-2.0
// What a test and an OpenCL layer beside it tell each other.
#pragma once

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace gcdt::test {

/// What the layer in the file `layer` returns from its function `name`, which takes nothing. The loader must have
/// loaded the layer: call it after the first OpenCL call.
template <class T>
T& said_by_layer(const std::string& layer, const char* name) {
  void* const library = dlopen(layer.c_str(), RTLD_NOW | RTLD_NOLOAD);
  if (!library) throw std::runtime_error("the OpenCL loader has not loaded " + layer + " (OPENCL_LAYERS)");
  const auto said = reinterpret_cast<T* (*)()>(dlsym(library, name));
  if (!said) throw std::runtime_error(layer + " is another layer");
  return *said();
}

}  // namespace gcdt::test

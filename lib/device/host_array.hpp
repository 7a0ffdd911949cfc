// SPDX-License-Identifier: Apache-2.0
// Large arrays on the host that are written once.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <gcdt/array.hpp>
#include <memory>

namespace gcdt {

/// Gives back the memory of a vector: `values = {}` keeps it.
template <class Vector>
void forget(Vector& values) {
  Vector().swap(values);
}

/// Bytes, not initialised, of elements of any type.
struct HostArray {
  struct Free {
    void operator()(unsigned char* memory) const { std::free(memory); }
  };
  std::unique_ptr<unsigned char[], Free> bytes;
  std::size_t size = 0;

  /// Throws std::bad_alloc.
  template <class T>
  T* make(std::size_t count) {
    size = count * sizeof(T);
    bytes.reset();
    bytes.reset(static_cast<unsigned char*>(detail::take_memory(size)));
    return reinterpret_cast<T*>(bytes.get());
  }

  /// Room for so many, contents undefined: the same memory if it is large enough.
  template <class T>
  T* reuse(std::size_t count) {
    return bytes && count * sizeof(T) <= size ? reinterpret_cast<T*>(bytes.get()) : make<T>(count);
  }
};

}  // namespace gcdt

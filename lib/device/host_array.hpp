// SPDX-License-Identifier: Apache-2.0
// Large arrays on the host that are written once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace gcdt {

/// Bytes, not initialised. A large array asks for huge pages: the first write to each page of 4 KiB costs more time
/// than filling it from a device.
struct HostArray {
  struct Free {
    void operator()(unsigned char* memory) const { std::free(memory); }
  };
  std::unique_ptr<unsigned char[], Free> bytes;
  std::size_t size = 0;

  /// Throws std::bad_alloc.
  template <class T>
  T* make(std::size_t count) {
    constexpr std::size_t huge = std::size_t{1} << 21;
    size = count * sizeof(T);
    bytes.reset();
#ifdef __linux__
    if (size >= 2 * huge) {
      void* memory = std::aligned_alloc(huge, (size + huge - 1) / huge * huge);
      if (!memory) throw std::bad_alloc();
      madvise(memory, size, MADV_HUGEPAGE);  // if it is refused, pages are small
      bytes.reset(static_cast<unsigned char*>(memory));
      return reinterpret_cast<T*>(bytes.get());
    }
#endif
    bytes.reset(static_cast<unsigned char*>(std::malloc(std::max<std::size_t>(size, 1))));
    if (!bytes) throw std::bad_alloc();
    return reinterpret_cast<T*>(bytes.get());
  }

  /// Room for so many, contents undefined: the same memory if it is large enough.
  template <class T>
  T* reuse(std::size_t count) {
    return bytes && count * sizeof(T) <= size ? reinterpret_cast<T*>(bytes.get()) : make<T>(count);
  }
};

}  // namespace gcdt

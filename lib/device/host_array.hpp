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

/// Where memory comes from that is not the system's.
class HostSource {
 public:
  virtual ~HostSource() = default;
  /// Null if it has none.
  virtual unsigned char* take(std::size_t bytes) = 0;
  virtual void give_back(unsigned char* memory) noexcept = 0;
};

/// Bytes, not initialised, of elements of any type.
struct HostArray {
  struct Free {
    std::shared_ptr<HostSource> source;  ///< null: the system
    void operator()(unsigned char* memory) const { source ? source->give_back(memory) : std::free(memory); }
  };
  std::unique_ptr<unsigned char[], Free> bytes;
  std::size_t size = 0;
  std::shared_ptr<HostSource> source;  ///< asked before the system; may be null

  /// Throws std::bad_alloc.
  template <class T>
  T* make(std::size_t count) {
    size = count * sizeof(T);
    bytes.reset();
    unsigned char* const taken = source ? source->take(size) : nullptr;
    bytes = taken ? std::unique_ptr<unsigned char[], Free>(taken, Free{source})
                  : std::unique_ptr<unsigned char[], Free>(static_cast<unsigned char*>(detail::take_memory(size)));
    return reinterpret_cast<T*>(bytes.get());
  }

  /// Room for so many, contents undefined: the same memory if it is large enough.
  template <class T>
  T* reuse(std::size_t count) {
    return bytes && count * sizeof(T) <= size ? reinterpret_cast<T*>(bytes.get()) : make<T>(count);
  }
};

}  // namespace gcdt

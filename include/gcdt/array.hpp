// SPDX-License-Identifier: Apache-2.0
// Vectors for large results: nothing is written to their elements before the results are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace gcdt {
namespace detail {

/// Memory, not initialised. Much of it asks for huge pages: the first write to each page of 4 KiB takes longer than
/// filling it. Throws std::bad_alloc. To be given back by std::free.
inline void* take_memory(std::size_t bytes) {
  void* memory = nullptr;
#ifdef __linux__
  constexpr std::size_t huge = std::size_t{1} << 21;
  if (bytes >= 2 * huge) {
    if (bytes > std::numeric_limits<std::size_t>::max() - huge) throw std::bad_alloc();
    memory = std::aligned_alloc(huge, (bytes + huge - 1) / huge * huge);
    if (memory) madvise(memory, bytes, MADV_HUGEPAGE);  // if it is refused, pages are small
  } else
#endif
    memory = std::malloc(bytes > 0 ? bytes : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}

}  // namespace detail

/// Elements that are added without a value have none: resize(n) writes nothing.
template <class T>
struct ArrayAllocator {
  static_assert(alignof(T) <= alignof(std::max_align_t), "as malloc aligns");
  using value_type = T;

  ArrayAllocator() = default;
  template <class U>
  ArrayAllocator(const ArrayAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_alloc();
    return static_cast<T*>(detail::take_memory(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t) noexcept { std::free(memory); }
  template <class U>
  void construct(U* element) noexcept {
    ::new (static_cast<void*>(element)) U;
  }
  friend bool operator==(const ArrayAllocator&, const ArrayAllocator&) { return true; }
  friend bool operator!=(const ArrayAllocator&, const ArrayAllocator&) { return false; }
};

/// A vector whose elements are not zeroed before they are written, in huge pages if it is large and the system has
/// them. A std::vector of the same: {array.begin(), array.end()}.
template <class T>
using Array = std::vector<T, ArrayAllocator<T>>;

template <class T>
bool operator==(const Array<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}
template <class T>
bool operator==(const std::vector<T>& a, const Array<T>& b) {
  return b == a;
}
template <class T>
bool operator!=(const Array<T>& a, const std::vector<T>& b) {
  return !(a == b);
}
template <class T>
bool operator!=(const std::vector<T>& a, const Array<T>& b) {
  return !(b == a);
}

}  // namespace gcdt

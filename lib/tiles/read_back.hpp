// SPDX-License-Identifier: Apache-2.0
// Arrays of a device, read to the host.
#pragma once

#include "device/runtime.hpp"

namespace gcdt::tiles {

template <class T, class From>
std::vector<T> read_all_of(runtime::Runtime& runtime, const runtime::Buffer<From>& from, std::size_t count) {
  static_assert(sizeof(T) == sizeof(From), "one is read as the other");
  std::vector<T> values(count);
  runtime.read_bytes(from.memory(), 0, values.data(), count * sizeof(T));
  return values;
}

/// For large ones: not initialised before.
template <class T, class From>
Array<T> read_array(runtime::Runtime& runtime, const runtime::Buffer<From>& from, std::size_t count) {
  Array<T> values(count);
  runtime.read_bytes(from.memory(), 0, values.data(), count * sizeof(T));
  return values;
}

}  // namespace gcdt::tiles

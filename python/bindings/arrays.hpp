// SPDX-License-Identifier: Apache-2.0
// Between numpy's arrays and those of the library, without copies. The package's Python code has made contiguous arrays
// of the right types before (python/gcdt/_arrays.py).
#pragma once

#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <gcdt/gcdt.hpp>

namespace gcdt::python {

namespace nb = nanobind;

/// An array of `width` numbers of a type in each row, read only, in the memory of whoever made it.
template <class T, nb::ssize_t width>
using Rows = nb::ndarray<const T, nb::shape<-1, width>, nb::c_contig, nb::device::cpu>;
template <class T>
using Row = nb::ndarray<const T, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
/// Pairs of float64, float32, int32 or int64.
using Pairs = nb::ndarray<nb::ro, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

inline Points points(const Pairs& pairs) {
  const std::size_t count = pairs.shape(0);
  if (pairs.dtype() == nb::dtype<double>()) return Points::pairs(static_cast<const double*>(pairs.data()), count);
  if (pairs.dtype() == nb::dtype<float>()) return Points::pairs(static_cast<const float*>(pairs.data()), count);
  if (pairs.dtype() == nb::dtype<std::int32_t>())
    return Points::pairs(static_cast<const std::int32_t*>(pairs.data()), count);
  if (pairs.dtype() == nb::dtype<std::int64_t>())
    return Points::pairs(static_cast<const std::int64_t*>(pairs.data()), count);
  throw nb::type_error("coordinates are float64, float32, int32 or int64");
}

template <class T, nb::ssize_t width>
Span<std::array<T, width>> span(const Rows<T, width>& rows) {
  return {reinterpret_cast<const std::array<T, width>*>(rows.data()), rows.shape(0)};
}
template <class T>
Span<T> span(const Row<T>& row) {
  if (row.shape(0) == 0) return {};  // numpy's empty arrays are somewhere, too
  return {row.data(), row.shape(0)};
}

template <class T>
struct NumbersOf {
  using Number = T;
  static constexpr std::size_t width = 1;
};
template <class T, std::size_t n>
struct NumbersOf<std::array<T, n>> {
  using Number = T;
  static constexpr std::size_t width = n;
};

/// A numpy array over elements that `owner` keeps: one row each, or one number.
template <class Element>
nb::object view(const Element* elements, std::size_t count, nb::handle owner) {
  using Number = typename NumbersOf<Element>::Number;
  constexpr std::size_t width = NumbersOf<Element>::width;
  const std::size_t shape[] = {count, width};
  // No array is where there is no memory, and numpy wants some.
  static Number nothing;
  auto* data = count > 0 ? const_cast<Number*>(reinterpret_cast<const Number*>(elements)) : &nothing;
  return nb::cast(nb::ndarray<nb::numpy, Number>(data, width == 1 ? 1 : 2, shape, owner), nb::rv_policy::reference);
}

/// A numpy array that takes the elements over.
template <class Vector>
nb::object handed_over(Vector&& elements) {
  using Kept = std::decay_t<Vector>;
  auto* kept = new Kept(std::forward<Vector>(elements));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<Kept*>(p); });
  return view(kept->data(), kept->size(), owner);
}

}  // namespace gcdt::python

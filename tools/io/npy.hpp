// SPDX-License-Identifier: Apache-2.0
// NumPy's arrays (.npy): the header, and numbers of any of its kinds as doubles or integers.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace gcdt::io {

/// Bytes in their order, whatever holds them.
struct ByteSource {
  std::string name;                                                  ///< in messages
  std::uint64_t size;                                                ///< of all bytes, as far as they say
  std::function<std::uint64_t(void* to, std::uint64_t bytes)> read;  ///< how many came; fewer only at the end
};

/// An array of one or two dimensions, its header read. Every failure is Exit::input and names the source.
class NpyArray {
 public:
  explicit NpyArray(ByteSource source);

  std::uint64_t rows() const { return rows_; }
  std::uint64_t columns() const { return columns_; }
  /// All numbers, row by row, into memory for rows() * columns(); those of 64 bits as the nearest doubles.
  void read(double* to);
  /// All numbers, row by row, which must be integers, as far as the array's kind can tell.
  std::vector<std::int64_t> integers();
  [[noreturn]] void fail(const std::string& what) const;

 private:
  void read_header();
  void read_shape(const std::string& header);
  void read_bytes(void* to, std::uint64_t bytes);
  template <class T>
  void convert(T* to);
  std::uint64_t count() const { return rows_ * columns_; }

  ByteSource source_;
  std::uint64_t rows_ = 0, columns_ = 1;
  char kind_ = 'f';          ///< f, i, u or b
  std::uint64_t bytes_ = 8;  ///< of a number
  bool little_ = true, by_columns_ = false;
};

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
// Binary files, read from front to back into memory that is already there.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "failure.hpp"

namespace gcdt::io {

/// Whether this machine has the least byte of a number first.
inline bool little_endian() {
  const std::uint16_t one = 1;
  unsigned char first;
  std::memcpy(&first, &one, 1);
  return first == 1;
}

/// The number of type T at `bytes`, in either order.
template <class T>
T number_at(const char* bytes, bool little) {
  unsigned char own[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i)
    own[i] = static_cast<unsigned char>(bytes[little == little_endian() ? i : sizeof(T) - 1 - i]);
  T number;
  std::memcpy(&number, own, sizeof(T));
  return number;
}

/// Calls sink(bytes) with the number, least byte first.
template <class T, class Sink>
void put_little(T number, Sink&& sink) {
  char bytes[sizeof(T)], turned[sizeof(T)];
  std::memcpy(bytes, &number, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) turned[i] = bytes[little_endian() ? i : sizeof(T) - 1 - i];
  sink(std::string_view(turned, sizeof(T)));
}

/// Every failure says FILE: at byte N: what, and is Exit::input.
class BinaryFile {
 public:
  explicit BinaryFile(const std::string& path);

  std::uint64_t size() const { return size_; }
  std::uint64_t left() const { return size_ - at_; }
  /// Reads just that many bytes; `what` names them where the file has fewer.
  void read(void* to, std::uint64_t bytes, const char* what);
  /// Goes on reading there.
  void seek(std::uint64_t at);
  /// A number that has its least byte first.
  template <class T>
  T little(const char* what) {
    char bytes[sizeof(T)];
    read(bytes, sizeof(T), what);
    return number_at<T>(bytes, true);
  }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::uint64_t size_ = 0, at_ = 0;
};

}  // namespace gcdt::io

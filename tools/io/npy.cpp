// SPDX-License-Identifier: Apache-2.0
#include "npy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <type_traits>

#include "binary_file.hpp"

namespace gcdt::io {

namespace {

constexpr std::uint64_t largest_header = 1 << 16;
constexpr std::uint64_t turned_block = 1 << 16;  // bytes that are turned at once
/// More than any input has; a product of two such and of 8 bytes stays within 64 bits.
constexpr std::uint64_t most_rows = 1ull << 33, most_columns = 1 << 20;

/// What follows `key` and a colon in a Python dictionary of a header.
std::string value_of(const std::string& header, const char* key) {
  const std::size_t at = header.find(fmt::format("'{}'", key));
  if (at == std::string::npos) return {};
  const std::size_t colon = header.find(':', at);
  const std::size_t first = colon == std::string::npos ? colon : header.find_first_not_of(' ', colon + 1);
  return first == std::string::npos ? std::string() : header.substr(first);
}

}  // namespace

NpyArray::NpyArray(ByteSource source) : source_(std::move(source)) { read_header(); }

void NpyArray::fail(const std::string& what) const {
  throw Failure(Exit::input, fmt::format("{}: {}", source_.name, what));
}

void NpyArray::read_bytes(void* to, std::uint64_t bytes) {
  if (source_.read(to, bytes) != bytes) fail("the array ends before its last number");
}

void NpyArray::read_header() {
  char begin[8];
  if (source_.read(begin, sizeof begin) != sizeof begin || std::string_view(begin, 6) != "\x93NUMPY")
    fail("this is no NumPy array: it does not begin with \\x93NUMPY");
  const int version = begin[6];
  char size[4] = {};
  read_bytes(size, version == 1 ? 2 : 4);
  const std::uint64_t bytes = number_at<std::uint32_t>(size, true);
  if (bytes > largest_header) fail(fmt::format("the header has {} bytes; at most {} are read", bytes, largest_header));
  std::string header(bytes, ' ');
  read_bytes(header.data(), bytes);
  const std::string kind = value_of(header, "descr");
  constexpr std::string_view orders = "<>|=", kinds = "fiub", sizes = "1248";
  if (kind.size() < 5 || kind[0] != '\'' || kind[4] != '\'' || orders.find(kind[1]) == orders.npos ||
      kinds.find(kind[2]) == kinds.npos || sizes.find(kind[3]) == sizes.npos || (kind[2] == 'f' && kind[3] < '4'))
    fail(fmt::format("the array holds {}; numbers such as '<f8', '<f4' or '<i4' are read",
                     kind.empty() ? "no kind of number" : kind.substr(0, std::min<std::size_t>(kind.find(','), 40))));
  little_ = kind[1] == '<' || (kind[1] != '>' && little_endian());
  kind_ = kind[2];
  bytes_ = static_cast<std::uint64_t>(kind[3] - '0');
  by_columns_ = value_of(header, "fortran_order").substr(0, 4) == "True";
  read_shape(value_of(header, "shape"));
  const std::uint64_t before = sizeof begin + (version == 1 ? 2 : 4) + bytes;
  if (source_.size < before || source_.size - before != count() * bytes_)
    fail(fmt::format("{} numbers of {} bytes are announced, but {} bytes follow the header", count(), bytes_,
                     source_.size < before ? 0 : source_.size - before));
}

void NpyArray::read_shape(const std::string& shape) {
  std::vector<std::uint64_t> sides;
  const char *at = shape.data(), *end = at + std::min(shape.find(')'), shape.size());
  if (at == end || *at++ != '(') fail("the header has no shape");
  while (at != end) {
    std::uint64_t side = 0;
    const auto [after, error] = std::from_chars(at, end, side);
    if (error != std::errc()) fail("the shape in the header cannot be read");
    sides.push_back(side);
    for (at = after; at != end && (*at == ',' || *at == ' ');) ++at;
  }
  if (sides.empty() || sides.size() > 2)
    fail(fmt::format("the array has {} dimensions; 1 or 2 are read", sides.size()));
  rows_ = sides[0];
  columns_ = sides.size() == 2 ? sides[1] : 1;
  if (rows_ > most_rows || columns_ > most_columns)
    fail(fmt::format("the array has {} rows and {} columns: too many", rows_, columns_));
}

/// Block by block; `to` has room for all.
template <class T>
void NpyArray::convert(T* to) {
  std::vector<char> bytes(turned_block / bytes_ * bytes_);
  const auto number = [&](const char* at) -> T {
    switch (kind_ == 'f'   ? 'F' + static_cast<int>(bytes_)
            : kind_ == 'i' ? -static_cast<int>(bytes_)
                           : static_cast<int>(bytes_)) {
      case 'F' + 4: return static_cast<T>(number_at<float>(at, little_));
      case 'F' + 8: return static_cast<T>(number_at<double>(at, little_));
      case -1: return static_cast<T>(number_at<std::int8_t>(at, little_));
      case -2: return static_cast<T>(number_at<std::int16_t>(at, little_));
      case -4: return static_cast<T>(number_at<std::int32_t>(at, little_));
      case -8: return static_cast<T>(number_at<std::int64_t>(at, little_));
      case 1: return static_cast<T>(number_at<std::uint8_t>(at, little_));
      case 2: return static_cast<T>(number_at<std::uint16_t>(at, little_));
      case 4: return static_cast<T>(number_at<std::uint32_t>(at, little_));
      default: return static_cast<T>(number_at<std::uint64_t>(at, little_));
    }
  };
  for (std::uint64_t i = 0; i < count();) {
    const std::uint64_t some = std::min<std::uint64_t>(bytes.size() / bytes_, count() - i);
    read_bytes(bytes.data(), some * bytes_);
    for (std::uint64_t k = 0; k < some; ++k, ++i) {
      const std::uint64_t place = by_columns_ ? i % rows_ * columns_ + i / rows_ : i;
      to[place] = number(bytes.data() + k * bytes_);
    }
  }
}

void NpyArray::read(double* to) {
  const bool as_they_are = kind_ == 'f' && bytes_ == 8 && little_ == little_endian() && (!by_columns_ || columns_ == 1);
  if (as_they_are) return read_bytes(to, count() * sizeof(double));
  convert(to);
}

std::vector<std::int64_t> NpyArray::integers() {
  if (kind_ == 'f') fail("the array holds floating-point numbers where integers are due");
  std::vector<std::int64_t> numbers(count());
  convert(numbers.data());
  return numbers;
}

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
// Well-known binary, of ISO and of PostGIS (EWKB): geometries one after the other, or these in hexadecimal digits.
#include <fmt/format.h>

#include <algorithm>

#include "binary_file.hpp"
#include "geometries.hpp"
#include "inputs.hpp"

namespace gcdt::io {

namespace {

int hexadecimal(char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
}

class WkbReader {
 public:
  WkbReader(const std::string& path, Input& input) : path_(path), bytes_(read_file(path)), geometries_(input) {
    // Binary begins with 0 or 1, digits with '0'.
    if (!bytes_.empty() && bytes_[0] == '0') unpack_digits();
  }
  void read() {
    while (at_ < bytes_.size()) geometry(0, any);
    geometries_.finish();
  }

 private:
  enum Type : std::uint32_t {
    any,
    point,
    line,
    polygon,
    points,
    lines,
    polygons,
    collection,
    surface = 15,
    tin,
    triangle
  };

  [[noreturn]] void fail(const std::string& what) const {
    throw Failure(Exit::input, fmt::format("{}: at byte {}: {}{}", path_, digits_ ? 2 * at_ : at_, what,
                                           digits_ ? " (bytes are counted as digits, without blanks)" : ""));
  }
  void unpack_digits() {
    std::string unpacked;
    int high = -1;
    std::size_t number = 0;
    for (const char c : bytes_) {
      ++number;
      if (c == ' ' || (c >= '\t' && c <= '\r')) continue;
      const int digit = hexadecimal(c);
      if (digit < 0) throw Failure(Exit::input, fmt::format("{}: at byte {}: no hexadecimal digit", path_, number - 1));
      if (high >= 0) unpacked += static_cast<char>(16 * high + digit);
      high = high >= 0 ? -1 : digit;
    }
    if (high >= 0) throw Failure(Exit::input, fmt::format("{}: the number of hexadecimal digits is odd", path_));
    bytes_ = std::move(unpacked);
    digits_ = true;
  }

  template <class T>
  T number(const char* what) {
    if (bytes_.size() - at_ < sizeof(T)) fail(fmt::format("the file ends within {}", what));
    at_ += sizeof(T);
    return number_at<T>(bytes_.data() + at_ - sizeof(T), little_);
  }
  /// How many parts follow, of so many bytes at least.
  std::uint32_t count(std::size_t least) {
    const auto parts = number<std::uint32_t>("a count");
    if (parts > (bytes_.size() - at_) / least)
      fail(fmt::format("{} parts of at least {} bytes are announced, but {} bytes follow", parts, least,
                       bytes_.size() - at_));
    return parts;
  }

  void position(bool alone) {
    const auto x = number<double>("a position"), y = number<double>("a position");
    const double z = has_z_ ? number<double>("a position") : std::numeric_limits<double>::quiet_NaN();
    if (has_m_) number<double>("a position");
    if (alone && x != x && y != y) return;  // POINT EMPTY
    if (!(x - x == 0) || !(y - y == 0)) fail("the position before this is not finite");
    if (!geometries_.add(x, y, z)) fail("too many vertices");
  }
  std::size_t position_bytes() const { return (2 + (has_z_ ? 1u : 0u) + (has_m_ ? 1u : 0u)) * sizeof(double); }
  void positions(bool ring) {
    geometries_.begin();
    for (std::uint32_t i = count(position_bytes()); i > 0; --i) position(false);
    ring ? geometries_.end_ring() : geometries_.end_line();
  }

  void geometry(int depth, Type due) {
    constexpr std::size_t smallest = 5;  // bytes of a geometry: the order, the type
    if (depth > deepest_collection) fail("collections are nested too deeply");
    const auto order = number<std::uint8_t>("a geometry");
    if (order > 1) fail(fmt::format("a geometry begins with 0 or 1 for the order of bytes, not {}", order));
    little_ = order == 1;
    const std::uint32_t type = header();
    if (due != any && type != due) fail(fmt::format("a geometry of type {} is due, not {}", std::uint32_t{due}, type));
    const auto parts = [&](Type of) {
      for (std::uint32_t i = count(smallest); i > 0; --i) geometry(depth + 1, of);
    };
    switch (type) {
      case point: return position(true);
      case line: return positions(false);
      case triangle:
      case polygon:
        for (std::uint32_t i = count(sizeof(std::uint32_t)); i > 0; --i) positions(true);
        return geometries_.end_polygon();
      case points: return parts(point);
      case lines: return parts(line);
      case polygons:
      case surface: return parts(polygon);
      case tin: return parts(triangle);
      case collection: return parts(any);
      default: fail(fmt::format("there is no type {}", type));
    }
  }

  /// The type without what is said of dimensions: ISO adds 1000 and 2000, PostGIS sets bits.
  std::uint32_t header() {
    constexpr std::uint32_t z = 0x80000000, m = 0x40000000, srid = 0x20000000;
    const auto word = number<std::uint32_t>("a geometry");
    if (word & srid) number<std::uint32_t>("a geometry");
    const std::uint32_t bare = word & ~(z | m | srid), dimensions = bare / 1000;
    if (dimensions > 3) fail(fmt::format("there is no type {}", bare));
    has_z_ = (word & z) != 0 || dimensions == 1 || dimensions == 3;
    has_m_ = (word & m) != 0 || dimensions >= 2;
    return bare % 1000;
  }

  const std::string& path_;
  std::string bytes_;
  std::size_t at_ = 0;
  bool digits_ = false, little_ = true, has_z_ = false, has_m_ = false;
  Geometries geometries_;
};

}  // namespace

Input read_wkb(const std::string& path) {
  Input input = input_of(path);
  WkbReader(path, input).read();
  return input;
}

}  // namespace gcdt::io

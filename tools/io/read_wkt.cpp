// SPDX-License-Identifier: Apache-2.0
// Well-known text: geometries one after the other, with or without Z, M and an SRID before them.
#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>

#include "geometries.hpp"
#include "inputs.hpp"

namespace gcdt::io {

namespace {

class WktReader {
 public:
  WktReader(const std::string& path, Input& input) : path_(path), text_(read_file(path)), geometries_(input) {}

  void read() {
    if (text_.compare(0, 3, "\xEF\xBB\xBF") == 0) at_ = 3;  // the byte order mark of UTF-8
    for (;;) {
      while (at_ < text_.size() && (blank() || text_[at_] == ';' || text_[at_] == ',' || text_[at_] == '"')) ++at_;
      if (at_ == text_.size()) break;
      geometry(0);
    }
    geometries_.finish();
  }

 private:
  bool blank() const { return text_[at_] == ' ' || (text_[at_] >= '\t' && text_[at_] <= '\r'); }
  char peek() {
    while (at_ < text_.size() && blank()) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(fmt::format("'{}' is due", c));
  }
  /// Letters as capitals; none if there are none here.
  std::string word() {
    std::string word;
    for (char c = peek(); at_ < text_.size(); c = text_[at_]) {
      c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
      if (c < 'A' || c > 'Z') break;
      word += c;
      ++at_;
    }
    return word;
  }
  /// What stands at the place where something else is due, and the line.
  [[noreturn]] void fail(const std::string& what) const {
    const std::size_t at = std::min(at_, text_.size());
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    std::string here;
    for (const char c : text_.substr(at, 20)) {
      if (c == '\n') break;
      here += c >= ' ' && c <= '~' ? c : '?';
    }
    const std::string found = at == text_.size() ? "the end of the file" : fmt::format("\"{}\"", here);
    throw Failure(Exit::input, fmt::format("{}:{}: {}, not {}", path_, line, what, found));
  }

  double number() {
    peek();
    const char *first = text_.data() + at_, *end = text_.data() + text_.size();
    if (first != end && *first == '+') ++first;
    double value = 0;
    const auto [after, error] = fast_float::from_chars(first, end, value);
    if (after == first || error == std::errc::invalid_argument) fail("a number is due");
    if (!(value - value == 0)) fail("a finite number is due");
    at_ = static_cast<std::size_t>(after - text_.data());
    return value;
  }

  void position() {
    const double x = number(), y = number();
    double rest[2] = {};
    int more = 0;
    for (char c = peek(); c != ',' && c != ')'; c = peek()) {
      if (more == 2) fail("',' or ')' is due after four numbers");
      rest[more++] = number();
    }
    const bool height = more > 0 && !measured_;
    if (!(height ? geometries_.add(x, y, rest[0]) : geometries_.add(x, y))) fail("the end is due: too many vertices");
  }

  /// EMPTY, or `each` in parentheses, separated by commas.
  template <class Each>
  void list(Each&& each) {
    const std::size_t before = at_;
    if (word() == "EMPTY") return;
    at_ = before;
    expect('(');
    do each();
    while (take(','));
    expect(')');
  }

  void line() {
    geometries_.begin();
    list([&] { position(); });
    geometries_.end_line();
  }
  void polygon() {
    list([&] {
      geometries_.begin();
      list([&] { position(); });
      geometries_.end_ring();
    });
    geometries_.end_polygon();
  }
  void point() {
    if (take('(')) {
      position();
      expect(')');
    } else {
      const std::size_t before = at_;
      if (word() == "EMPTY") return;
      at_ = before;
      position();
    }
  }

  void geometry(int depth) {
    if (depth > deepest_collection) fail("fewer collections in collections are due");
    const std::size_t begin = at_;
    std::string type = word();
    if (type == "SRID") {
      expect('=');
      number();
      expect(';');
      type = word();
    }
    if (type.empty()) fail("a geometry such as POLYGON is due");
    const std::size_t before = at_;
    std::string dimensions = word();
    if (dimensions != "Z" && dimensions != "M" && dimensions != "ZM") {
      at_ = before;
      dimensions.clear();
      for (const char* end : {"ZM", "Z", "M"})  // POINTZ: none of the types ends in these letters
        if (dimensions.empty() && type.size() > 2 && type.compare(type.size() - std::strlen(end), 2, end) == 0) {
          dimensions = end;
          type.resize(type.size() - dimensions.size());
        }
    }
    measured_ = dimensions == "M";
    if (type == "POINT") return list([&] { position(); });
    if (type == "MULTIPOINT") return list([&] { point(); });
    if (type == "LINESTRING") return line();
    if (type == "MULTILINESTRING") return list([&] { line(); });
    if (type == "POLYGON" || type == "TRIANGLE") return polygon();
    if (type == "MULTIPOLYGON" || type == "TIN" || type == "POLYHEDRALSURFACE") return list([&] { polygon(); });
    if (type == "GEOMETRYCOLLECTION") return list([&] { geometry(depth + 1); });
    at_ = begin;
    fail("POINT, LINESTRING, POLYGON, their MULTI forms, TRIANGLE, TIN or GEOMETRYCOLLECTION is due");
  }

  const std::string& path_;
  const std::string text_;
  std::size_t at_ = 0;
  bool measured_ = false;  ///< third numbers are no heights
  Geometries geometries_;
};

}  // namespace

Input read_wkt(const std::string& path) {
  Input input = input_of(path);
  WktReader(path, input).read();
  return input;
}

}  // namespace gcdt::io

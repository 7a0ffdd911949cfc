// SPDX-License-Identifier: Apache-2.0
// Polygon files (.ply): ascii and both binary kinds. Faces give their edges; edges are constraints.
#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "binary_file.hpp"
#include "inputs.hpp"
#include "surface.hpp"

namespace gcdt::io {

namespace {

/// Kinds of numbers by name: size in bytes, negative if signed, and 4 or 8 with a fraction for f.
struct Kind {
  char kind = 'i';  ///< i, u or f
  std::size_t bytes = 0;
};
Kind kind_named(const std::string& name) {
  struct Row {
    const char *old_name, *name;
    Kind kind;
  };
  constexpr Row rows[] = {{"char", "int8", {'i', 1}},     {"uchar", "uint8", {'u', 1}},   {"short", "int16", {'i', 2}},
                          {"ushort", "uint16", {'u', 2}}, {"int", "int32", {'i', 4}},     {"uint", "uint32", {'u', 4}},
                          {"float", "float32", {'f', 4}}, {"double", "float64", {'f', 8}}};
  for (const Row& row : rows)
    if (name == row.old_name || name == row.name) return row.kind;
  return {};
}

struct Property {
  std::string name;
  Kind kind, count;  ///< count.bytes > 0: a list, whose length is of that kind
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  PlyReader(const std::string& path, Input& input) : path_(path), text_(read_file(path)), input_(input) {}

  void read() {
    header();
    for (const Element& element : elements_) records(element);
    if (!given_) fail("there is no element \"vertex\" with x and y");
    heights_.give(input_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    const auto begin = text_.begin(), at = begin + static_cast<std::ptrdiff_t>(std::min(at_, text_.size()));
    const std::string where =
        in_header_ || ascii_ ? fmt::format(":{}", 1 + std::count(begin, at, '\n')) : fmt::format(": at byte {}", at_);
    throw Failure(Exit::input, fmt::format("{}{}: {}", path_, where, what));
  }

  std::string line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string line = text_.substr(at_, end - at_);
    while (!line.empty() && line.back() == '\r') line.pop_back();
    next_ = std::min(end + 1, text_.size());
    return line;
  }

  void header() {
    bool magic = false, format = false;
    for (;; at_ = next_) {
      if (at_ == text_.size()) fail(magic ? "the header has no end" : "the word ply is missing");
      std::istringstream words(line());
      std::string word;
      words >> word;
      if (!magic && word != "ply") fail("the word ply is missing");
      magic = true;
      if (word == "end_header") break;
      if (word == "format") format = take_format(words);
      if (word == "element") take_element(words);
      if (word == "property") take_property(words);
    }
    if (!format) fail("the header says no format");
    at_ = next_;
    in_header_ = false;
  }
  bool take_format(std::istringstream& words) {
    std::string name;
    words >> name;
    ascii_ = name == "ascii";
    little_ = name == "binary_little_endian";
    if (!ascii_ && !little_ && name != "binary_big_endian")
      fail("the format must be ascii, binary_little_endian or binary_big_endian");
    return true;
  }
  void take_element(std::istringstream& words) {
    Element element;
    std::int64_t count = -1;
    std::string more;
    if (!(words >> element.name >> count) || count < 0 || words >> more) fail("an element has a name and a count");
    element.count = static_cast<std::uint64_t>(count);
    elements_.push_back(element);
  }
  void take_property(std::istringstream& words) {
    Property property;
    std::string kind, count;
    words >> kind;
    if (kind == "list") {
      words >> count >> kind;
      property.count = kind_named(count);
      if (property.count.bytes == 0 || property.count.kind == 'f') fail("the length of a list must be an integer");
    }
    words >> property.name;
    property.kind = kind_named(kind);
    if (property.kind.bytes == 0 || property.name.empty()) fail("a property has a kind such as float, and a name");
    if (elements_.empty()) fail("a property before the first element");
    elements_.back().properties.push_back(property);
  }

  double number(const Kind& kind) {
    if (!ascii_) return binary(kind);
    while (at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] >= '\t' && text_[at_] <= '\r'))) ++at_;
    const char *first = text_.data() + at_, *end = text_.data() + text_.size();
    if (first == end) fail("the file ends before its last number");
    double value = 0;
    const auto [after, error] = fast_float::from_chars(*first == '+' ? first + 1 : first, end, value);
    if (error == std::errc::invalid_argument || (after != end && static_cast<unsigned char>(*after) > ' '))
      fail("a number is due");
    at_ = static_cast<std::size_t>(after - text_.data());
    return value;
  }
  double binary(const Kind& kind) {
    if (text_.size() - at_ < kind.bytes) fail("the file ends before its last number");
    const char* at = text_.data() + at_;
    at_ += kind.bytes;
    if (kind.kind == 'f') return kind.bytes == 4 ? number_at<float>(at, little_) : number_at<double>(at, little_);
    const bool sign = kind.kind == 'i';
    if (kind.bytes == 1) return sign ? number_at<std::int8_t>(at, little_) : number_at<std::uint8_t>(at, little_);
    if (kind.bytes == 2) return sign ? number_at<std::int16_t>(at, little_) : number_at<std::uint16_t>(at, little_);
    return sign ? number_at<std::int32_t>(at, little_) : number_at<std::uint32_t>(at, little_);
  }
  std::uint32_t vertex(double number) const {
    if (!(number >= 0) || number >= static_cast<double>(input_.vertices.size()) ||
        number != static_cast<std::uint32_t>(number))
      fail(fmt::format("there is no vertex {}; there are {}, from 0 on", number, input_.vertices.size()));
    return static_cast<std::uint32_t>(number);
  }

  void records(const Element& element) {
    if (element.properties.empty()) return;  // nothing stands for them, however many there are
    const bool vertices = element.name == "vertex";
    if (vertices) begin_vertices(element);
    for (std::uint64_t i = 0; i < element.count; ++i) record(element, vertices);
  }
  void begin_vertices(const Element& element) {
    const auto has = [&](const char* name) {
      return std::any_of(element.properties.begin(), element.properties.end(),
                         [&](const Property& p) { return p.name == name && p.count.bytes == 0; });
    };
    given_ = has("x") && has("y");
    if (element.count > max_vertices)
      fail(fmt::format("the number of vertices is {}; at most {} are possible", element.count, max_vertices));
  }
  void record(const Element& element, bool vertices) {
    double x = 0, y = 0, z = 0, ends[2] = {-1, -1};
    for (const Property& property : element.properties) {
      if (property.count.bytes > 0) {
        list(property, element.name == "face");
        continue;
      }
      const double value = number(property.kind);
      if (property.name == "x") x = value;
      if (property.name == "y") y = value;
      if (property.name == "z") z = value;
      if (property.name == "vertex1") ends[0] = value;
      if (property.name == "vertex2") ends[1] = value;
    }
    if (element.name == "edge") input_.constraints.push_back({vertex(ends[0]), vertex(ends[1])});
    if (!vertices) return;
    if (!(x - x == 0) || !(y - y == 0)) fail("a coordinate is not finite");
    input_.vertices.push_back({x, y});
    heights_.add(z);
  }
  /// The corners of a face, or a list that is read over.
  void list(const Property& property, bool face) {
    const double length = number(property.count);
    const bool corners = face && (property.name == "vertex_indices" || property.name == "vertex_index");
    if (!(length >= 0) || length > static_cast<double>(text_.size() - at_))
      fail(fmt::format("a list of {} numbers", length));
    corners_.clear();
    for (auto i = static_cast<std::uint64_t>(length); i > 0; --i) {
      const double value = number(property.kind);
      if (corners) corners_.push_back(vertex(value));
    }
    join(corners_, corners_.size() > 2, 0, input_);
  }

  const std::string& path_;
  const std::string text_;
  std::size_t at_ = 0, next_ = 0;
  bool in_header_ = true, ascii_ = true, little_ = true, given_ = false;
  std::vector<Element> elements_;
  std::vector<std::uint32_t> corners_;
  Heights heights_;
  Input& input_;
};

}  // namespace

Input read_ply(const std::string& path) {
  Input input = input_of(path);
  PlyReader(path, input).read();
  return input;
}

}  // namespace gcdt::io

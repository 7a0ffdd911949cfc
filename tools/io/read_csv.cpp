// SPDX-License-Identifier: Apache-2.0
// Points as comma-separated values: a point in each line; further columns of numbers are attributes.
#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "inputs.hpp"

namespace gcdt::io {

namespace {

constexpr std::size_t max_columns = 1002;  // x, y and as many attributes as a .node file may have

std::string_view trimmed(std::string_view field) {
  const auto drop = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!field.empty() && drop(field.front())) field.remove_prefix(1);
  while (!field.empty() && drop(field.back())) field.remove_suffix(1);
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
  return field;
}

std::optional<double> number(std::string_view field) {
  if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = fast_float::from_chars(field.data(), field.data() + field.size(), value);
  if (end != field.data() + field.size() || error == std::errc::invalid_argument) return std::nullopt;
  return value;
}

class CsvReader {
 public:
  CsvReader(const std::string& path, Input& input) : path_(path), text_(read_file(path, longest_word)), input_(input) {}

  void read() {
    std::string_view rest = text_;
    if (rest.substr(0, 3) == "\xEF\xBB\xBF") rest.remove_prefix(3);  // the byte order mark of UTF-8
    while (!rest.empty()) {
      const std::size_t size = std::min(rest.find('\n'), rest.size());
      ++line_;
      row(rest.substr(0, size));
      rest.remove_prefix(std::min(size + 1, rest.size()));
    }
    input_.heights = input_.attribute_count == 1 && (columns_.size() == 3 && names_[left(0)] == "z");
    if (!words_.empty())
      input_.notes.push_back(fmt::format("column {} of {} holds words: it is not used", words_, path_));
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Failure(Exit::input, fmt::format("{}:{}: {}", path_, line_, what));
  }

  void row(std::string_view line) {
    if (trimmed(line).empty() || trimmed(line)[0] == '#') return;
    if (columns_.empty()) separator_ = separator_of(line);
    split(line);
    if (columns_.empty() && !begin()) return;
    if (fields_.size() != names_.size())
      fail(fmt::format("{} columns, but the lines before have {}", fields_.size(), names_.size()));
    if (!chosen_) choose();
    if (input_.vertices.size() == max_vertices) fail("too many vertices");
    input_.vertices.push_back({value(columns_[0]), value(columns_[1])});
    for (std::size_t i = 2; i < columns_.size(); ++i) input_.attributes.push_back(value(columns_[i]));
    for (const double c : input_.vertices.back())
      if (!(c - c == 0)) fail("a coordinate is not finite");
    input_.vertex_lines.append(line_);
  }

  static char separator_of(std::string_view line) {
    for (const char c : {';', '\t', ','})
      if (line.find(c) != line.npos) return c;
    return ' ';
  }

  void split(std::string_view line) {
    fields_.clear();
    line = separator_ == ' ' ? trimmed(line) : line;
    for (bool more = true; more;) {
      std::size_t end = 0;
      for (bool quoted = false; end < line.size() && (quoted || line[end] != separator_); ++end)
        quoted ^= line[end] == '"';
      more = end < line.size();
      fields_.push_back(trimmed(line.substr(0, end)));
      line.remove_prefix(std::min(end + 1, line.size()));
      while (separator_ == ' ' && !line.empty() && line.front() == ' ') line.remove_prefix(1);
      if (fields_.size() > max_columns) fail(fmt::format("more than {} columns", max_columns));
    }
  }

  /// Takes the first line: names, or numbers already. Whether it is a point.
  bool begin() {
    if (fields_.size() < 2) fail("x and y are due, in two columns");
    const bool header = std::none_of(fields_.begin(), fields_.end(), [](auto f) { return number(f).has_value(); });
    for (const std::string_view field : fields_) {
      std::string name(header ? field : std::string_view());
      std::transform(name.begin(), name.end(), name.begin(),
                     [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
      names_.push_back(name);
    }
    columns_ = {0, 1};
    constexpr const char* pairs[][2] = {
        {"x", "y"}, {"lon", "lat"}, {"lng", "lat"}, {"longitude", "latitude"}, {"easting", "northing"}};
    for (const auto& pair : pairs) {
      const auto x = std::find(names_.begin(), names_.end(), pair[0]),
                 y = std::find(names_.begin(), names_.end(), pair[1]);
      if (x == names_.end() || y == names_.end()) continue;
      columns_ = {static_cast<std::size_t>(x - names_.begin()), static_cast<std::size_t>(y - names_.begin())};
      break;
    }
    return !header;
  }

  /// At the first point: the columns that are attributes.
  void choose() {
    chosen_ = true;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (i == columns_[0] || i == columns_[1]) continue;
      if (number(fields_[i]))
        columns_.push_back(i);
      else
        words_ += fmt::format("{}{}", words_.empty() ? "" : ", ", i + 1);
    }
    input_.attribute_count = static_cast<std::uint32_t>(columns_.size() - 2);
  }
  std::size_t left(std::size_t attribute) const { return columns_[2 + attribute]; }

  double value(std::size_t column) const {
    const std::string_view field = fields_[column];
    if (const auto found = number(field)) return *found;
    std::string shown;
    for (const char c : field.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
    fail(fmt::format("column {} must be a number, not \"{}\"", column + 1, shown));
  }

  const std::string& path_;
  const std::string text_;
  Input& input_;
  std::uint64_t line_ = 0;
  char separator_ = ',';
  std::vector<std::string_view> fields_;  ///< of the line
  std::vector<std::string> names_;        ///< of the columns, in lower case; empty ones without a header
  std::vector<std::size_t> columns_;      ///< x, y and attributes
  std::string words_;                     ///< the numbers, from 1, of columns without numbers
  bool chosen_ = false;
};

}  // namespace

Input read_csv(const std::string& path) {
  Input input = input_of(path);
  input.first = 1;
  CsvReader(path, input).read();
  return input;
}

}  // namespace gcdt::io

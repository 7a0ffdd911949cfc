// SPDX-License-Identifier: Apache-2.0
#include "records.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <memory>

namespace gcdt::io {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// A field for a message: short, and printable whatever the bytes are.
std::string printable(std::string_view field) {
  std::string text;
  for (char c : field.substr(0, 40)) text += c >= ' ' && c <= '~' ? c : '?';
  return field.size() > 40 ? text + "..." : text;
}

}  // namespace

std::string shown_name(const std::string& path) { return path == "-" ? "<stdin>" : path; }

std::string read_file(const std::string& path, std::size_t longest) {
  auto close = [](std::FILE* f) {
    if (f != stdin) std::fclose(f);
  };
  std::unique_ptr<std::FILE, decltype(close)> file(path == "-" ? stdin : std::fopen(path.c_str(), "rb"), close);
  if (!file) throw Failure(Exit::input, fmt::format("{}: cannot be opened: {}", path, std::strerror(errno)));
  std::size_t expected = 0;
  if (path != "-" && std::fseek(file.get(), 0, SEEK_END) == 0) {
    const long size = std::ftell(file.get());
    std::rewind(file.get());
    // A directory has an absurd size here, and a pipe none: the loop below grows as it reads.
    if (size > 0 && size < (1l << 40)) expected = static_cast<std::size_t>(size) + 1;
  }
  std::string text;
  for (std::size_t used = 0;;) {
    // The first block is read before there is room for the rest: what is no text shows there.
    constexpr std::size_t first = 1 << 21, next = 1 << 24;
    if (used >= first && expected > text.capacity()) text.reserve(expected);
    text.resize(used + (used < first ? std::min(expected > 0 ? expected : first, first) : next));
    const std::size_t got = std::fread(&text[used], 1, text.size() - used, file.get());
    used += got;
    if (got == 0 || used < text.size()) text.resize(used);
    if (got == 0) break;
    const std::size_t blank = text.size() <= longest ? 0 : text.find_last_of(" \t\r\n");
    if (text.size() > longest && text.size() - (blank == text.npos ? 0 : blank) > longest)
      throw Failure(Exit::input, fmt::format("{}: a word of more than {} bytes", shown_name(path), longest));
  }
  if (std::ferror(file.get()))
    throw Failure(Exit::input, fmt::format("{}: cannot be read: {}", shown_name(path), std::strerror(errno)));
  return text;
}

std::uint64_t LineNumbers::of(std::uint64_t index) const {
  if (index >= count_) return 0;
  auto after =
      std::upper_bound(runs_.begin(), runs_.end(), index, [](auto i, const Run& run) { return i < run.first; });
  const Run& run = *std::prev(after);
  return run.line + (index - run.first);
}

Records::Records(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)) {
  at_ = line_end_ = text_.data();
  end_ = at_ + text_.size();
  if (text_.compare(0, 3, "\xEF\xBB\xBF") == 0) at_ = line_end_ = at_ + 3;  // the byte order mark of UTF-8
}

bool Records::next() {
  const char* start = line_ == 0 ? line_end_ : line_end_ + 1;
  while (start < end_) {
    const char* newline = static_cast<const char*>(std::memchr(start, '\n', static_cast<std::size_t>(end_ - start)));
    at_ = start;
    line_end_ = newline ? newline : end_;
    ++line_;
    if (more()) return true;
    if (at_ < line_end_) note_comment({at_, static_cast<std::size_t>(line_end_ - at_)});
    start = line_end_ + 1;
  }
  at_ = line_end_ = end_;
  return false;
}

bool Records::more() {
  while (at_ < line_end_ && is_blank(*at_)) ++at_;
  return at_ < line_end_ && *at_ != '#';
}

void Records::note_comment(std::string_view comment) {
  constexpr std::string_view mark = "# gcdt grid ";
  if (comment.substr(0, mark.size()) != mark) return;
  comment.remove_prefix(mark.size());
  while (!comment.empty() && is_blank(comment.back())) comment.remove_suffix(1);
  grid_comment_ = {std::string(comment), line_};
}

std::string_view Records::take(std::string_view what) {
  if (!more()) fail(fmt::format("{} is missing", what));
  const char* first = at_;
  while (at_ < line_end_ && !is_blank(*at_) && *at_ != '#') ++at_;
  return field_ = {first, static_cast<std::size_t>(at_ - first)};
}

std::string Records::field() const { return printable(field_); }

// What is written plainly is read in one pass, without a look for the field's end before.
template <class Parse>
bool Records::read_plainly(Parse&& parse) {
  if (!more()) return false;
  const char* end = parse(at_, line_end_);
  if (!end || (end < line_end_ && !is_blank(*end) && *end != '#')) return false;
  field_ = {at_, static_cast<std::size_t>(end - at_)};
  at_ = end;
  return true;
}

std::int64_t Records::integer(std::string_view what) {
  std::int64_t plain = 0;
  if (read_plainly([&](const char* first, const char* last) {
        const auto [end, error] = std::from_chars(first, last, plain);
        return error == std::errc() ? end : nullptr;
      }))
    return plain;
  std::string_view text = take(what);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument)
    fail(fmt::format("{} must be an integer, not \"{}\"", what, field()));
  if (error == std::errc::result_out_of_range) return text[0] == '-' ? INT64_MIN : INT64_MAX;
  return value;
}

std::uint64_t Records::count(std::string_view what, std::uint64_t most) {
  const std::int64_t value = integer(what);
  if (value < 0) fail(fmt::format("{} is negative: {}", what, field()));
  if (static_cast<std::uint64_t>(value) > most)
    fail(fmt::format("{} is {}; at most {} are possible", what, field(), most));
  return static_cast<std::uint64_t>(value);
}

double Records::number(std::string_view what) {
  double plain = 0;
  if (read_plainly([&](const char* first, const char* last) {
        const auto [end, error] = fast_float::from_chars(first, last, plain);
        return error == std::errc() ? end : nullptr;
      }))
    return plain;
  std::string_view text = take(what);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  // Out of range leaves 0 or infinity, which the caller judges; anything else is no number.
  if (end != text.data() + text.size() || error == std::errc::invalid_argument)
    fail(fmt::format("{} must be a number, not \"{}\"", what, field()));
  return value;
}

void Records::skip_numbers(std::string_view what) {
  while (more()) number(what);
}

void Records::fail(const std::string& what, Exit exit) const {
  throw Failure(exit, fmt::format("{}:{}: {}", name_, std::max<std::uint64_t>(line_, 1), what));
}

}  // namespace gcdt::io

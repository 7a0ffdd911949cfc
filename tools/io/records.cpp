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

TextFile::TextFile(const std::string& path) : path_(path) {
  file_.reset(path == "-" ? stdin : std::fopen(path.c_str(), "rb"));
  if (!file_) throw Failure(Exit::input, fmt::format("{}: cannot be opened: {}", path, std::strerror(errno)));
  if (path == "-" || std::fseek(file_.get(), 0, SEEK_END) != 0) return;
  const long size = std::ftell(file_.get());
  std::rewind(file_.get());
  // A directory has an absurd size here, and a pipe none.
  if (size > 0 && size < (1l << 40)) left_ = static_cast<std::uint64_t>(size);
}

std::size_t TextFile::read(char* to, std::size_t most) {
  const std::size_t got = std::fread(to, 1, most, file_.get());
  if (std::ferror(file_.get()))
    throw Failure(Exit::input, fmt::format("{}: cannot be read: {}", shown_name(path_), std::strerror(errno)));
  left_ -= std::min<std::uint64_t>(left_, got);
  return got;
}

namespace {

/// Of text that goes on. Throws if its last word has more than `longest` bytes.
void check_word(const std::string& name, std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return;
  if (text.substr(text.size() - longest - 1).find_last_of(" \t\r\n") == text.npos)
    throw Failure(Exit::input, fmt::format("{}: a word of more than {} bytes", name, longest));
}

}  // namespace

std::string read_file(const std::string& path, std::size_t longest) {
  TextFile file(path);
  const std::size_t expected = file.left() > 0 ? static_cast<std::size_t>(file.left()) + 1 : 0;
  std::string text;
  for (std::size_t used = 0;;) {
    // The first block is read before there is room for the rest: what is no text shows there.
    constexpr std::size_t first = 1 << 21, next = 1 << 24;
    if (used >= first && expected > text.capacity()) text.reserve(expected);
    text.resize(used + (used < first ? std::min(expected > 0 ? expected : first, first) : next));
    const std::size_t got = file.read(&text[used], text.size() - used);
    used += got;
    if (got == 0 || used < text.size()) text.resize(used);
    if (got == 0) return text;
    check_word(shown_name(path), text, longest);
  }
}

std::uint64_t LineNumbers::of(std::uint64_t index) const {
  if (index >= count_) return 0;
  auto after =
      std::upper_bound(runs_.begin(), runs_.end(), index, [](auto i, const Run& run) { return i < run.first; });
  const Run& run = *std::prev(after);
  return run.line + (index - run.first);
}

Records::Records(const std::string& path) : name_(shown_name(path)), file_(path) {
  refill();
  constexpr std::string_view mark = "\xEF\xBB\xBF";  // the byte order mark of UTF-8
  if (std::string_view(next_, static_cast<std::size_t>(end_ - next_)).substr(0, mark.size()) == mark)
    next_ += mark.size();
}

bool Records::next() {
  while (take_line()) {
    ++line_;
    if (more()) return true;
    if (at_ < line_end_) note_comment({at_, static_cast<std::size_t>(line_end_ - at_)});
  }
  at_ = line_end_ = end_;
  return false;
}

void Records::expect(const char* kind, std::uint64_t done, std::uint64_t count) {
  if (!next()) fail(fmt::format("the file ends after {} of {} {}", done, count, kind));
}

/// Ends: the window grows until it has the line's end, or the file's.
bool Records::take_line() {
  for (std::size_t looked = 0;;) {
    const auto come = static_cast<std::size_t>(end_ - next_);
    const void* found = come > looked ? std::memchr(next_ + looked, '\n', come - looked) : nullptr;
    if (!found && !is_whole_) {
      looked = come;
      refill();
      continue;
    }
    if (!found && come == 0) return false;
    at_ = next_;
    line_end_ = found ? static_cast<const char*>(found) : end_;
    next_ = found ? line_end_ + 1 : end_;
    return true;
  }
}

/// Keeps what has come behind the current line, and reads on.
void Records::refill() {
  constexpr std::uint64_t most = std::uint64_t{1} << 22;
  const auto block = static_cast<std::size_t>(file_.left() > 0 ? std::min(most, file_.left() + 1) : most);
  const auto kept = static_cast<std::size_t>(end_ - next_);
  check_word(name_, {next_, kept}, longest_word);
  field_ = {};
  if (kept > 0) std::memmove(window_.data(), next_, kept);
  if (window_.size() < 2 * kept + block) window_.resize(2 * kept + block);
  const std::size_t got = file_.read(window_.data() + kept, window_.size() - kept);
  is_whole_ = got < window_.size() - kept;
  next_ = window_.data();
  end_ = next_ + kept + got;
  at_ = line_end_ = next_;
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

double Records::coordinate(const char* what) {
  const double value = number(what);
  if (!(value - value == 0)) fail(fmt::format("the {} is not finite: {}", what, field()));
  return value;
}

std::size_t Records::reservation(std::uint64_t count, std::size_t shortest_record) const {
  return static_cast<std::size_t>(std::min<std::uint64_t>(count, bytes_left() / shortest_record + 1));
}

void Records::skip_numbers(std::string_view what) {
  while (more()) number(what);
}

void Records::fail(const std::string& what, Exit exit) const {
  throw Failure(exit, fmt::format("{}:{}: {}", name_, std::max<std::uint64_t>(line_, 1), what));
}

}  // namespace gcdt::io

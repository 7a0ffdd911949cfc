// SPDX-License-Identifier: Apache-2.0
// Text files of Triangle's kind: one record a line, fields between blanks, comments from '#'.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "failure.hpp"

namespace gcdt::io {

/// The whole of a file, or of standard input for "-". Throws Failure (Exit::input), of a file without blanks for more
/// than `longest` bytes at once as soon as these are read, some more or less: no record is like that.
std::string read_file(const std::string& path, std::size_t longest = SIZE_MAX);
constexpr std::size_t longest_word = 1 << 20;

/// How a file is named in messages: its path, or "<stdin>" for "-".
std::string shown_name(const std::string& path);

/// A file, or standard input for "-", from front to back. Throws Failure (Exit::input).
class TextFile {
 public:
  explicit TextFile(const std::string& path);
  /// Up to so many bytes, fewer only before the end; 0 there.
  std::size_t read(char* to, std::size_t most);
  /// Bytes that follow; 0 of a pipe, of which nobody knows.
  std::uint64_t left() const { return left_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const {
      if (file != stdin) std::fclose(file);
    }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t left_ = 0;
};

/// Line numbers of consecutive records, stored as runs of neighbouring lines.
class LineNumbers {
 public:
  void append(std::uint64_t line) {
    if (runs_.empty() || line != runs_.back().line + (count_ - runs_.back().first)) runs_.push_back({count_, line});
    ++count_;
  }
  /// The line of record `index`; 0 if there is no such record.
  std::uint64_t of(std::uint64_t index) const;

 private:
  struct Run {
    std::uint64_t first, line;
  };
  std::vector<Run> runs_;
  std::uint64_t count_ = 0;
};

/// Reads records field by field, and the file block by block. Every failure says FILE:LINE: what; a word of more than
/// `longest_word` bytes, some more or less, is one as well.
class Records {
 public:
  explicit Records(const std::string& path);
  Records(const Records&) = delete;
  Records& operator=(const Records&) = delete;

  /// Moves to the next line that holds more than blanks and a comment; false at the end.
  bool next();
  /// The same to record `done` of `count`; at the end it fails, and says how many came.
  void expect(const char* kind, std::uint64_t done, std::uint64_t count);
  /// Whether the current record has a further field.
  bool more();
  /// The next field as an integer; beyond 64 bits it is the nearest one. `what` names it in failures.
  std::int64_t integer(std::string_view what);
  /// The next field as a count: an integer from 0 to `most`.
  std::uint64_t count(std::string_view what, std::uint64_t most);
  /// The next field as the nearest double; "nan" and "inf" are numbers here.
  double number(std::string_view what);
  /// The next field as a number that is finite.
  double coordinate(const char* what);
  /// The next field as it is, until next() is called.
  std::string_view word(std::string_view what) { return take(what); }
  /// The rest of the record, which must be numbers.
  void skip_numbers(std::string_view what);

  /// The field read last, as written.
  std::string field() const;
  const std::string& name() const { return name_; }
  std::uint64_t line() const { return line_; }
  /// Of the file, at least; of a pipe what has come of it.
  std::uint64_t bytes_left() const { return static_cast<std::uint64_t>(end_ - next_) + file_.left(); }
  /// How many of `count` records may be in the rest of the file, if each has so many bytes at least.
  std::size_t reservation(std::uint64_t count, std::size_t shortest_record) const;
  /// The last comment passed that begins with "# gcdt grid ", less these words, and its line.
  const std::pair<std::string, std::uint64_t>& grid_comment() const { return grid_comment_; }

  [[noreturn]] void fail(const std::string& what, Exit exit = Exit::input) const;

 private:
  template <class Parse>
  bool read_plainly(Parse&& parse);
  std::string_view take(std::string_view what);
  void note_comment(std::string_view comment);
  bool take_line();
  void refill();

  std::string name_;
  TextFile file_;
  std::vector<char> window_;
  bool is_whole_ = false;  ///< the window has the end of the file
  // In the window: the current line from where it is read on, and all that has come behind it.
  const char *at_ = nullptr, *line_end_ = nullptr, *next_ = nullptr, *end_ = nullptr;
  std::string_view field_;
  std::uint64_t line_ = 0;
  std::pair<std::string, std::uint64_t> grid_comment_;
};

}  // namespace gcdt::io

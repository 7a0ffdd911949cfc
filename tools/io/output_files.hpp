// SPDX-License-Identifier: Apache-2.0
// Output files that appear together or not at all.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "failure.hpp"

namespace gcdt::io {

/// One file, written under another name in the folder where it will stand. Throws Failure (Exit::output).
class OutputFile {
 public:
  OutputFile(const std::string& path, const std::function<void()>& between_blocks);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes) {
    buffer_.append(bytes.data(), bytes.data() + bytes.size());
    if (buffer_.size() >= block) flush();
  }
  template <class... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(fmt::appender(buffer_), format, std::forward<Args>(args)...);
    if (buffer_.size() >= block) flush();
  }

 private:
  friend class OutputFiles;
  static constexpr std::size_t block = 1 << 20;
  void append();
  void flush();
  void close();
  void replace_target();
  void restore_target();
  void forget_backup();
  [[noreturn]] void fail(const std::string& why) const;

  std::string name_;  ///< as the user wrote it
  std::filesystem::path target_, temporary_, backup_;
  std::optional<std::filesystem::perms> permissions_;  ///< of what stands there
  fmt::memory_buffer buffer_;
  bool replaced_ = false;
  const std::function<void()>& between_blocks_;
};

/// All output files of one call. Unless commit() returns, nothing that existed is changed and
/// nothing is left behind.
class OutputFiles {
 public:
  /// `between_blocks` is called now and then while writing and may throw, e.g. on an interrupt.
  explicit OutputFiles(std::function<void()> between_blocks = [] {}) : between_blocks_(std::move(between_blocks)) {}
  OutputFile& add(const std::string& path);
  /// Gives every file its name. If one cannot have it, the others get back what stood there.
  void commit();

 private:
  std::function<void()> between_blocks_;
  std::vector<std::unique_ptr<OutputFile>> files_;
};

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
#include "output_files.hpp"

#include <cerrno>
#include <cstring>
#include <random>

namespace gcdt::io {

namespace fs = std::filesystem;

namespace {

/// A name that no file in `folder` has. Short, since the target's own name may be as long as names can be.
fs::path unused_name(const fs::path& folder, const char* suffix) {
  std::random_device random;
  std::error_code ignored;
  for (;;) {
    const fs::path name = folder / fmt::format(".gcdt-{:08x}{:08x}{}", random(), random(), suffix);
    if (!fs::exists(fs::symlink_status(name, ignored))) return name;
  }
}

/// Where `path` leads, so that a link is written through and not replaced.
fs::path destination(const fs::path& path) {
  std::error_code error;
  const fs::path followed = fs::weakly_canonical(path, error);
  return error || followed.empty() ? path : followed;
}

}  // namespace

OutputFile::OutputFile(const std::string& path, const std::function<void()>& between_blocks)
    : name_(path), target_(destination(path)), between_blocks_(between_blocks) {
  std::error_code ignored;
  const fs::file_status status = fs::status(target_, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) fail("is not a regular file");
  if (fs::exists(status)) {
    std::FILE* writable = std::fopen(target_.c_str(), "r+b");
    if (!writable) fail(std::strerror(errno));
    std::fclose(writable);
  }
  temporary_ = unused_name(target_.parent_path(), ".tmp");
  std::FILE* made = std::fopen(temporary_.c_str(), "wbx");
  if (!made) fail(std::strerror(errno));
  if (std::fclose(made) != 0) {
    const std::string why = std::strerror(errno);
    fs::remove(temporary_, ignored);
    fail(why);
  }
  if (!fs::exists(status)) return;
  permissions_ = status.permissions();
  fs::permissions(temporary_, *permissions_ | fs::perms::owner_write, ignored);
}

OutputFile::~OutputFile() {
  std::error_code ignored;
  if (!replaced_) fs::remove(temporary_, ignored);
}

void OutputFile::fail(const std::string& why) const {
  throw Failure(Exit::output, fmt::format("{}: cannot be written: {}", name_, why));
}

// Open only as long as that: there may be more output files than a process can have open.
void OutputFile::append() {
  std::FILE* file = std::fopen(temporary_.c_str(), "ab");
  if (!file) fail(std::strerror(errno));
  const bool written = std::fwrite(buffer_.data(), 1, buffer_.size(), file) == buffer_.size();
  const int why = errno;
  if (std::fclose(file) != 0) fail(std::strerror(errno));
  if (!written) fail(std::strerror(why));
  buffer_.clear();
}

void OutputFile::flush() {
  between_blocks_();
  append();
}

void OutputFile::close() {
  flush();
  std::error_code ignored;
  if (permissions_) fs::permissions(temporary_, *permissions_, ignored);
}

void OutputFile::replace_target() {
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status)) {
    if (!fs::is_regular_file(status)) fail("is not a regular file");
    backup_ = unused_name(target_.parent_path(), ".old");
    fs::create_hard_link(target_, backup_, error);  // so that the name is never without a file
    if (error) fs::rename(target_, backup_, error);
    if (error) {
      backup_.clear();
      fail(error.message());
    }
  }
  fs::rename(temporary_, target_, error);
  if (error) {
    restore_target();
    fail(error.message());
  }
  replaced_ = true;
}

void OutputFile::restore_target() {
  std::error_code ignored;
  if (!backup_.empty()) {
    fs::rename(backup_, target_, ignored);
    fs::remove(backup_, ignored);  // renaming a file to another of its own names keeps both
  } else if (replaced_) {
    fs::remove(target_, ignored);
  }
  backup_.clear();
}

void OutputFile::forget_backup() {
  std::error_code ignored;
  if (!backup_.empty()) fs::remove(backup_, ignored);
}

OutputFile& OutputFiles::add(const std::string& path) {
  files_.push_back(std::make_unique<OutputFile>(path, between_blocks_));
  return *files_.back();
}

void OutputFiles::commit() {
  for (auto& file : files_) file->close();
  try {
    for (auto& file : files_) file->replace_target();
  } catch (...) {
    for (auto& file : files_) file->restore_target();
    throw;
  }
  for (auto& file : files_) file->forget_backup();
}

}  // namespace gcdt::io

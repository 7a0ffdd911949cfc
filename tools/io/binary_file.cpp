// SPDX-License-Identifier: Apache-2.0
#include "binary_file.hpp"

#include <fmt/format.h>

#include <sys/types.h>

#include <cerrno>
#include <filesystem>

namespace gcdt::io {

BinaryFile::BinaryFile(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "rb"), std::fclose) {
  if (!file_) throw Failure(Exit::input, fmt::format("{}: cannot be opened: {}", path, std::strerror(errno)));
  std::error_code error;
  size_ = std::filesystem::file_size(path, error);
  if (error) throw Failure(Exit::input, fmt::format("{}: cannot be read: {}", path, error.message()));
}

void BinaryFile::read(void* to, std::uint64_t bytes, const char* what) {
  if (bytes > left() || std::fread(to, 1, bytes, file_.get()) != bytes)
    fail(fmt::format("the file ends within {}", what));
  at_ += bytes;
}

void BinaryFile::seek(std::uint64_t at) {
  if (at > size_ || fseeko(file_.get(), static_cast<off_t>(at), SEEK_SET) != 0)
    throw Failure(Exit::input, fmt::format("{}: cannot be read from byte {} on", path_, at));
  at_ = at;
}

void BinaryFile::fail(const std::string& what) const {
  throw Failure(Exit::input, fmt::format("{}: at byte {}: {}", path_, at_, what));
}

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
// A cache of a test's own.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

namespace gcdt::test {

inline void set_variable(const char* name, const std::string& value) {
#ifdef _WIN32
  _putenv_s(name, value.c_str());
#else
  setenv(name, value.c_str(), 1);
#endif
}

/// A new, empty folder that is the cache for the object's life, and is removed with it.
class CacheFolder {
 public:
  CacheFolder()
      : path_(std::filesystem::temp_directory_path() / ("gcdt-test-" + std::to_string(std::random_device()()))) {
    std::filesystem::create_directories(path_);
    set_variable("GCDT_DISABLE_CACHE", "0");
    set_variable("GCDT_CACHE_DIR", path_.string());
  }
  CacheFolder(const CacheFolder&) = delete;
  ~CacheFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
    set_variable("GCDT_DISABLE_CACHE", "1");
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// While it lives there is no cache.
class NoCache {
 public:
  NoCache() {
    if (const char* before = std::getenv("GCDT_DISABLE_CACHE")) before_ = before;
    set_variable("GCDT_DISABLE_CACHE", "1");
  }
  NoCache(const NoCache&) = delete;
  ~NoCache() { set_variable("GCDT_DISABLE_CACHE", before_); }

 private:
  std::string before_ = "0";
};

inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

inline void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
// A folder for one test case, gone with it.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace gcdt::testing {

class ScratchFolder {
 public:
  ScratchFolder() {
    std::random_device random;
    do
      path_ =
          std::filesystem::temp_directory_path() / ("gcdt-test-" + std::to_string(random()) + std::to_string(random()));
    while (!std::filesystem::create_directory(path_));
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream out(path_ / name, std::ios::binary);
    if (!(out << text).flush()) throw std::runtime_error("cannot write " + *this / name);
    return *this / name;
  }
  /// Throws if there is no such file: two that are missing are not equal.
  std::string read(const std::string& name) const {
    std::ifstream in(path_ / name, std::ios::binary);
    if (!in) throw std::runtime_error("cannot read " + *this / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// The names in the folder, ascending, hidden ones included.
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      all.push_back(entry.path().filename().string());
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace gcdt::testing

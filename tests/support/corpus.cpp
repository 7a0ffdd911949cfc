// SPDX-License-Identifier: Apache-2.0
#include "corpus.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace gcdt::test {

std::vector<std::string> words(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot open " + path);
  std::vector<std::string> result;
  for (std::string line; std::getline(file, line);) {
    std::istringstream text(line.substr(0, line.find('#')));
    for (std::string word; text >> word;) result.push_back(word);
  }
  return result;
}

Workload read_poly(const std::string& path) {
  const std::vector<std::string> word = words(path);
  std::size_t at = 0;
  const auto number = [&] { return std::strtoull(word.at(at++).c_str(), nullptr, 10); };
  const auto real = [&] { return std::strtod(word.at(at++).c_str(), nullptr); };
  Workload work;
  const std::uint64_t n = number();
  number();  // dimension
  const std::uint64_t attributes = number(), vertex_markers = number();
  std::uint64_t first = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    const std::uint64_t id = number();
    if (i == 0) first = id;
    if (id != first + i) throw std::runtime_error(path + ": vertices out of order");
    const double x = real();
    work.points.push_back({x, real()});
    at += attributes + vertex_markers;
  }
  const std::uint64_t m = number(), segment_markers = number();
  for (std::uint64_t i = 0; i < m; ++i) {
    number();
    const std::uint32_t a = static_cast<std::uint32_t>(number() - first);
    work.constraints.push_back({a, static_cast<std::uint32_t>(number() - first)});
    at += segment_markers;
  }
  return work;
}

std::vector<CorpusEntry> read_manifest(const std::string& folder) {
  const std::vector<std::string> word = words(folder + "/manifest.txt");
  std::vector<CorpusEntry> entries;
  for (std::size_t i = 0; i + 3 < word.size(); i += 4)
    entries.push_back({word[i], word[i + 1], word[i + 2] == "-" ? -1 : std::atol(word[i + 2].c_str()),
                       std::atol(word[i + 3].c_str())});
  return entries;
}

Minimal read_minimal(const std::string& path) {
  const std::vector<std::string> word = words(path);
  std::size_t at = 0;
  const auto number = [&] { return static_cast<std::uint32_t>(std::stoul(word.at(at++))); };
  const std::uint32_t vertices = number(), triangles = number(), constraints = number();
  Minimal file;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const double x = number();
    file.input.points.push_back({x, static_cast<double>(number())});
  }
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const std::uint32_t a = number(), b = number();
    file.start.push_back({a, b, number()});
  }
  for (std::uint32_t i = 0; i < constraints; ++i) {
    const std::uint32_t a = number();
    file.input.constraints.push_back({a, number()});
  }
  return file;
}

}  // namespace gcdt::test

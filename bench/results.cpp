// SPDX-License-Identifier: Apache-2.0
#include "results.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace gcdt::bench {

Object& Object::raw(const std::string& key, const std::string& json) {
  body_ += (body_.empty() ? "\"" : ", \"") + key + "\": " + json;
  return *this;
}

Object& Object::add(const std::string& key, const std::string& value) {
  std::string safe;
  for (const char c : value) safe += c == '"' || c == '\\' || static_cast<unsigned char>(c) < ' ' ? '\'' : c;
  return raw(key, '"' + safe + '"');
}

Object& Object::add(const std::string& key, double value) {
  if (!std::isfinite(value)) return raw(key, "null");
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", value);
  return raw(key, digits);
}

std::string member(const std::string& line, const std::string& key) {
  const std::string name = '"' + key + "\": ";
  const std::size_t found = line.find(name);
  if (found == std::string::npos) return {};
  const std::size_t begin = found + name.size();
  if (line[begin] == '"') return line.substr(begin + 1, line.find('"', begin + 1) - begin - 1);
  return line.substr(begin, line.find_first_of(",}]", begin) - begin);
}

namespace {

bool same(const std::string& row, const std::string& name, std::size_t size, const std::string& device) {
  return member(row, "workload") == name && member(row, "size") == std::to_string(size) &&
         member(row, "device") == device;
}

}  // namespace

Results::Results(std::string path) : path_(std::move(path)) {
  std::ifstream file(path_);
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] != '{' || member(line, "workload").empty()) continue;
    if (line.back() == ',') line.pop_back();
    rows_.push_back(line);
  }
}

bool Results::has(const std::string& name, std::size_t size, const std::string& device) const {
  for (const std::string& row : rows_)
    if (same(row, name, size, device)) return true;
  return false;
}

void Results::put(const std::string& row) {
  bool replaced = false;
  for (std::string& old : rows_)
    if (same(old, member(row, "workload"), std::strtoull(member(row, "size").c_str(), nullptr, 10),
             member(row, "device"))) {
      old = row;
      replaced = true;
    }
  if (!replaced) rows_.push_back(row);
  write();
}

void Results::set_machine(const std::string& object) {
  machine_ = object;
  write();
}

void Results::write() const {
  const std::string next = path_ + ".part";
  {
    std::ofstream file(next);
    file << "{\"machine\": " << machine_ << ",\n\"rows\": [\n";
    for (std::size_t i = 0; i < rows_.size(); ++i) file << rows_[i] << (i + 1 < rows_.size() ? ",\n" : "\n");
    file << "]}\n";
    if (!file.flush()) throw std::runtime_error(next + ": cannot be written");
  }
  if (std::rename(next.c_str(), path_.c_str()) != 0) throw std::runtime_error(path_ + ": cannot be written");
}

std::vector<Anchor> anchors(const std::string& path, bool gpu, const std::string& name, std::size_t size) {
  std::vector<Anchor> found;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (member(line, "workload") != name || member(line, "valid") != "true") continue;
    if (member(line, "kind") != (gpu ? "gpu" : "cpu")) continue;
    const double n = std::strtod(member(line, "n").c_str(), nullptr), wanted = static_cast<double>(size);
    if (std::fabs(n - wanted) > 0.03 * wanted) continue;
    found.push_back({member(line, "peer"), member(line, "date"), member(line, "machine"),
                     std::strtod(member(line, "ms").c_str(), nullptr)});
  }
  return found;
}

}  // namespace gcdt::bench

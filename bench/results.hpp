// SPDX-License-Identifier: Apache-2.0
// The file of results: JSON with one row to a line, rewritten after every row, so that a run can be
// stopped and taken up again.
#pragma once

#include <string>
#include <vector>

namespace gcdt::bench {

/// A flat or nested JSON object under construction, on one line.
class Object {
 public:
  Object& add(const std::string& key, const std::string& value);
  Object& add(const std::string& key, const char* value) { return add(key, std::string(value)); }
  Object& add(const std::string& key, double value);
  Object& add(const std::string& key, unsigned long long value) { return raw(key, std::to_string(value)); }
  Object& add(const std::string& key, bool value) { return raw(key, value ? "true" : "false"); }
  Object& raw(const std::string& key, const std::string& json);
  std::string text() const { return '{' + body_ + '}'; }

 private:
  std::string body_;
};

/// The text of the first member called `key` of the JSON object on `line`, without quotes; "" if none.
/// For lines that this project wrote: no escaped quotes.
std::string member(const std::string& line, const std::string& key);

class Results {
 public:
  /// Takes up the rows of the file at `path`, if there is one. Write the machine before the first row.
  explicit Results(std::string path);
  /// Writes the file, so that one that cannot be written is an error before anything is timed.
  void set_machine(const std::string& object);
  bool has(const std::string& name, std::size_t size, const std::string& device) const;
  /// Adds the row or replaces the one of the same input and device, and writes the file.
  void put(const std::string& row);

 private:
  void write() const;

  std::string path_, machine_;
  std::vector<std::string> rows_;
};

/// A figure taken elsewhere (bench/peers/anchors.json).
struct Anchor {
  std::string peer, date, machine;
  double ms = 0;
};

/// The anchors for the input on a device of that kind whose result is valid; sizes may differ by 3%.
std::vector<Anchor> anchors(const std::string& path, bool gpu, const std::string& name, std::size_t size);

}  // namespace gcdt::bench

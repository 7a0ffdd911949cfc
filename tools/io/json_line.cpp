// SPDX-License-Identifier: Apache-2.0
#include "json_line.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace gcdt::io {

namespace {

/// Goes through a text that a parser has accepted.
class Scan {
 public:
  explicit Scan(std::string_view text) : text_(text) {}

  std::size_t at() const { return at_; }
  void go(std::size_t at) { at_ = at; }
  char look() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (look() != c) return false;
    ++at_;
    return true;
  }
  /// A string as it is written, without its quotes.
  std::string_view string() {
    const std::size_t begin = ++at_;
    while (at_ < text_.size() && text_[at_] != '"') at_ += text_[at_] == '\\' ? 2 : 1;
    return text_.substr(begin, at_++ - begin);
  }
  /// Past the value that stands here.
  void skip() {
    std::size_t open = 0;
    do {
      const char c = look();
      if (c == '"') {
        string();
      } else if (c == '[' || c == '{') {
        ++open, ++at_;
      } else if (c == ']' || c == '}') {
        --open, ++at_;
      } else if (c == ',' || c == ':') {
        ++at_;
      } else {
        at_ = std::min(text_.find_first_of(",:]} \t\r\n", at_), text_.size());
      }
    } while (open > 0 && at_ < text_.size());
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

/// Moves from a value to one in it; false: there is none. Of members with the same name the last one counts.
bool enter(Scan& scan, const JsonStep& step) {
  bool found = false;
  std::size_t place = 0;
  if (step.key.empty() ? !scan.take('[') : !scan.take('{')) return false;
  for (std::size_t number = 0; scan.look() != ']' && scan.look() != '}' && scan.look() != '\0'; ++number) {
    bool wanted = number == step.element;
    if (!step.key.empty()) {
      wanted = scan.string() == step.key;
      scan.take(':');
    }
    scan.look();
    if (wanted) found = true, place = scan.at();
    scan.skip();
    scan.take(',');
  }
  if (found) scan.go(place);
  return found;
}

using Json = nlohmann::json;

/// Looks at nothing but the fault. Json::parse() tells the place of some of them only, and that within a sentence.
class FaultFinder : public nlohmann::json_sax<Json> {
 public:
  std::size_t read = 0;  ///< characters, up to the fault and with it
  std::string what;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return true; }
  bool key(string_t&) override { return true; }
  bool end_object() override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool parse_error(std::size_t position, const std::string&, const Json::exception& error) override {
    read = position;
    what = error.what();
    return false;
  }
};

}  // namespace

JsonFault json_fault(std::string_view text) {
  FaultFinder finder;
  Json::sax_parse(text, &finder);
  // "[json.exception.parse_error.101] parse error at line 3, column 4: what", or "[...] what".
  std::string_view what = finder.what;
  for (const std::string_view before : {std::string_view("[json."), std::string_view("parse error at ")}) {
    if (what.substr(0, before.size()) != before) continue;
    const std::size_t end = what.find(before[0] == '[' ? "] " : ": ");
    if (end != std::string_view::npos) what.remove_prefix(end + 2);
  }
  const std::string_view good = text.substr(0, finder.read == 0 ? 0 : finder.read - 1);
  const auto ends = std::count(good.begin(), good.end(), '\n');
  const std::size_t begin = ends == 0 ? 0 : good.rfind('\n') + 1;
  return {1 + static_cast<std::size_t>(ends), 1 + good.size() - begin, std::string(what)};
}

std::size_t json_line(std::string_view text, const std::vector<JsonStep>& path) {
  Scan scan(text);
  scan.look();
  std::size_t at = scan.at();
  for (const JsonStep& step : path) {
    if (!enter(scan, step)) break;
    at = scan.at();
  }
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace gcdt::io

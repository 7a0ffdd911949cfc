// SPDX-License-Identifier: Apache-2.0
// The command gcdt in a folder of its own, as its user sees it: arguments in; status, files and text out.
#pragma once

#include <doctest/doctest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "scratch_folder.hpp"

namespace gcdt::testing {

struct Outcome {
  int status;
  std::string out, err;
};

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A folder in which the command is run, so that its arguments are short names.
class Session : public ScratchFolder {
 public:
  /// Runs a shell line in which $gcdt is the command. Who does not care how it ends calls `run`, which does.
  [[nodiscard]] Outcome shell(const std::string& line) const {
    ScratchFolder streams;
    const std::string whole = "cd '" + *this / "" + "' && gcdt='" GCDT_COMMAND "' && { " + line + "\n} >'" +
                              streams / "out" + "' 2>'" + streams / "err" + "'";
    const int status = std::system(whole.c_str());
    REQUIRE(WIFEXITED(status));
    return {WEXITSTATUS(status), streams.read("out"), streams.read("err")};
  }
  /// Runs a shell line that prepares or compares something: it must succeed.
  void run(const std::string& line) const {
    const Outcome outcome = shell(line);
    INFO(line << ": " << outcome.out << outcome.err);
    REQUIRE(outcome.status == 0);
  }
  [[nodiscard]] Outcome gcdt(const std::string& arguments) const {
    return shell("\"$gcdt\" " + arguments + " </dev/null");
  }
  /// Runs the command, which must succeed without a word on standard error; its standard output.
  std::string good(const std::string& arguments) const {
    CAPTURE(arguments);
    const Outcome outcome = gcdt(arguments);
    CHECK(outcome.err == "");
    CHECK(outcome.status == 0);
    return outcome.out;
  }
  /// Runs the command, which must fail with `status` and one line on standard error; that line.
  std::string bad(int status, const std::string& arguments) const {
    CAPTURE(arguments);
    const Outcome outcome = gcdt(arguments);
    CAPTURE(outcome.err);
    CHECK(outcome.status == status);
    CHECK(outcome.out == "");
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(outcome.err.compare(0, 6, "gcdt: ") == 0);
    return outcome.err;
  }
};

inline constexpr const char* square = "4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n1 0\n0 1 3\n0\n";
inline constexpr const char* square_from_1 = "4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n1 0\n1 2 4\n0\n";
/// Two diagonals of a square: segments 0 (line 7) and 1 (line 8) cross.
inline constexpr const char* crossed = "4 2 0 0\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n2 0\n0 1 3\n1 0 2\n0\n";

/// The lines of a text that are no comments.
inline std::string data_lines(const std::string& text) {
  std::istringstream in(text);
  std::string lines;
  for (std::string line; std::getline(in, line);)
    if (line.empty() || line[0] != '#') lines += line + "\n";
  return lines;
}

/// A closed star-shaped polygon around many scattered vertices, with decimal coordinates.
inline std::string random_poly(int n, int first) {
  std::mt19937 random(7);
  std::ostringstream text;
  text << n << " 2 0 0\n";
  const int ring = n / 4;
  for (int i = 0; i < n; ++i) {
    const double angle = 6.283185307179586 * i / ring, radius = 500 + static_cast<double>(random() % 400);
    const long x =
        std::lround(i < ring ? radius * std::cos(angle) * 1000 : static_cast<double>(random() % 2000000) - 1000000);
    const long y =
        std::lround(i < ring ? radius * std::sin(angle) * 1000 : static_cast<double>(random() % 2000000) - 1000000);
    text << i + first << ' ' << x << "e-3 " << y << "e-3\n";
  }
  text << ring << " 0\n";
  for (int i = 0; i < ring; ++i) text << i + first << ' ' << i + first << ' ' << (i + 1) % ring + first << '\n';
  text << "0\n";
  return text.str();
}

/// A square in a square, each with a point for a region, the inner one with a hole.
inline std::string framed() {
  return "8 2 0 0\n0 0 0\n1 9 0\n2 9 9\n3 0 9\n4 3 3\n5 6 3\n6 6 6\n7 3 6\n8 0\n0 4 5\n1 5 6\n2 6 7\n3 7 4\n4 0 1\n"
         "5 1 2\n6 2 3\n7 3 0\n1\n0 4 4\n2\n0 1 1 17.5 -1\n1 4 5 4 -1\n";
}

}  // namespace gcdt::testing

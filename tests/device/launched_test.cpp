// SPDX-License-Identifier: Apache-2.0
// After all other tests: every kernel was launched by one of them, and every kernel that GPUs launch by a device that
// is treated as one. What was launched is noted by launch_layer.cpp; docs/testing.md says how.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "device/programs.hpp"

namespace {

using Names = std::set<std::string>;

// Programs and kernels that only CPUs launch (kernels/README.md), where few vertices, problems or constraints are one
// work-item's, walks are one work-item's, and constraints are checked along the curve.
const Names programs_of_cpus = {"core",        "grow",          "by_one_item",   "arrange", "enforce",
                                "domain_each", "sort32_serial", "sort64_serial", "tail"};
// Every device computes these in one way: they need not be launched by one that is treated as a GPU.
const Names programs_of_one_way = {"predicates", "selftest"}, kernels_of_one_way = {"locate_weights"};
const Names kernels_of_cpus = {"sort_by_one_item", "scan_sum_serial", "scan_serial", "check_first_pieces"};
// No test launches these, and why. (Empty, and best left so.)
const std::map<std::string, std::string> excused = {};

// The kernels of each program; those of a program that others include are theirs, too.
std::map<std::string, Names> kernels_by_program() {
  std::map<std::string, Names> all;
  const std::regex kernel(R"(\bkernel\s+void\s+(\w+)\s*\()");
  for (std::size_t i = 0; i < gcdt::runtime::kernel_source_count; ++i) {
    const std::string text = gcdt::runtime::kernel_sources[i].text;
    for (std::sregex_iterator k(text.begin(), text.end(), kernel), end; k != end; ++k)
      all[gcdt::runtime::kernel_sources[i].program].insert((*k)[1]);
  }
  return all;
}

struct Launched {
  Names by_any, by_gpus;
};

Launched launched() {
  const char* folder = std::getenv("GCDT_LAUNCHED");
  REQUIRE_MESSAGE(folder, "GCDT_LAUNCHED names no folder: this test is run by ctest");
  Launched found;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    std::ifstream in(file.path());
    for (std::string line; std::getline(in, line);) {
      const std::string name = line.substr(0, line.find(' '));
      found.by_any.insert(name);
      if (line.find("-DGCDT_GPU") != std::string::npos) found.by_gpus.insert(name);
    }
  }
  return found;
}

std::string list(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += " " + name;
  return text;
}

}  // namespace

TEST_CASE("every kernel was launched by a test, and those of GPUs on a device treated as one") {
  const Launched found = launched();
  Names all, of_gpus;
  for (const auto& [program, kernels] : kernels_by_program())
    for (const std::string& kernel : kernels) {
      all.insert(kernel);
      if (programs_of_cpus.count(program) + programs_of_one_way.count(program) == 0 &&
          kernels_of_cpus.count(kernel) + kernels_of_one_way.count(kernel) == 0)
        of_gpus.insert(kernel);
    }
  REQUIRE(all.size() > 100);
  Names never, never_by_gpus, in_vain;
  for (const std::string& kernel : all)
    if (found.by_any.count(kernel) == 0) never.insert(kernel);
  for (const std::string& kernel : of_gpus)
    if (found.by_gpus.count(kernel) == 0) never_by_gpus.insert(kernel);
  for (const auto& [kernel, reason] : excused) {
    if (never.erase(kernel) + never_by_gpus.erase(kernel) == 0) in_vain.insert(kernel);
    CHECK(!reason.empty());
  }
  INFO("after a run of some tests only, this says nothing");
  CHECK(list(never) == "");
  CHECK(list(never_by_gpus) == "");
  CHECK(list(in_vain) == "");
}

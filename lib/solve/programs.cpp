// SPDX-License-Identifier: Apache-2.0
#include "solve/programs.hpp"

namespace gcdt {

namespace {

struct Needed {
  const char* program;
  bool by_constraints;
};

// In the order in which a call comes to them, but that those that take long are begun before others that are needed
// earlier.
constexpr Needed needed[] = {
    {"order", false}, {"sort64_group", false}, {"sort_finish", false},
    {"first", true},  {"insert", false},       {"primitives_group", false},
    {"mesh", false},  {"primitives", true},    {"constrain", true},
    {"clean", true},  {"flip", false},         {"parts", true},
    {"stitch", true}, {"retriangulate", true}, {"output", false},
    {"check", false},
};

}  // namespace

std::vector<const char*> programs_of_call(bool constrained) {
  std::vector<const char*> programs;
  for (const Needed& n : needed)
    if (constrained || !n.by_constraints) programs.push_back(n.program);
  return programs;
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "solve/programs.hpp"

namespace gcdt {

namespace {

struct Needed {
  const char* program;
  bool by_constraints;
};

template <std::size_t count>
std::vector<const char*> of(const Needed (&needed)[count], bool constrained) {
  std::vector<const char*> programs;
  for (const Needed& n : needed)
    if (constrained || !n.by_constraints) programs.push_back(n.program);
  return programs;
}

}  // namespace

// In the order in which a call comes to them, but that those that take long are begun before others that are needed
// earlier.
std::vector<const char*> programs_of_call(bool constrained) {
  constexpr Needed needed[] = {
      {"order", false}, {"sort64_group", false}, {"sort_finish", false},
      {"first", true},  {"insert", false},       {"primitives_group", false},
      {"mesh", false},  {"primitives", true},    {"constrain", true},
      {"clean", true},  {"flip", false},         {"parts", true},
      {"stitch", true}, {"retriangulate", true}, {"output", false},
      {"check", false},
  };
  return of(needed, constrained);
}

std::vector<const char*> programs_of_batch(bool constrained) {
  constexpr Needed needed[] = {
      {"forest", false},
      {"sort_finish", false},
      {"first", true},
      {"insert", false},
      {"primitives_group", false},
      {"mesh", false},
      {"primitives", true},
      {"constrain", true},
      {"clean", true},
      {"flip", false},
      {"parts", true},
      {"stitch", true},
      {"retriangulate", true},
      {"output", false},
      {"check", false},
      {"check_forest", false},
  };
  return of(needed, constrained);
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "solve/programs.hpp"

#include <optional>

namespace gcdt {

namespace {

using runtime::Meshes;

struct Needed {
  const char* program;
  bool by_constraints = false;
  std::optional<Meshes> of = {};  // none: of both
  bool by_digits = false;         // by sorts of more keys than are merged
};

// In the order in which a call comes to them, but that those that take long are begun before others that are needed
// earlier.
constexpr Needed needed[] = {
    {"order", false, Meshes::one},
    {"forest", false, Meshes::many},
    {"sort64_group", false, Meshes::one, true},
    {"sort_finish"},
    {"first", true},
    {"insert"},
    {"primitives_group"},
    {"mesh"},
    {"constrain", true},
    {"clean", true},
    {"flip"},
    {"parts", true},
    {"stitch", true},
    {"retriangulate", true},
    {"output"},
    {"check"},
    {"check_forest", false, Meshes::many},
};

}  // namespace

std::vector<const char*> programs_of_call(Meshes meshes, bool constrained, bool by_digits) {
  std::vector<const char*> programs;
  for (const Needed& n : needed)
    if ((constrained || !n.by_constraints) && (by_digits || !n.by_digits) && n.of.value_or(meshes) == meshes)
      programs.push_back(n.program);
  return programs;
}

}  // namespace gcdt

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
};

// In the order in which a call comes to them, but that those that take long are begun before others that are needed
// earlier.
constexpr Needed needed[] = {
    {"order", false, Meshes::one},
    {"forest", false, Meshes::many},
    {"sort64_group", false, Meshes::one},
    {"sort_finish", false, Meshes::one},
    {"sort_finish", true, Meshes::many},
    {"sort_segments", false, Meshes::many},
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
    {"buckets"},
    {"output"},
    {"check"},
    {"check_forest", false, Meshes::many},
};

}  // namespace

std::vector<const char*> programs_of_call(Meshes meshes, bool constrained, bool patched, bool grouped) {
  std::vector<const char*> programs;
  for (const Needed& n : needed)
    if ((constrained || !n.by_constraints) && n.of.value_or(meshes) == meshes) programs.push_back(n.program);
  if (constrained && grouped) programs.push_back("slots");
  if (patched) programs.push_back("patches");
  return programs;
}

}  // namespace gcdt

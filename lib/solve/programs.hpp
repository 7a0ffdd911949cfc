// SPDX-License-Identifier: Apache-2.0
// Which programs a call needs on a GPU.
#pragma once

#include <vector>

#include "device/programs.hpp"

namespace gcdt {

/// What decides which programs a call needs.
struct CallShape {
  runtime::Meshes meshes = runtime::Meshes::one;  ///< one, or a run of many problems of a batch
  bool constrained = false;                       ///< has constraints of which some cross edges
  bool merged = false;                            ///< has so few vertices that they are sorted by merges
  bool swept = false;                             ///< has so many edges that flips sweep
  bool patched = false;                           ///< and that they begin within patches
  bool grouped = false;                           ///< and that pieces have slots of their own
  bool spares = false;                            ///< goes without what only saves time (runtime::SparedPrograms)
};

/// Those that each such call launches that checks its mesh, if it has so many vertices that more than a group sort
/// them. What holes, domains, crossings, refinement and coordinates that may be decimals need besides is built when
/// they come to it.
std::vector<const char*> programs_of_call(const CallShape& call);

}  // namespace gcdt

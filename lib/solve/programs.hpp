// SPDX-License-Identifier: Apache-2.0
// Which programs a call needs on a GPU.
#pragma once

#include <vector>

#include "device/programs.hpp"

namespace gcdt {

/// Those that each call launches that checks its mesh, or run of many problems of a batch (`meshes`), if it has so many
/// vertices that more than a group sort them; `constrained`: and has constraints of which some cross edges; `patched`,
/// `grouped`: and so many edges that flips begin within patches, that pieces have slots of their own. What holes,
/// domains, crossings, refinement and coordinates that may be decimals need besides is built when they come to it.
std::vector<const char*> programs_of_call(runtime::Meshes meshes, bool constrained, bool patched = false,
                                          bool grouped = false);

}  // namespace gcdt

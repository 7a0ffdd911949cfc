// SPDX-License-Identifier: Apache-2.0
// Which programs a call needs on a GPU.
#pragma once

#include <vector>

namespace gcdt {

/// Those that each call launches that checks its mesh, if it has so many vertices that more than a group sort them;
/// `constrained`: and has constraints of which some cross edges. What domains, crossings and refinement need besides is
/// built when they come to it.
std::vector<const char*> programs_of_call(bool constrained);

/// The same of a run of many problems of a batch.
std::vector<const char*> programs_of_batch(bool constrained);

}  // namespace gcdt

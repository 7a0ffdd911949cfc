// SPDX-License-Identifier: Apache-2.0
// The switches of Triangle, as arguments of this command.
#pragma once

#include <string>
#include <utility>

#include "command.hpp"

namespace gcdt::command {

/// Sets what `arguments.triangle` says, if anything: domain, crossings, regions, refinement, and without -o the outputs
/// that Triangle would write. Throws io::Failure (Exit::usage) for switches that are unknown or not supported, and for
/// options that say the same.
void apply_triangle_switches(TriangulateArguments& arguments);

/// The result without the vertices that no triangle has, and without constraints that end at one: Triangle's -j. All
/// vertices are the input's in what is returned.
std::pair<io::Input, Triangulation> jettisoned(const io::Result& result);

}  // namespace gcdt::command

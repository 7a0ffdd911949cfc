// SPDX-License-Identifier: Apache-2.0
// What --verify does with a result.
#pragma once

#include <gcdt/verify.hpp>

#include "io/triangle_files.hpp"

namespace gcdt::command {

/// All of the result, added vertices with what they were put on.
MeshView view_of(const io::MeshArrays& mesh);

/// The host's proof of a result of `options`, with its regions if there are any.
Verification prove(const io::Input& input, const io::MeshArrays& mesh, const Options& options);

}  // namespace gcdt::command

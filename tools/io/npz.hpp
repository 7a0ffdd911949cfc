// SPDX-License-Identifier: Apache-2.0
// Results and meshes as NumPy's arrays.
#pragma once

#include <string>

#include "mesh_input.hpp"

namespace gcdt::io {

/// Writes all arrays by name (docs/command.md), not compressed, so that they can be mapped; the same bytes in each run.
void write_npz(OutputFile& file, const Result& result);
/// Writes the triangles alone.
void write_npy(OutputFile& file, const Result& result);

/// Whether an archive has triangles. Throws Failure (Exit::input).
bool npz_holds_mesh(const std::string& path);
/// Its vertices and triangles, and what it says of them. Throws Failure (Exit::input).
MeshInput read_npz_mesh(const std::string& path);

}  // namespace gcdt::io

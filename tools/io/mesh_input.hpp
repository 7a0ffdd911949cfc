// SPDX-License-Identifier: Apache-2.0
// A mesh from a file as an input: its vertices with their attributes, and its triangles.
#pragma once

#include "triangle_files.hpp"

namespace gcdt::io {

struct MeshInput {
  Input input;  ///< vertices and attributes; no constraints
  MeshFile mesh;
};

/// Whether a file is a mesh: .ele, .vtu, or an .npz with triangles, which is opened for that.
bool holds_mesh(const std::string& path);

/// Reads an .ele file with the .node beside it, an .npz file, or a .vtu file, of which the points' z, if any is not 0,
/// and all point arrays with one number a point, but for `marker`, are attributes. Throws Failure: Exit::input, also
/// for a number that does not exist.
MeshInput read_mesh_input(const std::string& path);

/// A grid that was given as an option, to be given again; nothing for one that was chosen.
std::optional<FixedGrid> given_grid(const Grid& grid);

}  // namespace gcdt::io

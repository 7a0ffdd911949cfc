// SPDX-License-Identifier: Apache-2.0
// A check of part of a mesh in exact host arithmetic, for meshes too large to verify whole.
#pragma once

#include <string>

#include <gcdt/gcdt.hpp>

namespace gcdt::bench {

/// Of `samples` triangles drawn by a fixed seed: corners exist and turn counter-clockwise on the grid, links are
/// two-sided, and each unconstrained edge is locally Delaunay with the tie rule. And of the whole mesh: its number
/// of triangles is 2 n - 2 - h, h the sides without neighbour. "" or the first failure. Only grids whose cell is
/// a power of two.
std::string sampled_check(Points points, const Triangulation& mesh, std::size_t samples);

}  // namespace gcdt::bench

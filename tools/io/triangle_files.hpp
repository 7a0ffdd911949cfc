// SPDX-License-Identifier: Apache-2.0
// Triangle's formats: .poly and .node in; .ele, .node, .neigh, .edge and .poly out; .ele and .neigh back in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "output_files.hpp"
#include "records.hpp"

namespace gcdt::io {

/// A planar straight-line graph as read.
struct Input {
  std::vector<std::array<double, 2>> vertices;
  std::vector<Constraint> constraints;  ///< vertex numbers from 0, whatever the file's first number is
  std::uint32_t first = 0;              ///< the number of the first vertex in the file: 0 or 1
  std::uint32_t first_constraint = 0;   ///< the number of the first segment in the file: 0 or 1
  LineNumbers vertex_lines, constraint_lines;
  std::string vertex_file, constraint_file;  ///< as named in messages
  std::vector<std::string> files;            ///< paths of all files read
  std::vector<std::string> notes;            ///< what was read and is not used
};

/// Reads a .poly, .node, .geojson or .json file by its extension; "-" is standard input and read as .poly.
/// Throws Failure: Exit::usage for another extension, Exit::input with FILE:LINE for what is wrong inside.
/// Memory is bounded by the size of the file, whatever counts it announces.
Input read_input(const std::string& path);

/// A mesh read back from .ele (and .neigh), for verification.
struct MeshFile {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertex numbers from 0
  std::vector<std::array<std::int32_t, 3>> neighbours;  ///< empty if the file holds none
  std::vector<std::uint8_t> constrained;                ///< empty if the file holds none
  std::vector<std::array<double, 2>> vertices;          ///< empty if the file holds none
  std::optional<Grid> grid;
};

/// Reads an .ele file over `vertex_count` vertices numbered from `first`, or a .neigh file and the
/// .ele beside it. Throws Failure: Exit::input, or Exit::check for a number that does not exist.
MeshFile read_mesh(const std::string& path, std::uint64_t vertex_count, std::uint32_t first);

/// The vertices of the .node beside an .ele or .neigh, if there is one that begins with those of the input; else
/// those of the input.
std::vector<std::array<double, 2>> vertices_beside(const std::string& path, const Input& input);

/// One result to be written, in the input's numbering.
struct Result {
  const Input& input;
  const Triangulation& mesh;

  /// The vertices of the input, then those that splitting added.
  std::size_t vertex_count() const { return input.vertices.size() + mesh.added.size(); }
  const std::array<double, 2>& vertex(std::size_t v) const {
    return v < input.vertices.size() ? input.vertices[v] : mesh.added[v - input.vertices.size()];
  }
};

void write_ele(OutputFile& file, const Result& result);
void write_node(OutputFile& file, const Result& result);
void write_neigh(OutputFile& file, const Result& result);
/// Every edge once; marker 1 for constrained edges and 0 for others.
void write_edge(OutputFile& file, const Result& result);
/// All vertices and the constraints after cleaning, marker 1.
void write_poly(OutputFile& file, const Result& result);

/// Calls visit(a, b, constrained) for every edge of the mesh, once: from the lesser triangle of its two.
template <class Visit>
void for_each_edge(const Triangulation& mesh, Visit&& visit) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t across = mesh.neighbours[t][k];
      if (across >= 0 && static_cast<std::size_t>(across) < t) continue;
      const auto& corners = mesh.triangles[t];
      visit(corners[(k + 1) % 3], corners[(k + 2) % 3], (mesh.constrained[t] >> k & 1) != 0);
    }
}

}  // namespace gcdt::io

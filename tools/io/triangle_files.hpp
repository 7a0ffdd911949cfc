// SPDX-License-Identifier: Apache-2.0
// Triangle's formats: .poly and .node in; .ele, .node, .neigh, .edge and .poly out; .ele and .neigh back in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "mesh_arrays.hpp"
#include "output_files.hpp"
#include "records.hpp"

namespace gcdt::io {

/// More attributes a vertex than any file that means them.
constexpr std::uint64_t max_attributes = 1000;

/// A planar straight-line graph as read.
struct Input {
  std::vector<std::array<double, 2>> vertices;
  std::vector<Constraint> constraints;  ///< vertex numbers from 0, whatever the file's first number is
  std::uint32_t attribute_count = 0;    ///< of each vertex
  std::vector<double> attributes;       ///< attribute_count a vertex
  bool heights = false;                 ///< the first attribute is the vertices' z
  std::vector<std::int32_t> vertex_markers, constraint_markers;  ///< empty if the file has none
  std::vector<std::array<double, 2>> holes;                      ///< points
  struct Region {
    std::array<double, 2> point;
    double attribute = 0, largest_area = -1;  ///< the area is carried through, and not used
  };
  std::vector<Region> regions;
  std::uint32_t first = 0;             ///< the number of the first vertex in the file: 0 or 1
  std::uint32_t first_constraint = 0;  ///< the number of the first segment in the file: 0 or 1
  LineNumbers vertex_lines, constraint_lines;
  std::string vertex_file, constraint_file;  ///< as named in messages
  std::vector<std::string> files;            ///< paths of all files read
  std::vector<std::string> notes;            ///< what was read and is not used
};

/// Reads a file in the format of its extension (inputs.hpp); "-" is standard input and read as .poly.
/// Throws Failure: Exit::usage for another extension, Exit::input with FILE:LINE, or the byte, for what is wrong
/// inside. Memory is bounded by the size of the file, whatever counts it announces.
Input read_input(const std::string& path);

/// A mesh read back from .ele (and .neigh) or .vtu.
struct MeshFile {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertex numbers from 0
  std::vector<std::array<std::int32_t, 3>> neighbours;  ///< empty if the file holds none
  std::vector<std::uint8_t> constrained;                ///< empty if the file holds none
  std::vector<std::uint32_t> region, depth;             ///< empty if the file holds none
  std::vector<std::int32_t> winding;                    ///< empty if the file holds none
  std::vector<std::array<double, 2>> vertices;          ///< empty if the file holds none
  std::uint32_t attribute_count = 0;                    ///< of each vertex, where the file holds vertices
  std::vector<double> attributes;                       ///< attribute_count a vertex
  std::optional<Grid> grid;
};

/// Reads an .ele file over `vertex_count` vertices numbered from `first`, or a .neigh file and the
/// .ele beside it. Throws Failure: Exit::input, or Exit::check for a number that does not exist.
MeshFile read_mesh(const std::string& path, std::uint64_t vertex_count, std::uint32_t first);

/// The vertices of the .node beside an .ele or .neigh, if there is one that begins with those of the input; else
/// those of the input.
std::vector<std::array<double, 2>> vertices_beside(const std::string& path, const Input& input);

/// One attribute of all vertices of an input.
std::vector<double> attribute_of(const Input& input, std::uint32_t k);

/// One result to be written, in the input's numbering.
struct Result {
  const Input& input;
  const MeshArrays mesh;
  std::vector<double> added_attributes;  ///< as the input's, of added vertices: see gcdt::added_values
  bool coloured_by_angle = false;        ///< pictures colour triangles by their least angle, else by region

  Result(const Input& of, const MeshArrays& made);

  /// The vertices of the input, then those that splitting and refinement added.
  std::size_t vertex_count() const { return input.vertices.size() + mesh.added.size(); }
  const std::array<double, 2>& vertex(std::size_t v) const {
    return v < input.vertices.size() ? input.vertices[v] : mesh.added[v - input.vertices.size()];
  }
  double attribute(std::size_t v, std::uint64_t k) const {
    const std::size_t i = v * input.attribute_count + k;
    return i < input.attributes.size() ? input.attributes[i] : added_attributes[i - input.attributes.size()];
  }
  /// Of added vertices that of the lesser constraint that crosses there, or of the least that the vertex is on; 0
  /// without one.
  std::int32_t vertex_marker(std::size_t v) const {
    if (v < input.vertex_markers.size()) return input.vertex_markers[v];
    const std::size_t i = v - input.vertices.size();
    const std::uint32_t crossing = mesh.added_crossing[i][0],
                        constraint = crossing != UINT32_MAX ? crossing : mesh.added_origin[i][3];
    return constraint < input.constraint_markers.size() ? input.constraint_markers[constraint] : 0;
  }
};

void write_ele(OutputFile& file, const Result& result);
void write_node(OutputFile& file, const Result& result);
void write_neigh(OutputFile& file, const Result& result);
/// Every edge once; marker 0 for unconstrained edges; constrained ones have that of the input's first segment along
/// them with a marker that is not 0, else 1.
void write_edge(OutputFile& file, const Result& result);
/// All vertices, the constraints after cleaning with markers as in .edge, holes and regions of the input.
void write_poly(OutputFile& file, const Result& result);

/// Calls visit(a, b, constrained) for every edge of the mesh, once: from the lesser triangle of its two.
template <class Visit>
void for_each_edge(const MeshArrays& mesh, Visit&& visit) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t across = mesh.neighbours[t][k];
      if (across >= 0 && static_cast<std::size_t>(across) < t) continue;
      const auto& corners = mesh.triangles[t];
      visit(corners[(k + 1) % 3], corners[(k + 2) % 3], (mesh.constrained[t] >> k & 1) != 0);
    }
}

}  // namespace gcdt::io

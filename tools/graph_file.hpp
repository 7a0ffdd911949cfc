// SPDX-License-Identifier: Apache-2.0
// A planar straight-line graph that is taken apart, and its .poly.
#pragma once

#include <string>

#include "io/triangle_files.hpp"

namespace gcdt::command {

/// Without elements `first` up to `end`; of an array that is not there, nothing.
template <class T>
void erase_from(std::vector<T>& all, std::size_t first, std::size_t end) {
  if (all.empty()) return;
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(first), all.begin() + static_cast<std::ptrdiff_t>(end));
}

struct GraphFile {
  std::vector<std::array<double, 2>> vertices;
  std::vector<Constraint> constraints;
  std::uint32_t attribute_count = 0;  ///< of each vertex
  std::vector<double> attributes;
  std::vector<std::int32_t> vertex_markers, constraint_markers;  ///< empty, or one each
  std::vector<std::array<double, 2>> holes;
  std::vector<io::Input::Region> regions;

  /// Without the vertices from `first` up to `end`, and the constraints that end there.
  void erase(std::size_t first, std::size_t end);
  /// The same of constraints.
  void erase_constraints(std::size_t first, std::size_t end);
};

GraphFile graph_of(const io::Input& input);

/// Writes a .poly with numbers from 0, in as many digits as bring back the same doubles.
void write_graph(const std::string& path, const GraphFile& graph);

}  // namespace gcdt::command

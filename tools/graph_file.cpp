// SPDX-License-Identifier: Apache-2.0
#include "graph_file.hpp"

#include "io/output_files.hpp"

namespace gcdt::command {

void GraphFile::erase(std::size_t first, std::size_t end) {
  erase_from(vertices, first, end);
  erase_from(vertex_markers, first, end);
  erase_from(attributes, first * attribute_count, end * attribute_count);
  const auto gone = static_cast<std::uint32_t>(end - first);
  std::size_t kept = 0;
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    Constraint ends = constraints[c];
    bool there = true;
    for (std::uint32_t& v : ends) {
      there = there && (v < first || v >= end);
      if (v >= end) v -= gone;
    }
    if (!there) continue;
    if (!constraint_markers.empty()) constraint_markers[kept] = constraint_markers[c];
    constraints[kept++] = ends;
  }
  constraints.resize(kept);
  if (!constraint_markers.empty()) constraint_markers.resize(kept);
}

void GraphFile::erase_constraints(std::size_t first, std::size_t end) {
  erase_from(constraints, first, end);
  erase_from(constraint_markers, first, end);
}

GraphFile graph_of(const io::Input& input) {
  GraphFile graph;
  graph.vertices = input.vertices, graph.constraints = input.constraints;
  graph.attribute_count = input.attribute_count, graph.attributes = input.attributes;
  graph.vertex_markers = input.vertex_markers, graph.constraint_markers = input.constraint_markers;
  graph.holes = input.holes, graph.regions = input.regions;
  return graph;
}

void write_graph(const std::string& path, const GraphFile& graph) {
  io::OutputFiles files;
  io::OutputFile& file = files.add(path);
  file.print("{} 2 {} {}\n", graph.vertices.size(), graph.attribute_count, graph.vertex_markers.empty() ? 0 : 1);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    file.print("{} {} {}", v, graph.vertices[v][0], graph.vertices[v][1]);
    for (std::size_t k = 0; k < graph.attribute_count; ++k)
      file.print(" {}", graph.attributes[v * graph.attribute_count + k]);
    if (!graph.vertex_markers.empty()) file.print(" {}", graph.vertex_markers[v]);
    file.write("\n");
  }
  file.print("{} {}\n", graph.constraints.size(), graph.constraint_markers.empty() ? 0 : 1);
  for (std::size_t c = 0; c < graph.constraints.size(); ++c) {
    file.print("{} {} {}", c, graph.constraints[c][0], graph.constraints[c][1]);
    if (!graph.constraint_markers.empty()) file.print(" {}", graph.constraint_markers[c]);
    file.write("\n");
  }
  file.print("{}\n", graph.holes.size());
  for (std::size_t i = 0; i < graph.holes.size(); ++i)
    file.print("{} {} {}\n", i, graph.holes[i][0], graph.holes[i][1]);
  if (!graph.regions.empty()) file.print("{}\n", graph.regions.size());
  for (std::size_t i = 0; i < graph.regions.size(); ++i) {
    const io::Input::Region& region = graph.regions[i];
    file.print("{} {} {} {} {}\n", i, region.point[0], region.point[1], region.attribute, region.largest_area);
  }
  files.commit();
}

}  // namespace gcdt::command

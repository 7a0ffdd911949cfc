// SPDX-License-Identifier: Apache-2.0
#include "mesh_input.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "npz.hpp"
#include "paths.hpp"
#include "vtu.hpp"

namespace gcdt::io {

namespace {

namespace fs = std::filesystem;

MeshInput read_ele_and_node(const std::string& path) {
  const std::string node = fs::path(path).replace_extension(".node").string();
  std::error_code ignored;
  if (!fs::exists(node, ignored))
    throw Failure(Exit::input, fmt::format("{}: no file {} beside it, which would have the vertices", path, node));
  MeshInput read;
  read.input = read_input(node);
  read.input.files.push_back(path);
  read.mesh = read_mesh(path, read.input.vertices.size(), read.input.first);
  return read;
}

MeshInput read_vtu_whole(const std::string& path) {
  MeshInput read;
  read.mesh = read_vtu(path);
  read.input.vertices = std::move(read.mesh.vertices);
  read.input.attributes = std::move(read.mesh.attributes);
  read.input.attribute_count = read.mesh.attribute_count;
  read.input.vertex_file = path;
  read.input.files = {path};
  for (std::size_t v = 0; v < read.input.vertices.size(); ++v)
    for (const double c : read.input.vertices[v])
      if (!(c - c == 0)) throw Failure(Exit::input, fmt::format("{}: point {} is not finite", path, v));
  return read;
}

}  // namespace

bool holds_mesh(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".ele" || extension == ".vtu" || (extension == ".npz" && npz_holds_mesh(path));
}

MeshInput read_mesh_input(const std::string& path) {
  try {
    const std::string extension = lower_extension(path);
    if (extension == ".npz") return read_npz_mesh(path);
    return extension == ".vtu" ? read_vtu_whole(path) : read_ele_and_node(path);
  } catch (const Failure& failure) {
    // To verify, a number that does not exist is a result that is wrong; here it is an input that is.
    throw Failure(failure.exit() == Exit::check ? Exit::input : failure.exit(), failure.what());
  }
}

std::optional<FixedGrid> given_grid(const Grid& grid) {
  if (grid.kind != Grid::Kind::fixed) return std::nullopt;
  return FixedGrid{grid.origin[0], grid.origin[1],
                   grid.cell_units > 0 ? fmt::format("{}e{}", grid.cell_units, -grid.cell_decimals)
                                       : fmt::format("{}", grid.cell())};
}

}  // namespace gcdt::io

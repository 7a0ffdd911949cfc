// SPDX-License-Identifier: Apache-2.0
#include "outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "npz.hpp"
#include "paths.hpp"
#include "picture.hpp"
#include "svg.hpp"
#include "vtu.hpp"

namespace gcdt::io {

const std::vector<OutputFormat>& output_formats() {
  static const std::vector<OutputFormat> formats = {
      {".ele", write_ele},         {".node", write_node}, {".neigh", write_neigh}, {".edge", write_edge},
      {".poly", write_poly},       {".vtu", write_vtu},   {".svg", write_svg},     {".png", write_png},
      {".pdf", write_pdf},         {".pslg", write_pslg}, {".npz", write_npz},     {".npy", write_npy},
      {".ply", write_ply},         {".obj", write_obj},   {".off", write_off},     {".msh", write_msh},
      {".geojson", write_geojson},
  };
  return formats;
}

Write writer_for(const std::string& extension) {
  for (const OutputFormat& format : output_formats())
    if (extension == format.extension) return format.write;
  return nullptr;
}

std::string output_extensions(bool dots) {
  std::string all;
  for (const OutputFormat& format : output_formats())
    all += (all.empty() ? "" : " ") + std::string(format.extension + (dots ? 0 : 1));
  return all;
}

std::vector<std::string> with_nodes(const std::vector<std::string>& outputs, bool added,
                                    const std::vector<std::string>& inputs) {
  std::vector<std::string> paths = outputs;
  if (!added) return paths;
  for (const std::string& path : outputs) {
    if (lower_extension(path) != ".ele") continue;
    const std::string node = std::filesystem::path(path).replace_extension(".node").string();
    if (std::any_of(paths.begin(), paths.end(), [&](const std::string& other) { return same_file(node, other); }))
      continue;
    for (const std::string& input : inputs)
      if (input != "-" && same_file(node, input))
        throw Failure(Exit::usage,
                      fmt::format("{}: is an input, but {} needs it for the added vertices: name another", node, path));
    paths.push_back(node);
  }
  return paths;
}

}  // namespace gcdt::io

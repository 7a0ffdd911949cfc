// SPDX-License-Identifier: Apache-2.0
#include "outputs.hpp"

#include "npz.hpp"
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

}  // namespace gcdt::io

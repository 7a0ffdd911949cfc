// SPDX-License-Identifier: Apache-2.0
// The output formats by extension.
#pragma once

#include <string>

#include "svg.hpp"
#include "triangle_files.hpp"
#include "vtu.hpp"

namespace gcdt::io {

using Write = void (*)(OutputFile&, const Result&);

/// The writer for an extension in lower case, such as ".ele"; null if there is none.
inline Write writer_for(const std::string& extension) {
  if (extension == ".ele") return write_ele;
  if (extension == ".node") return write_node;
  if (extension == ".neigh") return write_neigh;
  if (extension == ".edge") return write_edge;
  if (extension == ".poly") return write_poly;
  if (extension == ".vtu") return write_vtu;
  if (extension == ".svg") return write_svg;
  return nullptr;
}

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
// The output formats by extension.
#pragma once

#include <string>
#include <vector>

#include "triangle_files.hpp"

namespace gcdt::io {

using Write = void (*)(OutputFile&, const Result&);

struct OutputFormat {
  const char* extension;  ///< in lower case, with its dot
  Write write;
};

const std::vector<OutputFormat>& output_formats();

/// The writer for an extension in lower case, such as ".ele"; null if there is none.
Write writer_for(const std::string& extension);

/// The extensions, separated by blanks; without their dots, if these are not wanted.
std::string output_extensions(bool dots = true);

/// What is written for `outputs`: with `added` vertices an .ele gets the .node that has them. Throws Failure if that is
/// one of the `inputs`.
std::vector<std::string> with_nodes(const std::vector<std::string>& outputs, bool added,
                                    const std::vector<std::string>& inputs);

/// .pslg: vertices, and the constraints after cleaning, binary.
void write_pslg(OutputFile& file, const Result& result);
/// .ply, .obj and .off: vertices, with the heights of the input if it has any, and triangles; .ply in binary, .obj
/// with the constrained edges as lines.
void write_ply(OutputFile& file, const Result& result);
void write_obj(OutputFile& file, const Result& result);
void write_off(OutputFile& file, const Result& result);
/// .geojson: a polygon for each triangle, with its numbers as properties.
void write_geojson(OutputFile& file, const Result& result);
/// .msh of gmsh, version 2.2, ascii: triangles by region, constrained edges by marker.
void write_msh(OutputFile& file, const Result& result);

/// The third coordinate of a vertex: its height if the input has heights, else 0.
inline double height(const Result& result, std::size_t v) { return result.input.heights ? result.attribute(v, 0) : 0; }

}  // namespace gcdt::io

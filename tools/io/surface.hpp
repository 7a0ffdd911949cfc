// SPDX-License-Identifier: Apache-2.0
// What formats of surfaces in space share: heights, and faces as edges.
#pragma once

#include <algorithm>
#include <vector>

#include "triangle_files.hpp"

namespace gcdt::io {

/// The z of vertices, which are an attribute if any is not 0.
class Heights {
 public:
  void add(double z) { heights_.push_back(z); }
  void give(Input& input) {
    if (std::all_of(heights_.begin(), heights_.end(), [](double z) { return z == 0; })) return;
    input.attribute_count = 1;
    input.attributes = std::move(heights_);
    input.heights = true;
  }

 private:
  std::vector<double> heights_;
};

/// The corners, one after the other, as constraints; of a face also from the last to the first.
inline void join(const std::vector<std::uint32_t>& corners, bool face, std::uint64_t line, Input& input) {
  for (std::size_t i = 0; i + (face ? 0 : 1) < corners.size(); ++i) {
    input.constraints.push_back({corners[i], corners[(i + 1) % corners.size()]});
    if (line > 0) input.constraint_lines.append(line);
  }
}

}  // namespace gcdt::io

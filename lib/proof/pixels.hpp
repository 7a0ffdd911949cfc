// SPDX-License-Identifier: Apache-2.0
// The host's own search for the vertices whose pixels a segment meets (docs/splitting.md): a k-d tree.
#pragma once

#include "proof/mesh.hpp"

namespace gcdt::proof {

/// Do the pixels of the grid points in [low, high] x [low, high], half-open squares around them, meet segment a-b, a !=
/// b?
bool meets_pixels(Vertex a, Vertex b, Vertex low, Vertex high);

/// Where the interiors of two segments cross, half up to the grid; none if they do not, or are parallel.
std::optional<Vertex> pixel_of_crossing(Vertex a, Vertex b, Vertex c, Vertex d);

class PixelTree {
 public:
  explicit PixelTree(const Sites& sites);
  /// The representatives whose pixels segment a-b meets, in the order along it; the ends are the first and the last.
  std::vector<std::uint32_t> along(std::uint32_t a, std::uint32_t b) const;

 private:
  struct Node {
    Vertex low, high;  ///< of the vertices in [begin, end)
    std::uint32_t begin, end;
  };
  void build(std::size_t number, std::uint32_t begin, std::uint32_t end);
  void visit(std::size_t number, Vertex a, Vertex b, std::vector<std::uint32_t>& found) const;

  const Sites& sites_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;  ///< the children of node i are 2 i + 1 and 2 i + 2
};

/// Marks those of `segments` that cross another one in a pixel that both meet. Returns the first failure of the added
/// vertices, those from `inputs` on, to be the pixels of these crossings, all of them.
std::string find_crossing(const Sites& sites, const PixelTree& tree, std::uint32_t inputs,
                          const std::vector<Segment>& segments, std::vector<bool>& crosses);

}  // namespace gcdt::proof

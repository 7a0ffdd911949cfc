// SPDX-License-Identifier: Apache-2.0
#include "markers.hpp"

#include <algorithm>

namespace gcdt::io {

PieceMarkers::PieceMarkers(const Result& result) : result_(result) {
  const auto& pieces = result.mesh.pieces;
  if (result.input.constraint_markers.empty()) return;
  for (std::uint32_t i = 0; i < pieces.size(); ++i) by_ends_.emplace_back(std::minmax(pieces[i][0], pieces[i][1]), i);
  std::sort(by_ends_.begin(), by_ends_.end());
}

std::int32_t PieceMarkers::of_piece(std::size_t piece) const {
  if (result_.input.constraint_markers.empty()) return 1;
  for (std::uint32_t i = result_.mesh.source_offsets[piece]; i < result_.mesh.source_offsets[piece + 1]; ++i)
    if (const std::int32_t marker = result_.input.constraint_markers[result_.mesh.sources[i]]) return marker;
  return 1;
}

std::int32_t PieceMarkers::of_edge(std::uint32_t a, std::uint32_t b) const {
  const auto found = std::lower_bound(by_ends_.begin(), by_ends_.end(), Entry{std::minmax(a, b), 0});
  return found == by_ends_.end() ? 1 : of_piece(found->second);
}

double region_attribute(const Result& result, std::size_t t) {
  const std::int32_t seed = result.mesh.region_seed[t];
  return seed < 0 ? 0 : result.input.regions[static_cast<std::size_t>(seed)].attribute;
}

}  // namespace gcdt::io

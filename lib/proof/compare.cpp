// SPDX-License-Identifier: Apache-2.0
// A mesh that is given, against the one that is right.
#include <algorithm>

#include "proof/whole.hpp"

namespace gcdt::proof {

namespace {

/// The triangle with its least corner first: a key that does not depend on the first corner.
std::array<std::uint32_t, 3> key_of(std::array<std::uint32_t, 3> corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace

Comparison::Comparison(const Completion& mesh, const std::vector<char>& keep, const std::vector<char>& flags,
                       const MeshView& view)
    : mesh_(mesh), flags_(flags), view_(view), given_of_(mesh.triangles().size(), none) {
  for (std::uint32_t t = 0; t < given_of_.size(); ++t)
    if (keep[t]) expected_.push_back({key_of(mesh.triangles()[t]), t});
  std::sort(expected_.begin(), expected_.end());
}

std::string Comparison::run() {
  auto reason = match();
  for (std::uint32_t g = 0; g < view_.triangles.size() && reason.empty(); ++g) reason = compare_edges(g);
  return reason;
}

std::string Comparison::name(std::uint32_t g) const {
  const auto& [a, b, c] = view_.triangles[g];
  return say("triangle ", g, " (", a, ", ", b, ", ", c, ")");
}

std::string Comparison::match() {
  for (std::uint32_t g = 0; g < view_.triangles.size(); ++g) {
    const auto key = key_of(view_.triangles[g]);
    const auto found = std::lower_bound(expected_.begin(), expected_.end(), Entry{key, 0});
    if (found == expected_.end() || found->first != key)
      return say(name(g), " is not one of the domain's in the constrained Delaunay triangulation");
    if (given_of_[found->second] != none) return say(name(g), " occurs twice");
    given_of_[found->second] = g;
    right_of_.push_back(found->second);
  }
  for (const auto& [key, t] : expected_)
    if (given_of_[t] == none)
      return say("the triangle (", key[0], ", ", key[1], ", ", key[2], ") belongs to the domain, but is missing");
  return {};
}

std::string Comparison::compare_edges(std::uint32_t g) const {
  const auto& corners = mesh_.triangles()[right_of_[g]];
  if (view_.constrained && view_.constrained[g] > 7) return say(name(g), " has flags of edges it does not have");
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t corner = view_.triangles[g][k];
    const auto j = static_cast<std::uint32_t>(std::find(corners.begin(), corners.end(), corner) - corners.begin());
    const std::uint32_t h = 3 * right_of_[g] + j, twin = mesh_.twin(h);
    const std::int64_t beyond = twin == none || given_of_[twin / 3] == none ? -1 : std::int64_t(given_of_[twin / 3]);
    if (view_.neighbours && view_.neighbours[g][k] != beyond)
      return say(name(g), ": the neighbour across from vertex ", corner, " is ", beyond, ", not ",
                 view_.neighbours[g][k]);
    if (view_.constrained && (view_.constrained[g] >> k & 1) != int(flags_[h]))
      return say(name(g), ": the edge across from vertex ", corner, " is ",
                 flags_[h] ? "constrained, but not flagged" : "flagged, but not constrained");
  }
  return {};
}

}  // namespace gcdt::proof

// SPDX-License-Identifier: Apache-2.0
// Triangulates what a new constraint leaves on one side of it, for the proof of domains.
#pragma once

#include <array>
#include <random>
#include <vector>

#include "proof/mesh.hpp"

namespace gcdt::proof {

/// The polygon of a path of vertices and the constraint that closes it, from the path's end back to its begin, where
/// the path has come about by removing all triangles that the constraint crosses from a constrained Delaunay
/// triangulation, and lies on the constraint's left. A vertex may be on the path several times. Here corners are places
/// on the path, and half-edges are numbered as in mesh.hpp.
///
/// The algorithm is that of Shewchuk and Brown (Fast segment insertion and incremental construction of constrained
/// Delaunay triangulations, 2015): places are taken off the path in random order, then put back in the reverse one,
/// each with the triangles that it covers removed and a fan from it in their stead. By looking backwards: what putting
/// a place back costs is the number of its triangles then, on average less than four; more than half of the places may
/// be taken off (those that are not nearer to the constraint than both neighbours), so the expected cost is less than
/// eight a place, and linear in all. If a place went that is nearer than both neighbours, the path could cross itself,
/// and a triangle come out turned over.
class Cavity {
 public:
  Cavity(const Sites& sites, std::uint64_t& steps) : sites_(sites), steps_(steps) {}

  /// Makes a triangulation that is constrained Delaunay, or nearly: flips may be left to do.
  void triangulate(const std::vector<std::uint32_t>& path);

  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  std::uint32_t twin(std::uint32_t h) const { return twins_[h]; }  ///< none on the polygon
  /// The half-edge from a place on the path to the next one; of the last place: along the constraint.
  std::uint32_t along(std::uint32_t place) const { return along_[place]; }

 private:
  struct Hidden {  // from the place that is put back: an edge, and the half-edge on its other side
    std::uint32_t from, to, half_edge;
  };
  std::int64_t turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return sites_.turn(path_[a], path_[b], path_[c]);
  }
  void take_off(std::uint32_t place);
  void take_off_at_random();
  void put_back();
  void put_back(std::uint32_t place);
  bool covers(std::uint32_t place, const Hidden& edge) const;
  void link(std::uint32_t h, std::uint32_t other) { twins_[h] = other, twins_[other] = h; }
  std::uint32_t add(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  const Sites& sites_;
  std::uint64_t& steps_;
  std::vector<std::uint32_t> path_, next_, previous_, order_, along_;
  std::vector<std::int64_t> distances_;  // from the constraint, times its length
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> twins_, unused_;
  std::vector<Hidden> hidden_;
  std::minstd_rand random_;
};

}  // namespace gcdt::proof

// SPDX-License-Identifier: Apache-2.0
// The whole mesh of an input, made once more by another algorithm for the proof of a part of it, with its regions.
#pragma once

#include <algorithm>
#include <optional>

#include "proof/complete.hpp"
#include "proof/domain.hpp"
#include "proof/mesh.hpp"

namespace gcdt::proof {

/// Vertices of the mesh, all representatives; between each and the next runs a straight chain of edges.
using Path = std::vector<std::uint32_t>;

/// The whole mesh, and the path of each constraint that is in it, from its first end to its second.
struct Rebuilt {
  const Sites& sites;
  const std::uint32_t inputs;
  const Constraints constraints;
  const Crossing crossing;
  std::uint64_t& steps;
  std::optional<Completion> mesh = {};
  std::vector<Path> paths = {};

  /// Returns the first failure.
  std::string run();

 private:
  std::uint32_t end(std::size_t c, std::size_t k) const { return sites.representative[constraints[c][k]]; }
  bool insert(const Path& path);
  std::string insert_whole();
  std::string insert_ordered(const std::vector<std::uint32_t>& order, std::vector<char>& there);
  std::string insert_split();
};

/// The regions of a complete mesh in canonical order, with depths and windings.
class Flood {
 public:
  /// `proved`: the same mesh, half-edge by half-edge, after prove_topology().
  Flood(const Completion& mesh, const Mesh& proved, const std::vector<Path>& paths);

  std::vector<std::uint32_t> region, depth;  ///< by triangle; by region
  std::vector<std::int32_t> winding;         ///< by region
  std::uint32_t count = 0;

 private:
  void fill(std::uint32_t first, std::uint32_t number);
  void search();

  const Completion& mesh_;
  std::vector<std::int32_t> turns_;
};

/// By region: the least of the seeds whose least triangle is in it, border included; none without one.
std::vector<std::uint32_t> seeded(const Sites& sites, const Completion& mesh, const Flood& flood, const Grid& grid,
                                  const std::vector<std::array<double, 2>>& seeds, std::uint64_t& steps);

/// Which triangles are those of the domain. `steps` grows by what finding the hole seeds looks at.
std::vector<char> chosen(const Sites& sites, const Completion& mesh, const Flood& flood, const Grid& grid,
                         const Options& options, std::uint64_t& steps);

/// The mesh that is given, against the one that is right.
class Comparison {
 public:
  /// `keep`: which triangles of `mesh` should be there; `flags`: which of its half-edges should be flagged.
  Comparison(const Completion& mesh, const std::vector<char>& keep, const std::vector<char>& flags,
             const MeshView& view);

  /// The first failure. Neighbours and flags are compared where there are any.
  std::string run();

  /// After run(): the triangle of `mesh` that each given one is.
  const std::vector<std::uint32_t>& right_of() const { return right_of_; }
  std::string name(std::uint32_t given) const;

 private:
  using Entry = std::pair<std::array<std::uint32_t, 3>, std::uint32_t>;

  std::string match();
  std::string compare_edges(std::uint32_t given) const;

  const Completion& mesh_;
  const std::vector<char>& flags_;
  const MeshView& view_;
  std::vector<Entry> expected_;
  std::vector<std::uint32_t> given_of_;  // by right triangle
  std::vector<std::uint32_t> right_of_;  // by given triangle
};

}  // namespace gcdt::proof

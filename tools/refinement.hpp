// SPDX-License-Identifier: Apache-2.0
// What the command says of quality refinement: its options, and what the library makes of them.
#pragma once

#include <optional>
#include <vector>

#include <gcdt/gcdt.hpp>
#include <gcdt/verify.hpp>

#include "io/triangle_files.hpp"

namespace CLI {
class App;
}

namespace gcdt::command {

struct RefineArguments {
  std::optional<double> angle;  ///< degrees; none: no refinement
  std::optional<double> most_area, least_length;
  std::optional<std::int64_t> size;  ///< the attribute that is the length wanted, from 1
  std::optional<std::int64_t> most_added;
  bool conforming = false, region_areas = false, no_border_split = false, no_split = false;
};

/// Adds the options to `app`.
void add_refinement(CLI::App& app, RefineArguments& arguments);

/// Throws io::Failure (Exit::usage) for values that make no sense.
void check_refinement(const RefineArguments& arguments);

/// As gcdt::verify_refined(), but up to `left` triangles may be worse than wanted without an excuse that the mesh
/// itself shows: those that the refinement has counted as such (docs/refinement.md, `refused`).
RefinedVerification verify_refined_but(std::uint64_t left, const io::Input& input, const MeshView& view,
                                       const Grid& grid, const Options& options);

/// How many triangles, and sides with a corner in their circle, a refinement has counted whose excuse the mesh does not
/// show.
inline std::uint64_t uncovered(const Statistics& s) {
  return s.refine.left_refused + s.refine.left_fixed + s.refine.left_limit + s.refine.encroached;
}

/// What the options say by themselves: without the lengths and areas that an input has. Nothing without --refine.
std::optional<Refinement> wanted_by(const RefineArguments& arguments);

/// What an input is to be refined to, with the lengths and areas that it has. To be kept as long as its options.
class InputRefinement {
 public:
  /// Throws io::Failure (Exit::input) for lengths or areas that the input lacks, or that are not above 0.
  InputRefinement(const RefineArguments& arguments, const io::Input& input);
  InputRefinement(const InputRefinement&) = delete;
  InputRefinement& operator=(const InputRefinement&) = delete;

  /// Nothing if it is not to be refined.
  const std::optional<Refinement>& wanted() const { return wanted_; }

 private:
  std::optional<Refinement> wanted_;
  std::vector<double> sizes_, areas_;
};

}  // namespace gcdt::command

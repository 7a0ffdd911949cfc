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

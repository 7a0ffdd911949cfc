// SPDX-License-Identifier: Apache-2.0
#include "refinement.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "io/failure.hpp"

namespace gcdt::command {

namespace {

using io::Exit;
using io::Failure;

void require(bool right, const char* option, const char* must_be, double value) {
  if (!right) throw Failure(Exit::usage, fmt::format("{} must be {}, not {}", option, must_be, value));
}

}  // namespace

void add_refinement(CLI::App& app, RefineArguments& arguments) {
  const std::string group = "Refinement";
  CLI::Option* refine =
      app.add_option(
             "--refine", arguments.angle,
             "Add vertices until no triangle of the domain has an angle below ANGLE, 1 to 34 degrees (20 suits "
             "most; from 30 on with --max-vertices), as far as the input's own angles let that be; 0: angles do "
             "not matter")
          ->type_name("ANGLE")
          ->group(group);
  const auto option = [&](const char* name, auto& value, const char* what, const char* type) {
    app.add_option(name, value, what)->type_name(type)->group(group)->needs(refine);
  };
  const auto flag = [&](const char* name, bool& value, const char* what) {
    return app.add_flag(name, value, what)->group(group)->needs(refine);
  };
  option("--max-area", arguments.most_area, "No triangle is larger, in units of the input squared", "AREA");
  flag("--region-areas", arguments.region_areas,
       "The largest areas are those of the input's regions, where they have one");
  option("--size", arguments.size,
         "Attribute K of the vertices, from 1, is the length wanted there: the longest side of a triangle is at most "
         "sqrt(2) times the mean at its corners",
         "K");
  flag("--conforming", arguments.conforming, "Edges beside constraints are Delaunay, too (Triangle's -D)");
  option("--min-length", arguments.least_length, "Triangles with a shorter side are left as they are", "LENGTH");
  CLI::Option* border =
      flag("--no-border-split", arguments.no_border_split, "The border of the domain is not split (Triangle's -Y)");
  flag("--no-split", arguments.no_split, "No constraint is split (Triangle's -YY)")->excludes(border);
  option("--max-vertices", arguments.most_added,
         "At most N vertices are added; a limit that is reached is no error, but noted", "N");
}

void check_refinement(const RefineArguments& arguments) {
  if (!arguments.angle) return;
  const double angle = *arguments.angle;
  require(angle == 0 || (angle >= 1 && angle <= 34), "--refine", "0, or from 1 to 34 degrees", angle);
  const double area = arguments.most_area.value_or(1), length = arguments.least_length.value_or(1);
  require(area > 0, "--max-area", "above 0", area);
  require(length > 0 && length < HUGE_VAL, "--min-length", "a number above 0", length);
  const auto size = static_cast<double>(arguments.size.value_or(1)),
             most = static_cast<double>(arguments.most_added.value_or(0));
  require(size >= 1, "--size", "the number of an attribute, from 1", size);
  require(most >= 0, "--max-vertices", "0 or more", most);
}

std::optional<Refinement> wanted_by(const RefineArguments& arguments) {
  if (!arguments.angle) return {};
  Refinement r;
  r.least_angle = *arguments.angle;
  r.most_area = arguments.most_area.value_or(HUGE_VAL);
  r.least_length = arguments.least_length.value_or(0);
  if (arguments.most_added) r.most_added = static_cast<std::uint64_t>(*arguments.most_added);
  r.conforming = arguments.conforming;
  r.splits = arguments.no_split ? Splits::none : arguments.no_border_split ? Splits::inner : Splits::all;
  return r;
}

InputRefinement::InputRefinement(const RefineArguments& arguments, const io::Input& input)
    : wanted_(wanted_by(arguments)) {
  if (!wanted_) return;
  Refinement& r = *wanted_;
  if (arguments.region_areas) {
    for (const io::Input::Region& region : input.regions)
      areas_.push_back(region.largest_area > 0 ? region.largest_area : HUGE_VAL);  // -1 is Triangle's for none
    if (std::none_of(areas_.begin(), areas_.end(), [](double area) { return area < HUGE_VAL; }))
      throw Failure(Exit::input, fmt::format("{}: --region-areas: no region has an area", input.vertex_file));
    r.region_areas = areas_;
  }
  if (!arguments.size) return;
  if (*arguments.size > input.attribute_count)
    throw Failure(Exit::input, fmt::format("{}: --size {}: the vertices have {} attributes", input.vertex_file,
                                           *arguments.size, input.attribute_count));
  sizes_ = io::attribute_of(input, static_cast<std::uint32_t>(*arguments.size - 1));
  for (std::size_t v = 0; v < sizes_.size(); ++v)
    if (!(sizes_[v] > 0))
      throw Failure(Exit::input, fmt::format("{}: attribute {} of vertex {} is {}: lengths must be above 0",
                                             input.vertex_file, *arguments.size, v + input.first, sizes_[v]));
  r.sizes = sizes_;
}

}  // namespace gcdt::command

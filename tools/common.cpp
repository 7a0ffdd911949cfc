// SPDX-License-Identifier: Apache-2.0
#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include <gcdt/verify.hpp>

#include "command.hpp"
#include "io/grid_text.hpp"

namespace gcdt::command {

namespace {

/// FILE:LINE of a record that was read; FILE where the format has no lines.
std::string place(const std::string& file, const io::LineNumbers& lines, std::uint64_t index) {
  const std::uint64_t line = lines.of(index);
  return line == 0 ? file : fmt::format("{}:{}", file, line);
}

std::string segment(const io::Input& input, std::uint64_t c) {
  const auto& [a, b] = input.constraints[c];
  const std::uint64_t line = input.constraint_lines.of(c);
  return fmt::format("segment {} (vertices {} {}{})", c + input.first_constraint, a + input.first, b + input.first,
                     line == 0 ? "" : fmt::format(", line {}", line));
}

constexpr std::uint64_t pairs_in_message = 10;

std::string crossings(const Error& error, const io::Input& input, const Options& options) {
  const auto& pairs = error.indices();
  const std::uint64_t all = std::max<std::uint64_t>(error.pair_count(), pairs.size() / 2),
                      shown = std::min<std::uint64_t>(pairs.size() / 2, pairs_in_message);
  std::string text = fmt::format("{}: {} {} of constraints cross{}:", input.constraint_file, all,
                                 all == 1 ? "pair" : "pairs", all == 1 ? "es" : "");
  for (std::size_t i = 0; i < 2 * shown; i += 2)
    if (pairs[i] < input.constraints.size() && pairs[i + 1] < input.constraints.size())
      text += fmt::format("\n  {} and {}", segment(input, pairs[i]), segment(input, pairs[i + 1]));
  if (all > shown) text += fmt::format("\n  and {} more", all - shown);
  const Grid grid = choose_grid(input.vertices, options.grid);
  if (grid.kind == Grid::Kind::rounded || grid.kind == Grid::Kind::fixed)
    text += fmt::format(
        "\nthe vertices are rounded to a grid (cell {}, largest move {}), which can make clean input cross: --grid "
        "X,Y,CELL sets another",
        grid.cell(), grid.largest_move);
  return text +
         "\n--crossing drop leaves out every constraint that crosses an earlier one; --crossing split makes the "
         "crossings vertices";
}

std::string about_coordinate(const Error& error, const io::Input& input, const char* what) {
  const std::uint64_t vertex = error.indices()[0], axis = error.indices()[1] & 1;
  return fmt::format("{}: the {} coordinate of vertex {}, {}, {}", place(input.vertex_file, input.vertex_lines, vertex),
                     axis == 0 ? 'x' : 'y', vertex + input.first, input.vertices[vertex][axis], what);
}

std::string together(const io::Input& input, std::uint64_t a, std::uint64_t b) {
  const auto named = [&](std::uint64_t v) {
    return fmt::format("{} ({}, {})", v + input.first, input.vertices[v][0], input.vertices[v][1]);
  };
  return fmt::format("vertices {} and {} differ, but are one on the grid: --grid X,Y,CELL sets another", named(a),
                     named(b));
}

}  // namespace

std::string together_note(const io::Input& input, std::uint64_t count, const std::array<std::uint32_t, 2>& first) {
  if (count == 0) return {};
  return fmt::format(
      "{} {} from a lesser one that rounding has merged {} with, first {}; --distinct makes that an error, "
      "--assess says whether the mesh is valid as given",
      count, count == 1 ? "vertex differs" : "vertices differ", count == 1 ? "it" : "them",
      together(input, first[0], first[1]));
}

Crossing crossing_named(const std::string& name) {
  return name == "split" ? Crossing::split : name == "drop" ? Crossing::drop : Crossing::reject;
}

void set_domain(const std::string& name, const io::Input& input, Options& options) {
  options.domain = name == "even-odd"      ? Domain::even_odd
                   : name == "nonzero"     ? Domain::nonzero
                   : name == "holes"       ? Domain::holes
                   : name == "outer"       ? Domain::outer
                   : name == "outer-holes" ? Domain::outer_holes
                                           : Domain::hull;
  options.hole_seeds = input.holes;
  for (const io::Input::Region& region : input.regions) options.region_seeds.push_back(region.point);
}

std::optional<FixedGrid> grid_from_option(const std::string& text) {
  if (text.empty()) return std::nullopt;
  auto wrong = [&](const std::string& why) {
    return io::Failure(io::Exit::usage, fmt::format("--grid {}: {}", text, why));
  };
  const std::size_t first = text.find(','), second = text.find(',', first + 1);
  if (first == std::string::npos || second == std::string::npos) throw wrong("expected X,Y,CELL");
  auto coordinate = [&](std::size_t from, std::size_t to) {
    double value = 0;
    const auto [end, error] = fast_float::from_chars(text.data() + from, text.data() + to, value);
    if (error != std::errc() || end != text.data() + to || !(value - value == 0))
      throw wrong("X and Y must be finite numbers");
    return value;
  };
  FixedGrid grid{coordinate(0, first), coordinate(first + 1, second), text.substr(second + 1)};
  try {
    choose_grid({}, grid);  // the library reads the cell: better now than after a large file
  } catch (const Error& error) {
    if (error.status() == Status::invalid_argument) throw wrong(error.what());
  }
  return grid;
}

void check_is_file_name(const std::string& path) {
  if (path == "-") throw io::Failure(io::Exit::usage, "-: statistics and traces go to files");
}

io::Exit exit_for(Status status) {
  const detail::StatusRow* row = detail::row_of(status);
  return row ? static_cast<io::Exit>(row->exit) : io::Exit::device;
}

io::Failure explained(const Error& error, const io::Input& input, const Options& options) {
  std::string text = error.what();
  const bool names_vertex = error.indices().size() >= 2 && error.indices()[0] < input.vertices.size();
  if (error.status() == Status::constraints_cross) text = crossings(error, input, options);
  if (error.status() == Status::coordinate_outside_grid && names_vertex)
    text = about_coordinate(error, input, "lies outside the grid");
  if (error.status() == Status::coordinate_not_finite && names_vertex)
    text = about_coordinate(error, input, "is not finite");
  if (error.status() == Status::vertices_coincide && names_vertex)
    text = fmt::format("{}: {}", place(input.vertex_file, input.vertex_lines, error.indices()[1]),
                       together(input, error.indices()[0], error.indices()[1]));
  if (error.status() == Status::cancelled) text = "interrupted";
  return io::Failure(exit_for(error.status()), text);
}

void add_unused(const io::Input& input, const Options& options, std::vector<std::string>& notes) {
  const bool holes_used = options.domain == Domain::holes || options.domain == Domain::outer_holes;
  if (holes_used && input.holes.empty()) notes.push_back("the input has no holes");
  if (!holes_used && !input.holes.empty())
    notes.push_back(fmt::format("holes ({}) of the input are not used: see --domain", input.holes.size()));
  if (!input.regions.empty() && options.domain == Domain::hull && !options.regions &&
      !(options.refine && !options.refine->region_areas.empty()))
    notes.push_back(fmt::format("regions ({}) of the input are not used: see --regions", input.regions.size()));
}

// Files hold doubles, and where those are farther apart than the grid's lines, not all grid points are one.
std::string rounding_note(const io::MeshArrays& mesh) {
  const auto back = grid_points(mesh.statistics.grid, mesh.added);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < back.size(); ++i) moved += back[i] != mesh.added_on_grid[i];
  if (moved == 0) return {};
  return fmt::format(
      "{} of {} added vertices lie between doubles: files hold the nearest, and cannot be verified (--grid X,Y,CELL "
      "sets a coarser grid)",
      moved, back.size());
}

void complain(std::string text) {
  // Of names of files and of what they hold: no byte makes a terminal do more than write it.
  for (char& c : text)
    if (const auto byte = static_cast<unsigned char>(c); (byte < ' ' && c != '\n') || byte == 0x7f) c = '?';
  std::fputs(fmt::format("gcdt: {}\n", text).c_str(), stderr);
}

void note(const std::string& text) { complain("note: " + text); }

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw io::Failure(io::Exit::output, "standard output cannot be written");
}

}  // namespace gcdt::command

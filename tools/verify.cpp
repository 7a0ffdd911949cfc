// SPDX-License-Identifier: Apache-2.0
// gcdt verify: the proof of a result from the files alone.
#include <gcdt/verify.hpp>

#include <fmt/format.h>

#include "command.hpp"
#include "io/grid_text.hpp"
#include "io/paths.hpp"
#include "io/vtu.hpp"

namespace gcdt::command {

namespace {

using io::Exit;
using io::Failure;

io::MeshFile read_output(const std::string& path, const io::Input& input, bool adds) {
  if (io::lower_extension(path) == ".vtu") return io::read_vtu(path);
  if (!adds) return io::read_mesh(path, input.vertices.size(), input.first);
  std::vector<std::array<double, 2>> vertices = io::vertices_beside(path, input);
  io::MeshFile mesh = io::read_mesh(path, vertices.size(), input.first);
  mesh.vertices = std::move(vertices);
  return mesh;
}

/// A file that holds vertices must hold the input's, or its triangles mean something else.
/// Some may have been added after them, if `adds`.
void check_vertices(const std::string& path, const io::MeshFile& mesh, const io::Input& input, bool adds) {
  if (adds ? mesh.vertices.size() < input.vertices.size() : mesh.vertices.size() != input.vertices.size())
    throw Failure(Exit::check, fmt::format("{}: {} vertices, but the input has {}", path, mesh.vertices.size(),
                                           input.vertices.size()));
  for (std::size_t v = 0; v < input.vertices.size(); ++v)
    if (mesh.vertices[v] != input.vertices[v])
      throw Failure(Exit::check, fmt::format("{}: vertex {} is not where the input has it", path, v + input.first));
}

std::vector<std::array<std::int32_t, 2>> added_vertices(const std::string& path, const io::MeshFile& mesh,
                                                        const io::Input& input, const Grid& grid) {
  if (mesh.vertices.size() <= input.vertices.size()) return {};
  const std::size_t before = input.vertices.size();
  try {
    return grid_points(grid, {mesh.vertices.data() + before, mesh.vertices.size() - before});
  } catch (const Error& error) {
    if (error.status() != Status::coordinate_outside_grid) throw;
    throw Failure(Exit::check,
                  fmt::format("{}: vertex {} is outside the grid", path, error.indices().at(0) + before + input.first));
  }
}

Grid grid_of(const io::MeshFile& mesh, const io::Input& input, const Options& options, bool quiet) {
  if (mesh.grid && options.grid && !quiet) note("the grid is taken from the output file, and not from --grid");
  if (mesh.grid) return *mesh.grid;
  try {
    return choose_grid(input.vertices, options.grid);
  } catch (const Error& error) {
    throw explained(error, input, options);
  }
}

/// The first few that are excused, one a line.
std::string named(const MeshView& view, const std::vector<std::uint8_t>& excuses, std::uint32_t first) {
  static const char* const why[] = {"",
                                    "in an angle between constraints",
                                    "beside an angle between constraints",
                                    "a side as short as may be",
                                    "the limit of added vertices",
                                    "its centre is too near another vertex on the grid",
                                    "a constraint that may not be split",
                                    "a constraint that has no place to be split at"};
  constexpr std::size_t most = 10;
  std::string text;
  std::size_t count = 0;
  for (std::size_t t = 0; t < excuses.size(); ++t) {
    if (excuses[t] == GCDT_EXCUSE_NONE || ++count > most) continue;
    const auto& [a, b, c] = view.triangles[t];
    text +=
        fmt::format("  triangle {} ({}, {}, {}): {}\n", t + first, a + first, b + first, c + first, why[excuses[t]]);
  }
  if (count > most) text += fmt::format("  and {} more\n", count - most);
  return text;
}

void verify_refined(const VerifyArguments& arguments, const io::Input& input, const MeshView& view, const Grid& grid,
                    Options& options) {
  const InputRefinement refinement(arguments.refine, input);
  options.refine = refinement.wanted();
  options.refine->sizes = {};  // those at added vertices depend on what these were put on, which files do not say
  const RefinedVerification found = gcdt::verify_refined(input.vertices, input.constraints, view, grid, options);
  if (!found.valid) throw Failure(Exit::check, fmt::format("{}: {}", arguments.output, found.reason));
  if (arguments.quiet) return;
  const std::uint64_t excused = found.input_angle + found.beside_angle + found.short_side + found.limit + found.target +
                                found.fixed + found.refused;
  print(fmt::format(
      "valid: {} vertices, {} added{}, {} of these on constraints, which moved by {} at most; {} constraints, "
      "{} triangles{} on the {} grid with cell {}; {} triangles are excused\n{}",
      input.vertices.size(), view.added.size(),
      found.refinements > 1 ? fmt::format(" by {} refinements", found.refinements) : "", found.on_constraints,
      found.move, input.constraints.size(), view.triangles.size(), view.neighbours ? " and their neighbours" : "",
      io::kind_name(grid.kind), grid.cell(), excused, named(view, found.excuses, input.first)));
  if (arguments.refine.size) print("not proved: the lengths of --size, which --verify of gcdt triangulate proves\n");
}

}  // namespace

void verify(const VerifyArguments& arguments) {
  const std::string extension = io::lower_extension(arguments.output);
  if (extension != ".ele" && extension != ".neigh" && extension != ".vtu")
    throw Failure(Exit::usage, fmt::format("{}: only .ele, .neigh and .vtu files can be verified", arguments.output));
  check_refinement(arguments.refine);
  if (arguments.refine.angle && arguments.crossing == "split")
    throw Failure(Exit::usage, "refined meshes of crossings that were split are not verified");
  Options options;
  options.grid = grid_from_option(arguments.grid);
  options.crossing = crossing_named(arguments.crossing);
  const io::Input input = io::read_input(arguments.input);
  const bool refined = arguments.refine.angle.has_value(), adds = refined || options.crossing == Crossing::split;
  const io::MeshFile mesh = read_output(arguments.output, input, adds);
  if (extension == ".vtu") check_vertices(arguments.output, mesh, input, adds);
  const Grid grid = grid_of(mesh, input, options, arguments.quiet);

  MeshView view;
  view.triangles = mesh.triangles;
  if (!mesh.neighbours.empty()) view.neighbours = mesh.neighbours.data();
  if (!mesh.constrained.empty()) view.constrained = mesh.constrained.data();
  const std::vector<std::array<std::int32_t, 2>> added = added_vertices(arguments.output, mesh, input, grid);
  view.added = added;
  set_domain(arguments.domain, input, options);
  if (refined) return verify_refined(arguments, input, view, grid, options);
  RegionView said;
  if (!mesh.region.empty()) said.region = mesh.region.data();
  if (!mesh.depth.empty()) said.depth = mesh.depth.data();
  if (!mesh.winding.empty()) said.winding = mesh.winding.data();
  const bool regions = options.domain != Domain::hull || !mesh.region.empty();
  const Verification verification =
      regions ? gcdt::verify_domain(input.vertices, input.constraints, view, said, grid, options)
              : gcdt::verify(input.vertices, input.constraints, view, grid, options.crossing);
  if (!verification.valid) throw Failure(Exit::check, fmt::format("{}: {}", arguments.output, verification.reason));
  if (!arguments.quiet)
    print(fmt::format("valid: {} vertices, {} constraints, {} triangles{} on the {} grid with cell {}\n",
                      input.vertices.size(), input.constraints.size(), mesh.triangles.size(),
                      view.neighbours ? " and their neighbours" : "", io::kind_name(grid.kind), grid.cell()));
}

}  // namespace gcdt::command

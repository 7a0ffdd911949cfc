// SPDX-License-Identifier: Apache-2.0
#include "solved.hpp"

#include <fmt/format.h>

#include "io/mesh_input.hpp"
#include "progress.hpp"

namespace gcdt::command {

std::string device_number(const std::string& spec, bool quiet) {
  bool ambiguous = false;
  const std::size_t number = select_device(spec, &ambiguous);
  if (ambiguous && !quiet) {
    const DeviceInfo device = devices().at(number);
    note(fmt::format("several devices fit; device {} is taken: {} ({})", number, device.name, device.platform));
  }
  return std::to_string(number);
}

std::vector<double> Solved::attribute(std::uint32_t k) const {
  std::vector<double> values = io::attribute_of(input, k);
  const auto added = grid_coordinates(result->statistics().grid, result->added_on_grid());
  const auto more = added_values(input.vertices, input.constraints, added, result->added_crossing(), values);
  values.insert(values.end(), more.begin(), more.end());
  return values;
}

namespace {

/// Calls solve(solver, options), with progress on a line.
template <class Solve>
void on_device(const MeshArguments& arguments, Options& options, Solved& made, Solve&& solve) {
  ProgressLine line(!arguments.quiet);
  options.progress = [&](const char* phase, double done) {
    line.show(phase, done);
    return !interrupted();
  };
  made.solver = std::make_unique<Solver>(device_number(arguments.device, arguments.quiet));
  made.result = std::make_unique<Result>(solve(*made.solver, options));
}

/// Of a mesh file, whose triangles are taken as they are.
Solved adopted(const MeshArguments& arguments) {
  check_mesh_options(arguments);
  io::MeshInput read = io::read_mesh_input(arguments.input);
  Options options;
  options.grid = grid_from_option(arguments.grid);
  if (!options.grid && read.mesh.grid) options.grid = io::given_grid(*read.mesh.grid);
  Solved made;
  made.input = std::move(read.input);
  try {
    on_device(arguments, options, made, [&](Solver& solver, const Options& given) {
      return solver.adopt(made.input.vertices, read.mesh.triangles, {}, given);
    });
  } catch (const Error& error) {
    if (error.status() != Status::check_failed) throw explained(error, made.input, options);
    throw io::Failure(io::Exit::check, fmt::format("{}: {}{}", arguments.input, error.what(),
                                                   made.input.first == 1 ? " (numbers count from 0)" : ""));
  }
  return made;
}

}  // namespace

void check_mesh_options(const MeshArguments& arguments) {
  if (arguments.crossing != "reject" || arguments.domain != "hull")
    throw io::Failure(io::Exit::usage,
                      fmt::format("{}: a mesh is taken as it is, without --crossing and --domain", arguments.input));
}

Solved solved(const MeshArguments& arguments, bool regions) {
  if (io::holds_mesh(arguments.input)) return adopted(arguments);
  Options options;
  options.crossing = crossing_named(arguments.crossing);
  options.grid = grid_from_option(arguments.grid);
  options.regions = regions;
  Solved made;
  made.input = io::read_input(arguments.input);
  set_domain(arguments.domain, made.input, options);
  try {
    on_device(arguments, options, made, [&](Solver& solver, const Options& given) {
      return solver.solve(made.input.vertices, made.input.constraints, given);
    });
  } catch (const Error& error) {
    throw explained(error, made.input, options);
  }
  return made;
}

}  // namespace gcdt::command

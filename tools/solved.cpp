// SPDX-License-Identifier: Apache-2.0
#include "solved.hpp"

#include <fmt/format.h>

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

Solved solved(const MeshArguments& arguments) {
  Options options;
  options.crossing = crossing_named(arguments.crossing);
  options.grid = grid_from_option(arguments.grid);
  Solved made;
  made.input = io::read_input(arguments.input);
  set_domain(arguments.domain, made.input, options);
  ProgressLine line(!arguments.quiet);
  options.progress = [&](const char* phase, double done) {
    line.show(phase, done);
    return !interrupted();
  };
  try {
    made.solver = std::make_unique<Solver>(device_number(arguments.device, arguments.quiet));
    made.result = std::make_unique<Result>(made.solver->solve(made.input.vertices, made.input.constraints, options));
  } catch (const Error& error) {
    throw explained(error, made.input, options);
  }
  return made;
}

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
// gcdt locate: in which triangles points are.
#include <fmt/format.h>

#include <limits>

#include "io/output_files.hpp"
#include "io/paths.hpp"
#include "progress.hpp"
#include "solved.hpp"

namespace gcdt::command {

namespace {

/// One line a point.
template <class Print>
void write_places(const Solved& mesh, const io::Input& points, Print&& print) {
  std::vector<std::array<double, 3>> weights;
  const auto triangles = mesh.result->locate(points.vertices, &weights);
  constexpr double outside = std::numeric_limits<double>::quiet_NaN();
  std::vector<Array<double>> values;
  for (std::uint32_t k = 0; k < mesh.input.attribute_count; ++k)
    values.push_back(mesh.result->interpolate(points.vertices, mesh.attribute(k), outside));
  print(fmt::format("# point triangle weight weight weight{}\n", values.empty() ? "" : " attributes"));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::int64_t triangle = triangles[i] < 0 ? -1 : std::int64_t{triangles[i]} + mesh.input.first;
    std::string row =
        fmt::format("{} {} {} {} {}", i + points.first, triangle, weights[i][0], weights[i][1], weights[i][2]);
    for (const auto& value : values) row += fmt::format(" {}", value[i]);
    print(row + "\n");
  }
}

}  // namespace

void locate(const LocateArguments& arguments) {
  auto check_overwrites = [&](const std::vector<std::string>& inputs) {
    for (const std::string& input : inputs)
      if (!arguments.output.empty() && input != "-" && io::same_file(arguments.output, input))
        throw io::Failure(io::Exit::usage, fmt::format("{}: is an input, and cannot be an output", arguments.output));
  };
  check_overwrites({arguments.mesh.input, arguments.points});
  const io::Input points = io::read_input(arguments.points);
  check_overwrites(points.files);
  const Solved mesh = solved(arguments.mesh);
  check_overwrites(mesh.input.files);
  stop_if_interrupted();
  if (arguments.output.empty()) {
    std::string text;
    write_places(mesh, points, [&](const std::string& row) { text += row; });
    return print(text);
  }
  io::OutputFiles files(stop_if_interrupted);
  io::OutputFile& file = files.add(arguments.output);
  write_places(mesh, points, [&](const std::string& row) { file.write(row); });
  files.commit();
}

}  // namespace gcdt::command

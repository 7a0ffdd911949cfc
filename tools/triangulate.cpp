// SPDX-License-Identifier: Apache-2.0
// gcdt triangulate: read, triangulate, prove if asked, write.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <gcdt/verify.hpp>

#include "command.hpp"
#include "io/output_files.hpp"
#include "io/outputs.hpp"
#include "io/paths.hpp"
#include "progress.hpp"
#include "prove.hpp"
#include "solved.hpp"
#include "statistics.hpp"
#include "tiled.hpp"
#include "trace.hpp"
#include "triangle_switches.hpp"

namespace gcdt::command {

namespace {

using io::Exit;
using io::Failure;

/// All paths that will be written.
std::vector<std::string> written_paths(const TriangulateArguments& arguments) {
  std::vector<std::string> paths = arguments.outputs;
  if (!arguments.statistics.empty()) paths.push_back(arguments.statistics);
  if (!arguments.trace.empty()) paths.push_back(arguments.trace);
  return paths;
}

void check_outputs(const TriangulateArguments& arguments) {
  for (const std::string& path : arguments.outputs)
    if (!io::writer_for(io::lower_extension(path)))
      throw Failure(Exit::usage, fmt::format("{}: unknown output format; there are {}", path, io::output_extensions()));
  const auto paths = written_paths(arguments);
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (io::same_file(paths[i], paths[j]))
        throw Failure(Exit::usage, fmt::format("{}: given twice as an output", paths[i]));
  for (const std::string& path : {arguments.statistics, arguments.trace}) check_is_file_name(path);
  // Before the work, though only what has no room is spilled, which may be hours later or never.
  std::error_code unknown;
  if (!arguments.spill.empty() && !std::filesystem::is_directory(arguments.spill, unknown))
    throw Failure(Exit::output, fmt::format("--spill {}: is no directory", arguments.spill));
}

void check_overwrites_no_input(const TriangulateArguments& arguments, const std::vector<std::string>& inputs) {
  for (const std::string& path : written_paths(arguments))
    for (const std::string& input : inputs)
      if (input != "-" && io::same_file(path, input))
        throw Failure(Exit::usage, fmt::format("{}: is an input, and cannot be an output", path));
}

Computed computed(const io::Input& input, const TriangulateArguments& arguments, Options& options, TraceRecord& trace,
                  Measured& measured) {
  ProgressLine line(!arguments.quiet);
  options.progress = [&](const char* phase, double done) {
    line.show(phase, done);
    return !interrupted();
  };
  try {
    const auto log = [&](int, const char* message) {
      const std::string text = message, plan = "plan: ", refine = "refine: ";
      if (text.compare(0, plan.size(), plan) == 0) measured.plan = text.substr(plan.size());
      if (text.compare(0, refine.size(), refine) != 0 || arguments.quiet) return;
      line.clear();
      note(text.substr(refine.size()));  // before the work: it may take long
      measured.noted = text.substr(refine.size());
    };
    const auto sink = [&] { return arguments.trace.empty() ? Trace() : trace.sink(); };
    if (wants_pool(arguments)) return triangulate_on_pool(input, arguments, options, sink(), measured);
    try {
      Solver solver(device_number(arguments.device, arguments.quiet), log, sink());
      const Result result = solver.solve(input.vertices, input.constraints, options);
      if (!arguments.statistics.empty()) measured.quality = result.quality();
      return {result.download(), {}};
    } catch (const Error& error) {
      if (error.status() != Status::out_of_memory || options.refine) throw;
      if (!arguments.quiet) note(fmt::format("in tiles, since {}", error.what()));
    }
    return triangulate_on_pool(input, arguments, options, sink(), measured);
  } catch (const Error& error) {
    throw explained(error, input, options);
  }
}

void write_outputs(const TriangulateArguments& arguments, const std::vector<std::string>& paths,
                   const io::Result& result, Statistics& statistics, const Measured& measured,
                   const TraceRecord& trace) {
  const Stopwatch write;
  io::OutputFiles files(stop_if_interrupted);
  for (const std::string& path : paths) io::writer_for(io::lower_extension(path))(files.add(path), result);
  if (!arguments.outputs.empty()) statistics.ms.write = write.milliseconds();
  if (!arguments.statistics.empty()) files.add(arguments.statistics).write(statistics_json(statistics, measured));
  if (!arguments.trace.empty()) files.add(arguments.trace).write(trace.json());
  stop_if_interrupted();
  files.commit();
}

}  // namespace

void triangulate(const TriangulateArguments& arguments) {
  check_outputs(arguments);
  check_overwrites_no_input(arguments, {arguments.input});
  if (arguments.assess && arguments.domain != "hull")
    throw Failure(Exit::usage, "--assess looks at the whole mesh: it needs --domain hull");
  check_refinement(arguments.refine);
  if (arguments.refine.angle && wants_pool(arguments))
    throw Failure(Exit::usage, "--refine is done on one device, without --tiles and --memory");
  if (arguments.refine.angle && arguments.assess)
    throw Failure(Exit::usage, "--assess does not go with --refine, which may bend the outline");
  if (arguments.refine.angle && arguments.verify && arguments.crossing == "split")
    throw Failure(Exit::usage, "--verify does not go with both --refine and --crossing split");
  Options options;
  options.crossing = crossing_named(arguments.crossing);
  options.grid = grid_from_option(arguments.grid);

  const Stopwatch read;
  const io::Input input = io::read_input(arguments.input);
  const double read_milliseconds = read.milliseconds();
  check_overwrites_no_input(arguments, input.files);
  set_domain(arguments.domain, input, options);
  options.regions = arguments.regions;
  options.distinct = arguments.distinct;
  const InputRefinement refinement(arguments.refine, input);
  options.refine = refinement.wanted();
  stop_if_interrupted();

  TraceRecord trace;
  Measured measured;
  measured.refined = options.refine.has_value();
  const Computed made = computed(input, arguments, options, trace, measured);
  io::MeshArrays mesh = made.arrays();
  Statistics& statistics = mesh.statistics;
  statistics.ms.read = read_milliseconds;
  statistics.notes.insert(statistics.notes.begin(), input.notes.begin(), input.notes.end());
  add_unused(input, options, statistics.notes);
  if (const std::string together = together_note(input, statistics.vertices_rounded_together, statistics.rounded_pair);
      !together.empty())
    statistics.notes.push_back(together);
  if (const std::string rounding = rounding_note(mesh); !rounding.empty()) statistics.notes.push_back(rounding);
  if (arguments.verify)
    if (const Verification proof = prove(input, mesh, options); !proof.valid)
      throw Failure(Exit::check, fmt::format("the result failed its verification: {}", proof.reason));
  if (arguments.assess) measured.given = assess(input.vertices, view_of(mesh), statistics.grid);
  stop_if_interrupted();
  const std::vector<std::string> paths = io::with_nodes(arguments.outputs, !mesh.added.empty(), input.files);
  io::Result result(input, mesh);
  result.coloured_by_angle = arguments.colour == "angle";
  if (arguments.jettison) {
    const auto [used, used_mesh] = jettisoned(result);
    io::Result left(used, used_mesh);
    left.coloured_by_angle = result.coloured_by_angle;
    write_outputs(arguments, paths, left, statistics, measured, trace);
  } else {
    write_outputs(arguments, paths, result, statistics, measured, trace);
  }
  if (arguments.quiet) return;
  for (const std::string& text : statistics.notes)
    if (text != measured.noted) note(text);
  if (arguments.outputs.empty()) print(statistics_table(statistics, measured));
}

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
// gcdt batch: many inputs in one call, on many devices.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <gcdt/gcdt_pool.hpp>
#include <gcdt/verify.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "command.hpp"
#include "io/formats.hpp"
#include "io/output_files.hpp"
#include "io/paths.hpp"
#include "progress.hpp"
#include "trace.hpp"

namespace gcdt::command {

namespace {

namespace fs = std::filesystem;
using io::Exit;
using io::Failure;

/// The inputs that an argument stands for: itself, or of a folder every .poly and every .node that no .poly there
/// stands beside, by name.
std::vector<std::string> inputs_of(const std::string& argument) {
  std::error_code unknown;
  if (!fs::is_directory(argument, unknown)) return {argument};
  std::set<std::string> found;
  std::error_code failed;
  for (fs::directory_iterator file(argument, failed), end; !failed && file != end; file.increment(failed)) {
    const std::string extension = io::lower_extension(file->path().string());
    fs::path poly = file->path();
    poly.replace_extension(".poly");
    if (extension == ".poly" || (extension == ".node" && !fs::exists(poly))) found.insert(file->path().string());
  }
  if (failed) throw Failure(Exit::input, fmt::format("{}: {}", argument, failed.message()));
  if (found.empty()) throw Failure(Exit::input, fmt::format("{}: no .poly or .node file in this folder", argument));
  return {found.begin(), found.end()};
}

/// One input on its way: read, triangulated or failed, written.
struct Problem {
  std::string path;
  io::Input input;
  std::optional<Failure> failure;
  std::size_t number = 0;  ///< in the batch

  fs::path output(const std::string& folder, const std::string& format) const {
    return fs::path(folder) / fs::path(path).filename().replace_extension(format);
  }
};

std::vector<Problem> problems_of(const BatchArguments& arguments) {
  std::vector<Problem> problems;
  for (const std::string& argument : arguments.inputs)
    for (std::string& path : inputs_of(argument)) {
      problems.emplace_back();
      problems.back().path = std::move(path);
    }
  std::set<std::string> names;
  if (!arguments.folder.empty())
    for (const Problem& problem : problems)
      if (const std::string name = problem.output("", "").string(); !names.insert(name).second)
        throw Failure(Exit::usage, fmt::format("{}: another input has the outputs {}.*, too", problem.path, name));
  return problems;
}

std::vector<std::string> formats_of(const BatchArguments& arguments) {
  std::vector<std::string> formats;
  for (const std::string& given : arguments.formats) {
    const std::string format = io::lower_extension("x." + given.substr(given.rfind('.') + 1));
    if (!io::writer_for(format))
      throw Failure(Exit::usage, fmt::format("--format {}: there are ele node neigh edge poly vtu svg", given));
    formats.push_back(format);
  }
  return formats;
}

void check_overwrites_no_input(const std::vector<Problem>& problems, const BatchArguments& arguments,
                               const std::vector<std::string>& formats) {
  std::set<fs::path> inputs;
  std::error_code unknown;
  for (const Problem& problem : problems) {
    inputs.insert(fs::weakly_canonical(problem.path, unknown));
    for (const std::string& file : problem.input.files) inputs.insert(fs::weakly_canonical(file, unknown));
  }
  for (const Problem& problem : problems)
    for (const std::string& format : formats)
      if (inputs.count(fs::weakly_canonical(problem.output(arguments.folder, format), unknown)) > 0)
        throw Failure(Exit::usage, fmt::format("{}: is an input, and cannot be an output",
                                               problem.output(arguments.folder, format).string()));
}

Batch read(std::vector<Problem>& problems) {
  Batch batch;
  for (Problem& problem : problems) {
    stop_if_interrupted();
    try {
      problem.input = io::read_input(problem.path);
      problem.number = batch.size();
      batch.add(problem.input.vertices, problem.input.constraints);
    } catch (const Failure& failure) {
      problem.failure = failure;
    }
  }
  return batch;
}

template <class T>
std::vector<T> copied(Span<T> span) {
  return {span.begin(), span.end()};
}

Triangulation mesh_of(const BatchResult& result, std::size_t p) {
  Triangulation mesh;
  mesh.triangles = copied(result.triangles(p));
  mesh.neighbours = copied(result.neighbours(p));
  mesh.constrained = copied(result.constrained(p));
  mesh.representative = copied(result.representative(p));
  mesh.pieces = copied(result.pieces(p));
  mesh.source_offsets = copied(result.source_offsets(p));
  mesh.sources = copied(result.sources(p));
  mesh.dropped = copied(result.dropped(p));
  mesh.statistics.grid = result.grid(p);
  mesh.statistics.triangles = mesh.triangles.size();
  return mesh;
}

void prove(Problem& problem, const Triangulation& mesh, Crossing crossing) {
  MeshView view;
  view.triangles = mesh.triangles;
  view.neighbours = mesh.neighbours.data();
  view.constrained = mesh.constrained.data();
  const Verification proof =
      gcdt::verify(problem.input.vertices, problem.input.constraints, view, mesh.statistics.grid, crossing);
  if (!proof.valid)
    problem.failure =
        Failure(Exit::check, fmt::format("{}: the result failed its verification: {}", problem.path, proof.reason));
}

/// The outputs of one problem appear together.
void finish(Problem& problem, const BatchResult& result, const BatchArguments& arguments,
            const std::vector<std::string>& formats, const Options& options) {
  if (const std::optional<Error> error = result.error(problem.number)) {
    const Failure said = explained(*error, problem.input, options);
    const bool named = std::string(said.what()).find(problem.path) == 0;
    problem.failure = Failure(said.exit(), named ? said.what() : fmt::format("{}: {}", problem.path, said.what()));
    return;
  }
  if (!arguments.verify && arguments.folder.empty()) return;
  const Triangulation mesh = mesh_of(result, problem.number);
  if (arguments.verify) prove(problem, mesh, options.crossing);
  if (problem.failure || arguments.folder.empty()) return;
  io::OutputFiles files(stop_if_interrupted);
  for (const std::string& format : formats)
    io::writer_for(format)(files.add(problem.output(arguments.folder, format).string()), {problem.input, mesh});
  files.commit();
}

struct Told {
  std::size_t inputs = 0, failed = 0;
  double read = 0, write = 0;
};

std::string statistics_json(const Told& told, const gcdt_batch_statistics& s, const Pool& pool) {
  nlohmann::ordered_json devices = nlohmann::ordered_json::array();
  for (const PoolDevice& device : pool.devices())
    devices.push_back({{"device", device.info.name},
                       {"platform", device.info.platform},
                       {"driver", device.info.driver},
                       {"problems", device.problems},
                       {"vertices", device.vertices},
                       {"runs", device.runs},
                       {"ms", device.ms_busy},
                       {"lost", device.lost ? device.lost->what() : ""}});
  const nlohmann::ordered_json json = {{"inputs", told.inputs},
                                       {"failed", told.failed},
                                       {"n", s.vertices},
                                       {"m", s.constraints},
                                       {"triangles", s.triangles},
                                       {"ms", {{"read", told.read}, {"full", s.ms_full}, {"write", told.write}}},
                                       {"devices", std::move(devices)},
                                       {"version", version()}};
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string statistics_table(const Told& told, const gcdt_batch_statistics& s, const Pool& pool) {
  std::string table = fmt::format(
      "inputs        {} ({} failed)\nvertices      {}\nconstraints   {}\ntriangles     {}\n"
      "time          {:.1f} ms, read {:.1f}, write {:.1f}\n",
      told.inputs, told.failed, s.vertices, s.constraints, s.triangles, s.ms_full, told.read, told.write);
  for (const PoolDevice& device : pool.devices())
    table += fmt::format("device        {} ({}): {}\n", device.info.name, device.info.platform,
                         device.lost ? "taken out: " + std::string(device.lost->what())
                                     : fmt::format("{} inputs, {} vertices in {} runs, {:.1f} ms", device.problems,
                                                   device.vertices, device.runs, device.ms_busy));
  return table;
}

}  // namespace

void triangulate_batch(const BatchArguments& arguments) {
  const std::vector<std::string> formats = formats_of(arguments);
  Options options;
  options.crossing = crossing_named(arguments.crossing);
  options.grid = grid_from_option(arguments.grid);
  std::vector<Problem> problems = problems_of(arguments);
  Told told;
  told.inputs = problems.size();
  const Stopwatch reading;
  const Batch batch = read(problems);
  told.read = reading.milliseconds();
  if (!arguments.folder.empty()) check_overwrites_no_input(problems, arguments, formats);
  TraceRecord trace;
  Pool pool(arguments.device, {}, arguments.trace.empty() ? Trace() : trace.sink());
  ProgressLine line(!arguments.quiet);
  options.progress = [&](const char* phase, double done) {
    line.show(phase, done);
    return !interrupted();
  };
  const BatchResult result = pool.triangulate(batch, options);
  line.clear();

  const Stopwatch writing;
  std::error_code failed;
  if (!arguments.folder.empty()) fs::create_directories(arguments.folder, failed);
  if (failed) throw Failure(Exit::output, fmt::format("{}: {}", arguments.folder, failed.message()));
  std::optional<Exit> first;
  for (Problem& problem : problems) {
    stop_if_interrupted();
    if (!problem.failure) finish(problem, result, arguments, formats, options);
    if (!problem.failure) continue;
    ++told.failed;
    if (!first) first = problem.failure->exit();
    complain(problem.failure->what());
  }
  told.write = writing.milliseconds();
  io::OutputFiles files(stop_if_interrupted);
  if (!arguments.statistics.empty())
    files.add(arguments.statistics).write(statistics_json(told, result.statistics(), pool));
  if (!arguments.trace.empty()) files.add(arguments.trace).write(trace.json());
  files.commit();
  if (!arguments.quiet && arguments.folder.empty()) print(statistics_table(told, result.statistics(), pool));
  for (const PoolDevice& device : pool.devices())
    if (device.lost && !arguments.quiet)
      note(fmt::format("{} was taken out: {}", device.info.name, device.lost->what()));
  if (first) throw Failure(*first, fmt::format("{} of {} inputs failed", told.failed, told.inputs));
}

}  // namespace gcdt::command

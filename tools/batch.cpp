// SPDX-License-Identifier: Apache-2.0
// gcdt batch: many inputs in one call, on many devices.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <gcdt/gcdt_pool.hpp>
#include <gcdt/verify.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "batch_statistics.hpp"
#include "command.hpp"
#include "io/formats.hpp"
#include "io/geojson.hpp"
#include "io/output_files.hpp"
#include "io/paths.hpp"
#include "progress.hpp"
#include "solved.hpp"
#include "trace.hpp"

namespace gcdt::command {

namespace {

namespace fs = std::filesystem;
using io::Exit;
using io::Failure;

// The format that has many problems in one file.
constexpr const char* collected = ".jsonl";

// What a folder may hold; of inputs with the same name the first of these kinds is taken.
constexpr const char* kinds[] = {".poly", ".node", ".geojson", ".geojsonl", ".ndjson", ".geojsons"};

/// The inputs that an argument stands for: itself, or all of a folder, by name.
std::vector<std::string> inputs_of(const std::string& argument) {
  std::error_code unknown;
  if (!fs::is_directory(argument, unknown)) return {argument};
  std::set<std::string> found;
  std::error_code failed;
  for (fs::directory_iterator file(argument, failed), end; !failed && file != end; file.increment(failed)) {
    const std::string extension = io::lower_extension(file->path().string());
    for (const char* kind : kinds) {
      if (extension == kind) found.insert(file->path().string());
      if (extension == kind || fs::exists(fs::path(file->path()).replace_extension(kind))) break;
    }
  }
  if (failed) throw Failure(Exit::input, fmt::format("{}: {}", argument, failed.message()));
  if (found.empty()) throw Failure(Exit::input, fmt::format("{}: no input in this folder", argument));
  return {found.begin(), found.end()};
}

/// One problem on its way: read, triangulated or failed, written.
struct Problem {
  std::string path, name;            ///< name: in messages
  std::optional<io::TextLine> line;  ///< of a file with many problems
  io::Input input;
  std::optional<Failure> failure;
  std::size_t number = 0;  ///< in the batch
  bool alone = false;      ///< not in the batch, which has no seeds, but triangulated by itself

  fs::path output(const std::string& folder, const std::string& format) const {
    const std::string stem = fs::path(path).stem().string();
    return fs::path(folder) / (stem + (line ? fmt::format("-{}", line->number) : "") + format);
  }
  /// The file for all problems of the input.
  fs::path collection(const std::string& folder) const {
    return fs::path(folder) / fs::path(path).filename().replace_extension(collected);
  }
};

void add_problems(const std::string& path, std::vector<Problem>& problems) {
  const auto add = [&](const std::string& name) -> Problem& {
    problems.emplace_back();
    problems.back().path = path;
    problems.back().name = name;
    return problems.back();
  };
  if (!io::is_line_file(path)) {
    add(path);
    return;
  }
  for (io::TextLine& line : io::lines_of(path)) add(fmt::format("{}:{}", path, line.number)).line = std::move(line);
}

std::vector<Problem> problems_of(const BatchArguments& arguments) {
  std::vector<Problem> problems;
  for (const std::string& argument : arguments.inputs)
    for (const std::string& path : inputs_of(argument)) add_problems(path, problems);
  std::set<std::string> names;
  if (!arguments.folder.empty())
    for (const Problem& problem : problems)
      if (const std::string name = problem.output("", "").string(); !names.insert(name).second)
        throw Failure(Exit::usage, fmt::format("{}: another input has the outputs {}.*, too", problem.name, name));
  std::map<fs::path, std::string> collections;
  for (const Problem& problem : problems)
    if (!arguments.folder.empty() &&
        collections.emplace(problem.collection(""), problem.path).first->second != problem.path)
      throw Failure(Exit::usage, fmt::format("{}: another input has the output {}, too", problem.path,
                                             problem.collection("").string()));
  return problems;
}

std::vector<std::string> formats_of(const BatchArguments& arguments) {
  std::vector<std::string> formats;
  for (const std::string& given : arguments.formats) {
    const std::string format = io::lower_extension("x." + given.substr(given.rfind('.') + 1));
    if (!io::writer_for(format) && format != collected)
      throw Failure(Exit::usage, fmt::format("--format {}: there are ele node neigh edge poly vtu svg jsonl", given));
    formats.push_back(format);
  }
  return formats;
}

/// No file is an input and an output, nor two outputs, but for the files of one problem, which have different formats.
void check_outputs(const std::vector<Problem>& problems, const BatchArguments& arguments,
                   const std::vector<std::string>& formats) {
  std::error_code unknown;
  const auto file = [&](const fs::path& path) { return fs::weakly_canonical(fs::absolute(path), unknown); };
  std::set<fs::path> inputs, outputs;
  for (const Problem& problem : problems) {
    inputs.insert(file(problem.path));
    for (const std::string& path : problem.input.files) inputs.insert(file(path));
  }
  const auto check = [&](const fs::path& output) {
    if (inputs.count(file(output)) > 0)
      throw Failure(Exit::usage, fmt::format("{}: is an input, and cannot be an output", output.string()));
  };
  if (!arguments.folder.empty())
    for (const Problem& problem : problems)
      for (const std::string& format : formats) {
        const fs::path output =
            format == collected ? problem.collection(arguments.folder) : problem.output(arguments.folder, format);
        check(output);
        outputs.insert(file(output));
      }
  for (const std::string& other : {arguments.statistics, arguments.trace}) {
    if (other.empty()) continue;
    check(other);
    if (!outputs.insert(file(other)).second)
      throw Failure(Exit::usage, fmt::format("{}: given twice as an output", other));
  }
}

/// Whether the input has points that the options use.
bool uses_seeds(const io::Input& input, const Options& options) {
  const bool by_holes = options.domain == Domain::holes || options.domain == Domain::outer_holes;
  const bool regions = options.regions || options.domain != Domain::hull;
  return (by_holes && !input.holes.empty()) || (regions && !input.regions.empty());
}

Batch read(std::vector<Problem>& problems, const Options& options) {
  Batch batch;
  for (Problem& problem : problems) {
    stop_if_interrupted();
    try {
      problem.input = problem.line ? io::read_geojson_line(problem.path, *problem.line) : io::read_input(problem.path);
      if (problem.line) problem.line->text = {};
      problem.alone = uses_seeds(problem.input, options);
      problem.number = batch.size();
      if (!problem.alone) batch.add(problem.input.vertices, problem.input.constraints);
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

/// Of a problem in the batch; without its arrays unless they are wanted.
Triangulation mesh_of(const BatchResult& result, std::size_t p, bool arrays) {
  Triangulation mesh;
  mesh.statistics.grid = result.grid(p);
  std::tie(mesh.statistics.vertices_rounded_together, mesh.statistics.rounded_pair) = result.rounded_together(p);
  const SplitReport split = result.split(p);
  mesh.statistics.crossings = split.crossings, mesh.statistics.vertices_added = split.vertices_added;
  mesh.statistics.constraints_split = split.constraints_split, mesh.statistics.constraint_move = split.constraint_move;
  if (!arrays) return mesh;
  mesh.triangles = copied(result.triangles(p));
  mesh.neighbours = copied(result.neighbours(p));
  mesh.constrained = copied(result.constrained(p));
  mesh.representative = copied(result.representative(p));
  mesh.pieces = copied(result.pieces(p));
  mesh.source_offsets = copied(result.source_offsets(p));
  mesh.sources = copied(result.sources(p));
  mesh.dropped = copied(result.dropped(p));
  mesh.region = copied(result.region(p));
  mesh.depth = copied(result.depth(p));
  mesh.winding = copied(result.winding(p));
  mesh.region_seed = copied(result.region_seed(p));
  mesh.added_on_grid = copied(result.added_on_grid(p));
  mesh.added_crossing = copied(result.added_crossing(p));
  mesh.added = grid_coordinates(mesh.statistics.grid, mesh.added_on_grid);
  mesh.statistics.triangles = mesh.triangles.size();
  return mesh;
}

/// Triangulates inputs that have points of their own for the domain, one by one, as `triangulate` does.
class Alone {
 public:
  /// `devices`: of those given the first, which any of several may be.
  Alone(const std::string& devices, const BatchArguments& arguments, const Options& options)
      : spec_(devices.substr(0, devices.find(','))), arguments_(arguments), options_(options) {
    if (spec_ == "all") spec_ = "auto";
  }

  /// The options for an input; only as long as it is there.
  Options options(const io::Input& input) const {
    Options own = options_;
    set_domain(arguments_.domain, input, own);
    return own;
  }
  Triangulation triangulate(const io::Input& input) {
    if (!solver_) solver_.emplace(device_number(spec_, true));
    Triangulation mesh = solver_->triangulate(input.vertices, input.constraints, options(input));
    constraints += input.constraints.size();
    vertices += input.vertices.size();
    triangles += mesh.triangles.size();
    return mesh;
  }
  std::uint64_t vertices = 0, constraints = 0, triangles = 0;  ///< of all of them

 private:
  std::string spec_;
  const BatchArguments& arguments_;
  const Options& options_;
  std::optional<Solver> solver_;
};

void prove(Problem& problem, const Triangulation& mesh, const Options& options) {
  MeshView view;
  view.triangles = mesh.triangles;
  view.neighbours = mesh.neighbours.data();
  view.constrained = mesh.constrained.data();
  view.added = mesh.added_on_grid;
  const io::Input& input = problem.input;
  const Grid& grid = mesh.statistics.grid;
  const bool regions = options.regions || options.domain != Domain::hull;
  const Verification proof =
      regions ? gcdt::verify_domain(input.vertices, input.constraints, view,
                                    {mesh.region.data(), mesh.depth.data(), mesh.winding.data()}, grid, options)
              : gcdt::verify(input.vertices, input.constraints, view, grid, options.crossing);
  if (!proof.valid)
    problem.failure =
        Failure(Exit::check, fmt::format("{}: the result failed its verification: {}", problem.name, proof.reason));
}

/// The files with many problems each, which appear together.
class Collections {
 public:
  void add(const Problem& problem, const std::string& folder, const Triangulation* mesh) {
    const std::string path = problem.collection(folder).string();
    io::OutputFile*& file = files_[path];
    if (!file) file = &outputs_.add(path);
    nlohmann::ordered_json line;
    if (problem.line) line["line"] = problem.line->number;
    if (mesh) {
      line["triangles"] = mesh->triangles;
      line["constrained"] = mesh->constrained;
      if (!mesh->added.empty()) line["added"] = mesh->added;
    } else {
      line["error"] = problem.failure->what();
    }
    file->write(line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  void commit() { outputs_.commit(); }

 private:
  io::OutputFiles outputs_{stop_if_interrupted};
  std::map<std::string, io::OutputFile*> files_;
};

void fail(Problem& problem, const Error& error, const Options& options) {
  const Failure said = explained(error, problem.input, options);
  const bool named = std::string(said.what()).find(problem.name) == 0;
  problem.failure = Failure(said.exit(), named ? said.what() : fmt::format("{}: {}", problem.name, said.what()));
}

/// What is said of an input that was triangulated.
void say_notes(const Problem& problem, const Triangulation& mesh, const Options& options) {
  std::vector<std::string> notes;
  add_unused(problem.input, options, notes);
  const Statistics& s = mesh.statistics;
  for (const std::string& text :
       {together_note(problem.input, s.vertices_rounded_together, s.rounded_pair), rounding_note(mesh)})
    if (!text.empty()) notes.push_back(text);
  for (const std::string& text : notes) note(fmt::format("{}: {}", problem.name, text));
}

/// The files of a problem's own: an .ele with added vertices gets the .node that has them. That fails the problem if it
/// is an input of its own; no other can be, since no other has the name.
std::vector<std::pair<std::string, io::Write>> files_of(Problem& problem, const Triangulation& mesh,
                                                        const std::string& folder, std::vector<std::string> formats) {
  const auto has = [&](const char* format) { return std::count(formats.begin(), formats.end(), format) > 0; };
  if (!mesh.added.empty() && has(".ele") && !has(".node")) {
    formats.push_back(".node");
    const std::string node = problem.output(folder, ".node").string();
    for (const std::string& input : problem.input.files)
      if (io::same_file(node, input))
        problem.failure = Failure(
            Exit::usage,
            fmt::format("{}: is an input, but the .ele needs it for the added vertices: name another folder", node));
  }
  std::vector<std::pair<std::string, io::Write>> files;
  for (const std::string& format : formats)
    if (format != collected) files.emplace_back(problem.output(folder, format).string(), io::writer_for(format));
  return files;
}

/// The mesh of a problem, unless that fails.
std::optional<Triangulation> mesh_of(Problem& problem, const BatchResult& result, Alone& alone, const Options& options,
                                     bool arrays) {
  try {
    if (problem.failure) return {};
    if (problem.alone) return alone.triangulate(problem.input);
    if (const std::optional<Error> error = result.error(problem.number)) throw *error;
    return mesh_of(result, problem.number, arrays);
  } catch (const Error& error) {
    fail(problem, error, options);
    return {};
  }
}

/// The outputs of one problem that are its own appear together.
void finish(Problem& problem, const BatchResult& result, const BatchArguments& arguments,
            const std::vector<std::string>& formats, const Options& options, Alone& alone, Told& told,
            Collections& collections) {
  const bool writes = !arguments.folder.empty();
  const std::optional<Triangulation> mesh = mesh_of(problem, result, alone, options, writes || arguments.verify);
  if (mesh) {
    const Statistics& s = mesh->statistics;
    told.rounded_together += s.vertices_rounded_together;
    add({s.crossings, s.vertices_added, s.constraints_split, s.constraint_move}, told.split);
    if (!arguments.quiet) say_notes(problem, *mesh, options);
    if (arguments.verify) prove(problem, *mesh, problem.alone ? alone.options(problem.input) : options);
  }
  if (!writes) return;
  std::vector<std::pair<std::string, io::Write>> own;
  if (!problem.failure) own = files_of(problem, *mesh, arguments.folder, formats);
  if (std::count(formats.begin(), formats.end(), collected) > 0)
    collections.add(problem, arguments.folder, problem.failure ? nullptr : &*mesh);
  if (problem.failure) return;
  io::OutputFiles files(stop_if_interrupted);
  for (const auto& [path, write] : own) write(files.add(path), {problem.input, *mesh});
  files.commit();
}

}  // namespace

void triangulate_batch(const BatchArguments& arguments) {
  const std::vector<std::string> formats = formats_of(arguments);
  Options options;
  options.crossing = crossing_named(arguments.crossing);
  options.grid = grid_from_option(arguments.grid);
  options.regions = arguments.regions;
  options.distinct = arguments.distinct;
  set_domain(arguments.domain, {}, options);
  std::vector<Problem> problems = problems_of(arguments);
  Told told;
  told.inputs = problems.size();
  const Stopwatch reading;
  const Batch batch = read(problems, options);
  told.read = reading.milliseconds();
  check_outputs(problems, arguments, formats);
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
  const char* chosen = std::getenv("GCDT_DEVICE");
  Alone alone(arguments.device.empty() && chosen ? chosen : arguments.device, arguments, options);
  Collections collections;
  for (Problem& problem : problems) {
    stop_if_interrupted();
    finish(problem, result, arguments, formats, options, alone, told, collections);
    if (!problem.failure) continue;
    ++told.failed;
    if (!first) first = problem.failure->exit();
    complain(problem.failure->what());
  }
  collections.commit();
  told.write = writing.milliseconds();
  gcdt_batch_statistics counts = result.statistics();
  counts.vertices += alone.vertices, counts.constraints += alone.constraints, counts.triangles += alone.triangles;
  io::OutputFiles files(stop_if_interrupted);
  if (!arguments.statistics.empty()) files.add(arguments.statistics).write(statistics_json(told, counts, pool));
  if (!arguments.trace.empty()) files.add(arguments.trace).write(trace.json());
  files.commit();
  if (!arguments.quiet && arguments.folder.empty()) print(statistics_table(told, counts, pool));
  for (const PoolDevice& device : pool.devices())
    if (device.lost && !arguments.quiet)
      note(fmt::format("{} was taken out: {}", device.info.name, device.lost->what()));
  if (first) throw Failure(*first, fmt::format("{} of {} inputs failed", told.failed, told.inputs));
}

}  // namespace gcdt::command

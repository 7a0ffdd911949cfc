// SPDX-License-Identifier: Apache-2.0
// gcdt batch: many inputs in one call, on many devices.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <gcdt/verify.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "batch_inputs.hpp"
#include "batch_statistics.hpp"
#include "io/output_files.hpp"
#include "io/paths.hpp"
#include "progress.hpp"
#include "prove.hpp"
#include "solved.hpp"
#include "trace.hpp"

namespace gcdt::command {

namespace {

namespace fs = std::filesystem;
using io::Exit;
using io::Failure;

/// Adds the time that it lives.
class Clock {
 public:
  explicit Clock(double& milliseconds) : milliseconds_(milliseconds) {}
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  ~Clock() { milliseconds_ += watch_.milliseconds(); }

 private:
  double& milliseconds_;
  Stopwatch watch_;
};

/// Triangulates inputs that have points of their own for the domain, one by one, as `triangulate` does.
class Singles {
 public:
  /// `devices`: of those given the first, which any of several may be.
  Singles(const std::string& devices, const BatchArguments& arguments, const Options& options)
      : spec_(devices.substr(0, devices.find(','))), arguments_(arguments), options_(options) {
    if (spec_ == "all") spec_ = "auto";
  }

  /// The options for a problem; only as long as it is there.
  Options options(const Problem& problem) const {
    Options own = options_;
    set_domain(arguments_.domain, problem.input, own);
    own.refine = problem.refinement->wanted();
    return own;
  }
  Triangulation triangulate(const Problem& problem) {
    const Clock clock(milliseconds);
    const io::Input& input = problem.input;
    if (!solver_) solver_.emplace(device_number(spec_, true));
    Triangulation mesh = solver_->triangulate(input.vertices, input.constraints, options(problem));
    constraints += input.constraints.size();
    vertices += input.vertices.size();
    triangles += mesh.triangles.size();
    return mesh;
  }
  std::uint64_t vertices = 0, constraints = 0, triangles = 0;  ///< of all of them
  double milliseconds = 0;                                     ///< in the calls, the solver's making included

 private:
  std::string spec_;
  const BatchArguments& arguments_;
  const Options& options_;
  std::optional<Solver> solver_;
};

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
  if (!s.refine.complete) notes.push_back("the limit of added vertices ended the refinement");
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
std::optional<Triangulation> mesh_of(Problem& problem, const BatchResult& result, Singles& singles,
                                     const Options& options, bool arrays) {
  try {
    if (problem.failure) return {};
    if (problem.single) return singles.triangulate(problem);
    if (const std::optional<Error> error = result.error(problem.number)) throw *error;
    if (arrays) return detail::triangulation(result, problem.number);
    Triangulation mesh;
    mesh.statistics = detail::statistics(result, problem.number);
    return mesh;
  } catch (const Error& error) {
    fail(problem, error, options);
    return {};
  }
}

/// The outputs of one problem that are its own appear together.
void finish(Problem& problem, const BatchResult& result, const BatchArguments& arguments,
            const std::vector<std::string>& formats, const Options& options, Singles& singles, Told& told,
            Collections& collections) {
  const bool writes = !arguments.folder.empty();
  const std::optional<Triangulation> mesh = mesh_of(problem, result, singles, options, writes || arguments.verify);
  if (mesh) {
    const Statistics& s = mesh->statistics;
    told.rounded_together += s.vertices_rounded_together;
    add({s.crossings, s.vertices_added, s.constraints_split, s.constraint_move}, told.split);
    told.refine_added += s.refine.added;
    told.refine_incomplete += !s.refine.complete;
    const Options own = singles.options(problem);
    if (!arguments.quiet) say_notes(problem, *mesh, own);
    if (arguments.verify)
      if (const Verification proof = prove(problem.input, *mesh, own); !proof.valid)
        problem.failure =
            Failure(Exit::check, fmt::format("{}: the result failed its verification: {}", problem.name, proof.reason));
  }
  if (!writes) return;
  std::vector<std::pair<std::string, io::Write>> own;
  if (!problem.failure) own = files_of(problem, *mesh, arguments.folder, formats);
  if (std::count(formats.begin(), formats.end(), collected) > 0)
    collections.add(problem, arguments.folder, problem.failure ? nullptr : &*mesh);
  if (problem.failure) return;
  io::OutputFiles files(stop_if_interrupted);
  io::Result written(problem.input, *mesh);
  written.coloured_by_angle = arguments.colour == "angle";
  for (const auto& [path, write] : own) write(files.add(path), written);
  files.commit();
}

}  // namespace

void triangulate_batch(const BatchArguments& arguments) {
  const std::vector<std::string> formats = formats_of(arguments);
  check_refinement(arguments.refine);
  if (arguments.refine.angle && arguments.verify && arguments.crossing == "split")
    throw Failure(Exit::usage, "--verify does not go with both --refine and --crossing split");
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
  std::vector<double> sizes;
  const Batch batch = read(problems, arguments.refine, options, sizes);
  options.refine = wanted_by(arguments.refine);
  if (options.refine) options.refine->sizes = sizes;
  told.read = reading.milliseconds();
  check_outputs(problems, arguments, formats);
  TraceRecord trace;
  const auto log = [&](int, const char* message) {
    const std::string text = message, plan = "pool plan: ";
    if (text.compare(0, plan.size(), plan) == 0) told.plans.push_back(text.substr(plan.size()));
  };
  Pool pool(arguments.device, log, arguments.trace.empty() ? Trace() : trace.sink());
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
  Singles singles(arguments.device.empty() && chosen ? chosen : arguments.device, arguments, options);
  Collections collections;
  for (Problem& problem : problems) {
    stop_if_interrupted();
    finish(problem, result, arguments, formats, options, singles, told, collections);
    if (!problem.failure) continue;
    ++told.failed;
    if (!first) first = problem.failure->exit();
    complain(problem.failure->what());
  }
  collections.commit();
  told.write = writing.milliseconds() - singles.milliseconds;
  gcdt_batch_statistics counts = result.statistics();
  counts.vertices += singles.vertices, counts.constraints += singles.constraints, counts.triangles += singles.triangles;
  counts.ms_call += singles.milliseconds;
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

// SPDX-License-Identifier: Apache-2.0
#include "batch_inputs.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

#include "io/inputs.hpp"
#include "io/output_files.hpp"
#include "io/paths.hpp"
#include "progress.hpp"

namespace gcdt::command {

namespace fs = std::filesystem;
using io::Exit;
using io::Failure;

namespace {

/// What a folder may hold; of inputs with the same name the first of these kinds is taken.
std::vector<std::string> kinds_in_folders() {
  std::vector<std::string> kinds;
  for (const io::InputFormat& format : io::input_formats())
    if (format.in_folders) kinds.push_back(format.extension);
  for (const char* lines : {".geojsonl", ".ndjson", ".geojsons"}) kinds.push_back(lines);
  return kinds;
}

/// The inputs that an argument stands for: itself, or all of a folder, by name.
std::vector<std::string> inputs_of(const std::string& argument) {
  std::error_code unknown;
  if (!fs::is_directory(argument, unknown)) return {argument};
  const std::vector<std::string> kinds = kinds_in_folders();
  std::set<std::string> found;
  std::error_code failed;
  for (fs::directory_iterator file(argument, failed), end; !failed && file != end; file.increment(failed)) {
    const std::string extension = io::lower_extension(file->path().string());
    for (const std::string& kind : kinds) {
      if (extension == kind) found.insert(file->path().string());
      if (extension == kind || fs::exists(fs::path(file->path()).replace_extension(kind))) break;
    }
  }
  if (failed) throw Failure(Exit::input, fmt::format("{}: {}", argument, failed.message()));
  if (found.empty()) throw Failure(Exit::input, fmt::format("{}: no input in this folder", argument));
  return {found.begin(), found.end()};
}

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

/// Whether the input has points that the options use.
bool uses_seeds(const io::Input& input, const Options& options) {
  const bool by_holes = options.domain == Domain::holes || options.domain == Domain::outer_holes;
  const bool regions = options.regions || options.domain != Domain::hull;
  return (by_holes && !input.holes.empty()) || (regions && !input.regions.empty());
}

}  // namespace

fs::path Problem::output(const std::string& folder, const std::string& format) const {
  const std::string stem = fs::path(path).stem().string();
  return fs::path(folder) / (stem + (line ? fmt::format("-{}", line->number) : "") + format);
}

fs::path Problem::collection(const std::string& folder) const {
  return fs::path(folder) / fs::path(path).filename().replace_extension(collected);
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
      throw Failure(Exit::usage, fmt::format("--format {}: there are {} jsonl", given, io::output_extensions(false)));
    formats.push_back(format);
  }
  return formats;
}

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
    check_is_file_name(other);
    check(other);
    if (!outputs.insert(file(other)).second)
      throw Failure(Exit::usage, fmt::format("{}: given twice as an output", other));
  }
}

Batch read(std::vector<Problem>& problems, const RefineArguments& refine, const Options& options,
           std::vector<double>& sizes) {
  Batch batch;
  for (Problem& problem : problems) {
    stop_if_interrupted();
    try {
      problem.input = problem.line ? io::read_geojson_line(problem.path, *problem.line) : io::read_input(problem.path);
      if (problem.line) problem.line->text = {};
      problem.refinement = std::make_shared<const InputRefinement>(refine, problem.input);
      problem.single = uses_seeds(problem.input, options) || refine.region_areas;
      problem.number = batch.size();
      if (problem.single) continue;
      batch.add(problem.input.vertices, problem.input.constraints);
      if (problem.refinement->wanted()) {
        const Span<double> own = problem.refinement->wanted()->sizes;
        sizes.insert(sizes.end(), own.begin(), own.end());
      }
    } catch (const Failure& failure) {
      problem.failure = failure;
    }
  }
  return batch;
}

}  // namespace gcdt::command

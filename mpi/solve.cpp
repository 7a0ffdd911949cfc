// SPDX-License-Identifier: Apache-2.0
#include "solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "command.hpp"
#include "device/step.hpp"
#include "io/outputs.hpp"
#include "io/paths.hpp"
#include "job.hpp"
#include "progress.hpp"
#include "prove.hpp"
#include "read_block.hpp"
#include "report.hpp"
#include "trace_of_ranks.hpp"
#include "write_pieces.hpp"

namespace gcdt::ranks {

using command::Stopwatch;
using io::Exit;
using io::Failure;

namespace {

bool is_distributed(const Arguments& arguments) {
  return !arguments.outputs.empty() && io::lower_extension(arguments.outputs[0]) == ".pvtu";
}

void check(const Arguments& arguments) {
  for (const std::string& path : arguments.outputs) {
    const std::string extension = io::lower_extension(path);
    if (extension != ".pvtu" && !io::writer_for(extension))
      throw Failure(Exit::usage,
                    fmt::format("{}: unknown output format; there are .pvtu {}", path, io::output_extensions()));
    if (extension == ".pvtu" && arguments.outputs.size() > 1)
      throw Failure(Exit::usage, fmt::format("{}: a .pvtu is the only output, since the ranks keep their parts", path));
    if (io::same_file(path, arguments.input))
      throw Failure(Exit::usage, fmt::format("{}: is an input, and cannot be an output", path));
    if (std::filesystem::absolute(path).parent_path() != std::filesystem::absolute(arguments.outputs[0]).parent_path())
      throw Failure(Exit::usage, fmt::format("{}: all outputs stand in one folder", path));
  }
  if (is_distributed(arguments) && (arguments.domain != "hull" || arguments.regions || arguments.verify))
    throw Failure(Exit::usage,
                  "--domain, --regions and --verify look at the whole mesh: they need an output in one file");
}

std::unique_ptr<DevicePool> device_of(std::size_t rank_on_host, const Arguments& arguments, Trace trace) {
  const std::vector<std::size_t> chosen = runtime::choose_devices(arguments.device);
  DevicePool::Member member{cl::Context(), runtime::all_devices().at(chosen[rank_on_host % chosen.size()]), {}};
  if (arguments.memory > 0) member.hook.tuning.memory_bytes = arguments.memory;
  auto pool = std::make_unique<DevicePool>(std::vector<DevicePool::Member>{member}, runtime::Log(), std::move(trace));
  pool->spill_to(arguments.spill);
  return pool;
}

/// How many each rank has; the same for all.
std::size_t tiles_of(tiles::Team& team, const DevicePool& pool, const tiles::InputBlock& block,
                     const Arguments& arguments) {
  if (arguments.tiles % team.size() != 0)
    throw Failure(Exit::usage,
                  fmt::format("--tiles {}: is no multiple of the number of ranks, {}", arguments.tiles, team.size()));
  std::size_t each = arguments.tiles / team.size();
  if (each == 0)
    each = static_cast<std::size_t>(team.greatest(
        tiles::tiles_that_fit(pool, block.all_vertices / team.size(), block.all_constraints / team.size())));
  if (each * team.size() > GCDT_MAX_TILES)
    throw Failure(Exit::usage,
                  fmt::format("{} tiles of {} ranks: at most {} are possible", each, team.size(), GCDT_MAX_TILES));
  return each * team.size();
}

/// Array by array, so that one at most is there twice.
Triangulation triangulation_of(ForestResult made) {
  Triangulation mesh;
#define GCDT_ARRAY(number, name, ...)                                                \
  if (!made.begins[number].empty()) {                                                \
    const auto all = tiles::array_of<decltype(mesh.name)::value_type>(made, number); \
    mesh.name.assign(all.begin(), all.end());                                        \
    made.arrays[number] = {};                                                        \
  }
#include <gcdt/arrays.def>
  mesh.statistics = made.statistics;
  mesh.added = grid_coordinates(mesh.statistics.grid, mesh.added_on_grid);
  return mesh;
}

class Run {
 public:
  Run(MpiTeam& team, std::size_t rank_on_host, const Arguments& arguments)
      : team_(team), arguments_(arguments), trace_(team), report_(team) {
    options_.crossing = command::crossing_named(arguments.crossing);
    options_.grid = command::grid_from_option(arguments.grid);
    options_.regions = arguments.regions;
    options_.distinct = arguments.distinct;
    command::set_domain(arguments.domain, {}, options_);
    pool_ = device_of(rank_on_host, arguments, arguments.trace.empty() ? Trace() : trace_.sink());
  }

  void solve() {
    const Stopwatch reading;
    tiles::InputBlock block;
    whole_ = {};
    trace_.step("read", [&] { all_or_none(team_, [&] { block = read_block(team_, arguments_.input, whole_); }); });
    report_.step("read") = reading.milliseconds();
    const std::size_t tiles = tiles_of(team_, *pool_, block, arguments_);
    command::ProgressLine line(!arguments_.quiet && team_.is_first());
    Options options = options_;
    if (team_.is_first())
      options.progress = [&](const char* phase, double done) {
        line.show(phase, done);
        return true;
      };
    const Stopwatch solving;
    const auto cut = [&](const tiles::GridInput& given) { return tiles::even_cuts(given, tiles, team_); };
    try {
      trace_.step("solve",
                  [&] { made_ = tiles::triangulate_rank(*pool_, team_, std::move(block), options, tiles, cut); });
    } catch (const Error& error) {
      if (!whole_.files.empty()) throw command::explained(error, whole_, options_);
      if (is_of_problem(error.status()))
        throw Failure(command::exit_for(error.status()), fmt::format("{}: {}", arguments_.input, error.what()));
      throw;
    }
    ForestResult& result = made_.part.result;
    if (!result.together.empty()) {
      result.statistics.vertices_rounded_together = result.together[0].count;
      result.statistics.rounded_pair = result.together[0].first;
    }
    report_.add(made_, *pool_, solving.milliseconds());
  }

  void write() {
    const Stopwatch writing;
    trace_.step("write", [&] {
      if (is_distributed(arguments_))
        write_distributed();
      else if (!arguments_.outputs.empty() || arguments_.verify || options_.regions || options_.domain != Domain::hull)
        write_gathered();
      else
        statistics_ = made_.part.result.statistics;
    });
    report_.step("write") = writing.milliseconds();
  }

  void tell() {
    const std::vector<RankReport> all = report_.gathered();
    const std::string trace = arguments_.trace.empty() ? "" : trace_.gathered();
    if (!team_.is_first()) return;
    describe(all, statistics_);
    io::OutputFiles files;
    if (!arguments_.statistics.empty()) files.add(arguments_.statistics).write(report_json(statistics_, all));
    if (!arguments_.trace.empty()) files.add(arguments_.trace).write(trace);
    files.commit();
    if (arguments_.quiet) return;
    if (arguments_.outputs.empty()) command::print(report_table(statistics_, all));
  }

 private:
  void write_distributed() {
    statistics_ = made_.part.result.statistics;
    const std::filesystem::path target = arguments_.outputs[0];
    const std::vector<std::string> names = piece_names(team_, target);
    std::vector<std::string> targets, former;
    for (const std::string& name : names) targets.push_back((target.parent_path() / name).string());
    targets.push_back(target.string());
    OutputJob job(team_, targets);
    all_or_none(team_, [&] {
      io::OutputFiles files;
      write_piece(files.add(job.temporary(team_.rank())), team_, made_);
      if (team_.is_first()) write_pvtu(files.add(job.temporary(team_.size())), names);
      files.commit();
    });
    if (team_.is_first()) former = pieces_named_by(target);
    job.commit();
    std::error_code ignored;
    for (const std::string& name : former) std::filesystem::remove(target.parent_path() / name, ignored);
  }

  void write_gathered() {
    if (team_.is_first() && whole_.files.empty()) whole_ = io::read_input(arguments_.input);
    Options options = options_;
    command::set_domain(arguments_.domain, whole_, options);
    const std::vector<std::string> paths =
        io::with_nodes(arguments_.outputs, made_.part.result.statistics.vertices_added > 0, {arguments_.input});
    ForestResult made = tiles::gather_result(team_, made_, whole_.vertices, whole_.constraints, options);
    Triangulation mesh;
    if (team_.is_first()) mesh = triangulation_of(std::move(made));
    statistics_ = mesh.statistics;
    if (arguments_.verify)
      all_or_none(team_, [&] {
        if (!team_.is_first()) return;
        if (const Verification proof = command::prove(whole_, mesh, options); !proof.valid)
          throw Failure(Exit::check, fmt::format("the result failed its verification: {}", proof.reason));
      });
    if (arguments_.outputs.empty()) return;
    OutputJob job(team_, paths);
    all_or_none(team_, [&] {
      if (!team_.is_first()) return;
      io::OutputFiles files;
      const io::Result result(whole_, mesh);
      for (std::size_t i = 0; i < paths.size(); ++i)
        io::writer_for(io::lower_extension(paths[i]))(files.add(job.temporary(i)), result);
      files.commit();
    });
    job.commit();
  }

  MpiTeam& team_;
  const Arguments& arguments_;
  Options options_;
  TraceOfRanks trace_;  ///< outlives the pool
  std::unique_ptr<DevicePool> pool_;
  io::Input whole_;  ///< at the first rank, where that has read it
  tiles::RankResult made_;
  Statistics statistics_;
  Report report_;
};

}  // namespace

void solve(MpiTeam& team, std::size_t rank_on_host, const Arguments& arguments) {
  check(arguments);
  Run run(team, rank_on_host, arguments);
  for (std::uint32_t i = 0; i < arguments.repeat; ++i) run.solve();
  run.write();
  run.tell();
}

}  // namespace gcdt::ranks

// SPDX-License-Identifier: Apache-2.0
// The command gcdt_mpi: arguments in, status out.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <new>
#include <thread>

#include "command.hpp"
#include "job.hpp"
#include "solve.hpp"

namespace {

using namespace gcdt;
using io::Exit;

constexpr const char* help =
    "Runs under mpirun, one rank a device: mpirun --bind-to none -n 4 gcdt_mpi INPUT -o OUTPUT\n"
    "Each rank reads its own part of a .pslg; other inputs of gcdt triangulate are read by the first rank.\n"
    "OUTPUT.pvtu leaves the result where it was made, a piece OUTPUT_RANK.vtu a rank; any other output of gcdt\n"
    "triangulate is gathered at the first rank, and has the bytes that gcdt triangulate writes. Files appear together "
    "or\n"
    "not at all. Without -o the statistics are printed, with the time of each step at each rank.\n\n"
    "Status: as of gcdt. If a rank is lost, or fails alone, all end.";

// How long a rank that fails waits for all others to fail as well, which they do at once if the input is at fault.
constexpr auto patience = std::chrono::seconds(3);

void add_options(CLI::App& app, ranks::Arguments& arguments) {
  app.add_option("INPUT", arguments.input, "A file that gcdt triangulate takes")->required()->type_name("");
  app.add_option("-o,--output", arguments.outputs, "A file to write; several, in one folder, if none is a .pvtu")
      ->allow_extra_args(false)
      ->type_name("OUTPUT");
  app.add_option("--crossing", arguments.crossing, "What happens to constraints that cross, as of gcdt triangulate")
      ->check(CLI::IsMember({"reject", "drop", "split"}).description(""))
      ->type_name("reject|drop|split")
      ->capture_default_str();
  app.add_option("--domain", arguments.domain, "Which triangles are kept of a result that is gathered")
      ->check(CLI::IsMember({"hull", "even-odd", "nonzero", "holes", "outer", "outer-holes"}).description(""))
      ->type_name("hull|even-odd|nonzero|holes|outer|outer-holes")
      ->capture_default_str();
  app.add_flag("--regions", arguments.regions, "Find the regions of a result that is gathered");
  app.add_option("--grid", arguments.grid, "Round the vertices to this grid")->type_name("X,Y,CELL");
  app.add_flag("--distinct", arguments.distinct, "Refuse input of which rounding makes vertices one that differ");
  app.add_option("--device", arguments.device,
                 "Devices of each machine, as of gcdt batch; its ranks take them in turn; default: the variable "
                 "GCDT_DEVICE, else auto")
      ->type_name("SPEC,...");
  app.add_option(
         "--tiles", arguments.tiles,
         "Tiles of all ranks together, as many for each; default: one a rank, or as many as its device's memory "
         "asks for")
      ->check(CLI::Range(1u, GCDT_MAX_TILES).description(""))
      ->type_name("K");
  app.add_option("--memory", arguments.memory, "Use no more memory of each device than this, such as 512MB")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->type_name("SIZE");
  app.add_option("--spill", arguments.spill, "Directory for files to which tiles go that a device has no room for")
      ->type_name("DIRECTORY");
  app.add_option("--stats", arguments.statistics, "Write the statistics as JSON, with those of each rank")
      ->type_name("FILE.json");
  app.add_flag("--verify", arguments.verify,
               "Prove a result that is gathered once more on the host, before it is written");
  app.add_option("--trace", arguments.trace, "Write where the time went at all ranks, for Perfetto")
      ->type_name("FILE.json");
  app.add_option("--repeat", arguments.repeat, "Read and solve so many times, and tell of the last one, for timing")
      ->check(CLI::Range(1u, 1000000u).description(""))
      ->type_name("N");
  app.add_flag("--quiet", arguments.quiet, "Print errors only");
  app.footer(help);
}

/// Whether all ranks come here soon.
bool all_failed(MPI_Comm failures) {
  MPI_Request request;
  MPI_Ibarrier(failures, &request);
  const auto begin = std::chrono::steady_clock::now();
  for (int done = 0; std::chrono::steady_clock::now() - begin < patience;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

/// What all ranks found, the first one tells. What one found ends the others, too.
int fail(MPI_Comm failures, int rank, Exit exit, const std::string& what) {
  const auto status = static_cast<int>(exit);
  if (all_failed(failures)) {
    if (rank == 0) std::fputs(fmt::format("gcdt_mpi: {}\n", what).c_str(), stderr);
    return status;
  }
  std::fputs(fmt::format("gcdt_mpi: rank {}: {}\n", rank, what).c_str(), stderr);
  std::fflush(stderr);
  MPI_Abort(MPI_COMM_WORLD, status);
  return status;
}

int rank_on_host(MPI_Comm all) {
  MPI_Comm host;
  MPI_Comm_split_type(all, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &host);
  int rank = 0;
  MPI_Comm_rank(host, &rank);
  MPI_Comm_free(&host);
  return rank;
}

int run(int argc, char** argv, MPI_Comm failures) {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  CLI::App app("Exact constrained Delaunay triangulation on the devices of many machines", "gcdt_mpi");
  ranks::Arguments arguments;
  app.set_version_flag("--version", std::string("gcdt_mpi ") + version());
  add_options(app, arguments);
  const auto failed = [&](Exit exit, const std::string& what) { return fail(failures, rank, exit, what); };
  try {
    app.parse(argc, argv);
    ranks::MpiTeam team(MPI_COMM_WORLD);
    ranks::solve(team, static_cast<std::size_t>(rank_on_host(MPI_COMM_WORLD)), arguments);
    return 0;
  } catch (const CLI::Success& shown) {
    return rank == 0 ? app.exit(shown) : 0;
  } catch (const CLI::ParseError& error) {
    return failed(Exit::usage, fmt::format("{} (see gcdt_mpi --help)", error.what()));
  } catch (const io::Failure& failure) {
    return failed(failure.exit(), failure.what());
  } catch (const Error& error) {
    return failed(command::exit_for(error.status()), error.what());
  } catch (const std::bad_alloc&) {
    return failed(Exit::device, "out of memory");
  } catch (const std::exception& error) {
    return failed(Exit::device, error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  ranks::watch_end();
  MPI_Init(&argc, &argv);
  MPI_Comm failures;
  MPI_Comm_dup(MPI_COMM_WORLD, &failures);
  const int status = run(argc, argv, failures);
  MPI_Comm_free(&failures);
  MPI_Finalize();
  return status;
}

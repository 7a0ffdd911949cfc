// SPDX-License-Identifier: Apache-2.0
// Triangulates named workloads on one device and prints a line for each: name, size, hash of the
// result, milliseconds core and full, rounds of insertion and flipping, flips. The first columns must be equal
// on every device, driver and thread count.
//   result_hash DEVICE NAME SIZE [RUNS]   one workload, RUNS times
//   result_hash DEVICE all [MAXIMUM]      the standard list, up to MAXIMUM vertices
//   result_hash DEVICE table FILE         the table FILE (tests/hashes.txt) with its hashes made anew
// With GCDT_LAUNCHES in the environment, every launch on the device is printed with its microseconds.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "kept_hashes.hpp"

namespace {

using namespace gcdt::test;

struct Entry {
  const char* name;
  std::size_t size;
};

const Entry standard_list[] = {
    {"uniform", 3},
    {"uniform", 1000},
    {"uniform", 100000},
    {"uniform", 1000000},
    {"gaussian", 100000},
    {"ring", 100000},
    {"clusters", 10000},
    {"clusters", 200000},
    {"grid", 1024},
    {"grid", 1048576},
    {"lattice_circle", 12288},
    {"near_circle", 100000},
    {"collinear_runs", 8000},
    {"line", 1000},
    {"line_and_one", 1000},
    {"comb", 2000},
    {"spiral", 100000},
    {"star", 1000000},
    {"fan", 200000},
    {"nested_squares", 4000},
    {"hub", 2000},
    {"two_clusters", 20000},
    {"parabola", 40000},
    {"letters", 98000},
    {"letters", 970000},
    {"random_pslg", 60},
    {"random_pslg", 300},
    {"synthetic_cons_1", 1000000},
    {"synthetic_cons_6", 1000000},
};

/// False, and a line on standard error, if the workload failed.
bool run(gcdt::Solver& solver, const std::string& name, std::size_t size, int runs) try {
  const Workload work = make_workload(solver, name, size);
  for (int i = 0; i < runs; ++i) {
    const gcdt::Triangulation result = solver.triangulate(work.points, work.constraints);
    const gcdt::Statistics& s = result.statistics;
    std::printf("%-18s %8zu %016" PRIx64 " core %.1f full %.1f insert %" PRIu64 " flip %" PRIu64 " flips %" PRIu64 "\n",
                name.c_str(), size, result_hash(result), s.ms.core, s.ms.full, s.rounds.insert, s.rounds.flip, s.flips);
    std::fflush(stdout);
  }
  return true;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s %zu: %s\n", name.c_str(), size, error.what());
  return false;
}

/// The table's comments stay as they are.
void print_table(const std::string& device, const std::string& path) {
  Hasher hasher(device);
  std::ifstream file(path);
  for (std::string line; std::getline(file, line) && (line.empty() || line[0] == '#');)
    std::printf("%s\n", line.c_str());
  for (const KeptHash& row : read_kept_hashes(path)) {
    std::printf("%-16s %6zu %-20s %s\n", row.name.c_str(), row.n, row.how.c_str(), hasher.hash(row).c_str());
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** arguments) try {
  if (count == 4 && std::string(arguments[2]) == "table") {
    print_table(arguments[1], arguments[3]);
    return 0;
  }
  const bool all = count >= 3 && std::string(arguments[2]) == "all";
  if (count < (all ? 3 : 4) || count > (all ? 4 : 5)) {
    std::fprintf(stderr,
                 "usage: result_hash DEVICE NAME SIZE [RUNS] | result_hash DEVICE all [MAXIMUM] |\n"
                 "       result_hash DEVICE table FILE\n");
    return 2;
  }
  gcdt::Trace trace;
  if (std::getenv("GCDT_LAUNCHES"))
    trace = [](const gcdt::TraceSpan& span) {
      if (span.on_device)
        std::printf("    %-24s %9.1f us\n", span.name.c_str(), double(span.end_ns - span.begin_ns) / 1000);
    };
  gcdt::Solver solver(arguments[1], {}, trace);
  std::fprintf(stderr, "%s (%s, %s)\n", solver.device().name.c_str(), solver.device().platform.c_str(),
               solver.device().driver.c_str());
  bool good = true;
  if (!all)
    return run(solver, arguments[2], std::strtoull(arguments[3], nullptr, 10), count == 5 ? std::atoi(arguments[4]) : 1)
               ? 0
               : 1;
  const std::size_t maximum = count == 4 ? std::strtoull(arguments[3], nullptr, 10) : SIZE_MAX;
  for (const Entry& entry : standard_list)
    if (entry.size <= maximum) good &= run(solver, entry.name, entry.size, 1);
  return good ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

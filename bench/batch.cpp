// SPDX-License-Identifier: Apache-2.0
// Times a batch on sets of devices, each against the first of them and against CGAL on one core, verifies a sample, and
// prints a row of JSON for each set (bench/README.md, "Batches").
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <gcdt/gcdt_pool.hpp>
#include <gcdt/verify.hpp>

#include "batch_inputs.hpp"
#include "results.hpp"
#include "row.hpp"
#ifdef GCDT_BENCH_CGAL
#include "peers/cgal_batch.hpp"
#endif

namespace {

using namespace gcdt;
using namespace gcdt::bench;

// One problem in so many is proved on the host.
constexpr std::size_t verified_step = 101;
constexpr std::size_t large_vertices = 1000000;
constexpr int most_cgal_runs = 3;
// Programs are built, kernels compiled and speeds measured in them.
constexpr int unmeasured_runs = 2;

constexpr char usage[] =
    "gcdt_bench_batch [--mixed | --crossing K [--policy P]] [--problems N] [--runs R] [--no-cgal] [--scaling | "
    "SET...]\n"
    "  SET        devices, as for gcdt batch: all, gpu, cpu, 0,1 ...; the first set is the base of `ratio`\n"
    "  --scaling  the first GPU; 2, 4 ... of them; all; one with the CPUs beside it; all devices. Without GPUs: auto\n"
    "  --no-cgal  without the peer, which takes a minute for 100000 problems\n"
    "  --mixed    one problem of 1,000,000 vertices beside N of 20, instead of N sketches of 10 to 1000\n"
    "  --crossing constraints of K of the sketches cross; `ratio` is to the batch without these, timed by turns\n"
    "  --policy   what becomes of them: reject, drop, split\n"
    "  N: 100000, 10000 with --mixed, 5000 with --crossing; R: timed calls a set, 5\n";

struct Arguments {
  bool mixed = false, scaling = false, cgal = true;
  std::size_t problems = 0, crossing = 0;
  Crossing policy = Crossing::reject;
  int runs = 5;
  std::vector<std::string> sets;
};

constexpr const char* policies[] = {"reject", "drop", "split"};  // as Crossing

bool read_policy(const std::string& name, Crossing& policy) {
  const auto* found = std::find(std::begin(policies), std::end(policies), name);
  if (found == std::end(policies)) return false;
  policy = static_cast<Crossing>(found - std::begin(policies));
  return true;
}

bool parse(int argc, char** argv, Arguments& arguments) {
  for (int i = 1; i < argc; ++i) {
    const std::string given = argv[i];
    if (given == "--mixed") {
      arguments.mixed = true;
    } else if (given == "--scaling") {
      arguments.scaling = true;
    } else if (given == "--no-cgal") {
      arguments.cgal = false;
    } else if (given == "--crossing" && i + 1 < argc) {
      arguments.crossing = std::strtoull(argv[++i], nullptr, 10);
      if (arguments.crossing == 0) return false;
    } else if (given == "--policy" && i + 1 < argc) {
      if (!read_policy(argv[++i], arguments.policy)) return false;
    } else if (given == "--problems" && i + 1 < argc) {
      arguments.problems = std::strtoull(argv[++i], nullptr, 10);
      if (arguments.problems == 0) return false;
    } else if (given == "--runs" && i + 1 < argc) {
      arguments.runs = std::atoi(argv[++i]);
    } else if (given.compare(0, 2, "--") != 0) {
      arguments.sets.push_back(given);
    } else {
      return false;
    }
  }
  if (arguments.problems == 0) arguments.problems = arguments.mixed ? 10000 : arguments.crossing > 0 ? 5000 : 100000;
  return arguments.runs > 0 && (arguments.sets.empty() || !arguments.scaling) &&
         arguments.crossing <= (arguments.mixed ? 0 : arguments.problems);
}

/// Numbers of devices as a set.
std::string set_of(const std::vector<std::size_t>& numbers, std::size_t count) {
  std::string set;
  for (std::size_t i = 0; i < count; ++i) set += (i ? "," : "") + std::to_string(numbers[i]);
  return set;
}

std::vector<std::string> scaling_sets() {
  std::vector<std::size_t> gpus;
  const std::vector<DeviceInfo> all = devices();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].is_gpu) gpus.push_back(i);
  if (gpus.empty()) return {""};
  std::vector<std::string> sets;
  for (std::size_t count = 1; count < gpus.size(); count *= 2) sets.push_back(set_of(gpus, count));
  sets.push_back(set_of(gpus, gpus.size()));
  if (all.size() > gpus.size()) {
    sets.push_back(set_of(gpus, 1) + ",cpu");
    if (gpus.size() > 1) sets.push_back("all");
  }
  return sets;
}

template <class F>
double milliseconds(F&& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// The first fault found in a sample; empty if there is none.
std::string fault(const SketchBatch& batch, const BatchResult& result) {
  for (std::size_t p = 0; p < batch.size(); ++p)
    if (const auto error = result.error(p)) return "problem " + std::to_string(p) + ": " + error->what();
  for (std::size_t p = 0; p < batch.size(); p += verified_step) {
    const std::uint64_t v = batch.vertex_offsets[p], c = batch.constraint_offsets[p];
    MeshView view;
    view.triangles = result.triangles(p);
    view.neighbours = result.neighbours(p).data();
    view.constrained = result.constrained(p).data();
    const Span<std::array<double, 2>> points(batch.vertices.data() + v, batch.vertex_offsets[p + 1] - v);
    const Constraints lines(batch.constraints.data() + c, batch.constraint_offsets[p + 1] - c);
    const Verification proof = verify(points, lines, view, result.grid(p));
    if (!proof.valid) return "problem " + std::to_string(p) + ": " + proof.reason;
  }
  return {};
}

/// One number for all bytes of all problems' triangles, neighbours and flags: equal on every set of devices.
std::string hash(const SketchBatch& batch, const BatchResult& result) {
  std::uint64_t h = 0xcbf29ce484222325u;  // FNV-1a
  const auto mix = [&h](const void* data, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) h = (h ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001b3u;
  };
  for (std::size_t p = 0; p < batch.size(); ++p) {
    const auto triangles = result.triangles(p);
    mix(triangles.data(), 12 * triangles.size());
    mix(result.neighbours(p).data(), 12 * triangles.size());
    mix(result.constrained(p).data(), triangles.size());
  }
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(h));
  return text;
}

/// What CGAL takes, and how many triangles it has; 0 without CGAL.
struct CgalTimes {
  double ms = 0;
  std::uint64_t triangles = 0;
};

CgalTimes time_cgal([[maybe_unused]] const SketchBatch& batch, [[maybe_unused]] int runs) {
  CgalTimes peer;
#ifdef GCDT_BENCH_CGAL
  std::vector<double> times;
  for (int i = 0; i < std::min(runs, most_cgal_runs); ++i)
    times.push_back(milliseconds([&] { peer.triangles = triangulate_with_cgal(batch); }));
  peer.ms = median(times);
#endif
  return peer;
}

/// What the first set took and gave.
struct Base {
  double ms = 0;
  std::string bytes;
};

/// Times one set of devices and prints its row. Returns whether all is as it should be.
bool time_set(const std::string& set, const SketchBatch& batch, const Arguments& arguments, const CgalTimes& peer,
              Base& base) {
  const BatchView view = {batch.vertices, batch.vertex_offsets, batch.constraints, batch.constraint_offsets};
  Pool pool(set);
  std::string found, bytes;
  std::uint64_t triangles = 0;
  {
    for (int i = 0; i < unmeasured_runs; ++i) pool.triangulate(view);
    const BatchResult first = pool.triangulate(view);
    found = fault(batch, first);
    bytes = hash(batch, first);
    triangles = first.statistics().triangles;
  }
  std::vector<double> times;
  for (int i = 0; i < arguments.runs; ++i) {
    std::optional<BatchResult> result;  // gone when the time is taken
    times.push_back(milliseconds([&] { result.emplace(pool.triangulate(view)); }));
    if (result->statistics().triangles != triangles) found = "the calls differ";
  }
  const double ms = median(times);
  if (base.bytes.empty()) base = {ms, bytes};
  if (found.empty() && bytes != base.bytes) found = "other bytes than the first set";
  if (found.empty() && peer.ms > 0 && peer.triangles != triangles)
    found = "CGAL has " + std::to_string(peer.triangles) + " triangles";
  std::string shares;
  for (const PoolDevice& device : pool.devices())
    shares += (shares.empty() ? "" : ", ") + device.info.name + ": " +
              (device.lost ? "taken out" : std::to_string(device.problems));
  Object row;
  row.add("set", set.empty() ? "auto" : set).add("workload", arguments.mixed ? "one_large" : "sketches");
  row.add("problems", static_cast<unsigned long long>(batch.size()));
  row.add("n", static_cast<unsigned long long>(batch.vertices.size()));
  row.add("m", static_cast<unsigned long long>(batch.constraints.size()));
  row.add("triangles", static_cast<unsigned long long>(triangles));
  row.add("call_ms", ms).add("least_ms", *std::min_element(times.begin(), times.end()));
  row.add("most_ms", *std::max_element(times.begin(), times.end())).add("ratio", ms / base.ms);
  if (peer.ms > 0) row.add("cgal_ms", peer.ms).add("speedup", peer.ms / ms);
  row.add("devices", shares).add("bytes", bytes);
  row.add("verified", found.empty()).add("fault", found).add("date", date());
  std::printf("%s\n", row.text().c_str());
  std::fflush(stdout);
  return found.empty();
}

/// The first fault among the crossed sketches; empty if there is none.
std::string crossed_fault(const Arguments& arguments, const BatchResult& result) {
  for (std::size_t p = 0; p < arguments.problems; ++p) {
    const bool refused = arguments.policy == Crossing::reject && is_crossed(p, arguments.problems, arguments.crossing);
    const auto error = result.error(p);
    if (error.has_value() != refused || (refused && error->status() != Status::constraints_cross))
      return "problem " + std::to_string(p) + (error ? std::string(": ") + error->what() : " is not refused");
  }
  return {};
}

/// Times sketches of which some cross, and the same batch without these, by turns, and prints their row.
bool time_crossing(const std::string& set, const Arguments& arguments) {
  const SketchBatch batch = crossed_sketches(arguments.problems, arguments.crossing, false),
                    rest = crossed_sketches(arguments.problems, arguments.crossing, true);
  const BatchView view = {batch.vertices, batch.vertex_offsets, batch.constraints, batch.constraint_offsets},
                  rest_view = {rest.vertices, rest.vertex_offsets, rest.constraints, rest.constraint_offsets};
  Options options;
  options.crossing = arguments.policy;
  Pool pool(set);
  std::string found;
  std::vector<double> times, rest_times;
  for (int i = 0; i < unmeasured_runs + arguments.runs; ++i) {
    std::optional<BatchResult> result, rest_result;
    const double ms = milliseconds([&] { result.emplace(pool.triangulate(view, options)); });
    const double rest_ms = milliseconds([&] { rest_result.emplace(pool.triangulate(rest_view, options)); });
    if (i == 0) found = crossed_fault(arguments, *result);
    if (i == 0 && rest_result->statistics().failed > 0) found = "a sketch without crossings has an error";
    if (i < unmeasured_runs) continue;
    times.push_back(ms);
    rest_times.push_back(rest_ms);
  }
  Object row;
  row.add("set", set.empty() ? "auto" : set).add("workload", "crossed_sketches");
  row.add("policy", policies[static_cast<int>(arguments.policy)]);
  row.add("problems", static_cast<unsigned long long>(arguments.problems));
  row.add("crossing", static_cast<unsigned long long>(arguments.crossing));
  row.add("call_ms", median(times)).add("least_ms", *std::min_element(times.begin(), times.end()));
  row.add("rest_ms", median(rest_times)).add("least_rest_ms", *std::min_element(rest_times.begin(), rest_times.end()));
  row.add("ratio", median(times) / median(rest_times));
  row.add("verified", found.empty()).add("fault", found).add("date", date());
  std::printf("%s\n", row.text().c_str());
  std::fflush(stdout);
  return found.empty();
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  if (!parse(argc, argv, arguments)) return std::fputs(usage, stderr), 2;
  try {
    if (arguments.scaling) arguments.sets = scaling_sets();
    if (arguments.sets.empty()) arguments.sets = {""};
    if (arguments.crossing > 0) {
      bool right = true;
      for (const std::string& set : arguments.sets) right = time_crossing(set, arguments) && right;
      return right ? 0 : 1;
    }
    const SketchBatch batch =
        arguments.mixed ? one_large(large_vertices, arguments.problems) : sketches(arguments.problems);
    const CgalTimes peer = arguments.cgal ? time_cgal(batch, arguments.runs) : CgalTimes();
    Base base;
    bool right = true;
    for (const std::string& set : arguments.sets) right = time_set(set, batch, arguments, peer, base) && right;
    return right ? 0 : 1;
  } catch (const Error& error) {
    return std::fprintf(stderr, "gcdt_bench_batch: %s\n", error.what()), 4;
  }
}

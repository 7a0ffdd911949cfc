// SPDX-License-Identifier: Apache-2.0
// What each idea is worth: core with one of them changed at a time (paper, figure 15; bench/README.md, "Ablation").
// Reaches the internals through the static library. Every variant must give the same triangles.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "batch/device_pool.hpp"
#include "batch_inputs.hpp"
#include "inputs.hpp"
#include "solve/triangulate.hpp"

namespace {

using namespace gcdt;

struct Variant {
  std::string name;
  runtime::CallHook hook;
};

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("the kernels have no \"" + from + "\" any more");
  text.replace(at, from.size(), to);
}

/// Vertices in the order of Morton codes times an odd number: any order that still brings equal ones together.
void shuffle_vertices(std::string& text) {
  constexpr char mask[] = " & 0x3FFFFFFFFFFFFFFFul)";
  if (text.find("kernel void number_vertices") == std::string::npos) return;
  const std::string code = "gcdt_morton(x.value, y.value)", decimal = "gcdt_morton(grid[0], grid[1])";
  for (const std::string& key : {code, decimal}) replace(text, key, "((" + key + " * 0x9E3779B97F4A7C15ul)" + mask);
  const std::string back = "((keys[i] * 0xF1DE83E19937733Dul)" + std::string(mask);  // times that is 1 mod 2^64
  replace(text, "gcdt_gather_bits(keys[i])", "gcdt_gather_bits(" + back + ")");
  replace(text, "gcdt_gather_bits(keys[i] >> 1)", "gcdt_gather_bits(" + back + " >> 1)");
}

std::vector<Variant> variants(std::uint32_t vertices) {
  std::vector<Variant> all;
  const auto add = [&](const std::string& name) -> runtime::CallHook& {
    all.push_back({name, {}});
    return all.back().hook;
  };
  add("as it is");
  for (std::uint32_t levels = 1; levels <= 8; ++levels)
    add("levels " + std::to_string(levels)).tuning.coarsest_level = std::max(1u, vertices >> 2 * (levels - 1));
  for (const char* chain : {"1", "4", "8", "16", "32"})
    add(std::string("flips in a row ") + chain).options = std::string("-UGCDT_FLIP_CHAIN -DGCDT_FLIP_CHAIN=") + chain;
  for (const std::uint32_t rounds : {1u, 2u, 8u, 16u})
    add("rounds a read " + std::to_string(rounds)).tuning.rounds_per_read = rounds;
  add("one work-item a constraint").tuning.part_pool = 0;
  for (const std::uint32_t crossings : {4u, 16u, 32u})
    add("crossings a part " + std::to_string(crossings)).tuning.crossings_per_part = crossings;
  for (const bool sorted : {false, true})
    add(sorted ? "constraints cleaned along the curve" : "constraints cleaned as given").tuning.curve_crossings =
        sorted ? 0 : UINT32_MAX;
  add("vertices shuffled").edit = shuffle_vertices;
  return all;
}

/// The same for the same triangles in any order.
std::uint64_t hash(runtime::Runtime& runtime, const DeviceTriangulation& result) {
  std::vector<cl_uint> corners(3 * std::size_t{result.mesh.triangles});
  runtime.read(result.mesh.corners, corners.data(), corners.size());
  std::uint64_t sum = 0;
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const auto first = corners.begin() + static_cast<std::ptrdiff_t>(t);
    std::rotate(first, std::min_element(first, first + 3), first + 3);
    std::uint64_t h = 0;
    for (std::size_t k = t; k < t + 3; ++k) h = (h ^ corners[k]) * 0x9E3779B97F4A7C15u, h ^= h >> 29;
    sum += h;
  }
  return sum;
}

struct Measured {
  double core = 0;
  std::uint64_t hash = 0;
  Statistics statistics;
};

/// The median of `runs` calls after two that build and warm up.
Measured measure(const cl::Device& device, const Variant& variant, const test::Workload& input, int runs) {
  runtime::Runtime runtime(device, variant.hook);
  Primitives primitives(runtime);
  const Options options;
  std::vector<double> times;
  Measured measured;
  for (int i = -2; i < runs; ++i) {
    runtime.memory().begin_call();
    const Points points = input.points;
    const Constraints constraints = input.constraints;
    const InputSource source = {points.size(), constraints.size(), [&] {
                                  return DeviceInput{stage(runtime, points), stage(runtime, constraints)};
                                }};
    const DeviceTriangulation result = triangulate(runtime, primitives, source, options);
    if (i == -2) measured.hash = hash(runtime, result);
    if (i >= 0) times.push_back(result.statistics.ms.core);
    measured.statistics = result.statistics;
  }
  std::nth_element(times.begin(), times.begin() + runs / 2, times.end());
  measured.core = times[static_cast<std::size_t>(runs) / 2];
  return measured;
}

/// One table of Markdown. Returns whether all triangles were the same.
bool run(const cl::Device& device, const bench::Input& input, int runs) {
  const bench::Workload work =
      bench::make(input, [](const std::vector<bench::Point>& points) { return triangulate(points).triangles; });
  std::printf("\n%s, %zu vertices, %zu constraints\n\n", input.name.c_str(), work.points.size(),
              work.constraints.size());
  std::printf(
      "| variant | core ms | of it as it is | cleaning ms | insert rounds | flip rounds | flips | launches | reads "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  Measured base;
  bool same = true;
  for (const Variant& variant : variants(static_cast<std::uint32_t>(work.points.size()))) {
    const Measured m = measure(device, variant, work, runs);
    if (base.core == 0) base = m;
    same = same && m.hash == base.hash;
    const Statistics& s = m.statistics;
    std::printf("| %s%s | %.2f | %.2f | %.2f | %llu | %llu | %llu | %llu | %llu |\n", variant.name.c_str(),
                m.hash == base.hash ? "" : " OTHER TRIANGLES", m.core, m.core / base.core, s.ms.clean,
                static_cast<unsigned long long>(s.rounds.insert), static_cast<unsigned long long>(s.rounds.flip),
                static_cast<unsigned long long>(s.flips), static_cast<unsigned long long>(s.launches),
                static_cast<unsigned long long>(s.read_backs));
    std::fflush(stdout);
  }
  return same;
}

/// A batch on one device.
struct DeviceBatch {
  const cl::Device& device;
  const bench::SketchBatch batch;

  explicit DeviceBatch(const cl::Device& on) : device(on), batch(bench::sketches(100000)) {}
  BatchInput input() const {
    return {batch.size(),
            Points::Type::float64,
            batch.vertices.data(),
            batch.vertex_offsets.data(),
            batch.constraints.data(),
            batch.constraint_offsets.data()};
  }
  DevicePool pool(std::uint32_t workers, bool shared, Trace trace) const {
    DevicePool::Member member{cl::Context(), device, {}};
    member.hook.tuning.workers = workers;
    member.hook.tuning.shares_context = shared;
    return DevicePool({member}, {}, std::move(trace));
  }
};

/// A batch with several runs at once on the device, all in one context, or each in one of its own.
void run_workers(const DeviceBatch& on, int runs) {
  std::printf("\n%zu sketches, %zu vertices\n\n| runs at once | contexts | call ms | runs | first call ms |\n",
              on.batch.size(), on.batch.vertices.size());
  std::printf("|---|---|---|---|---|\n");
  const auto measure_workers = [&](std::uint32_t workers, bool shared) {
    const auto start = std::chrono::steady_clock::now();
    DevicePool pool = on.pool(workers, shared, {});
    double first = 0;
    std::vector<double> times;
    for (int i = -1; i < runs; ++i) {
      const double ms = pool.triangulate(on.input(), {}).milliseconds;
      if (i >= 0)
        times.push_back(ms);
      else
        first = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    }
    std::nth_element(times.begin(), times.begin() + runs / 2, times.end());
    std::printf("| %u | %u | %.1f | %llu | %.1f |\n", workers, shared ? 1 : workers,
                times[static_cast<std::size_t>(runs) / 2], static_cast<unsigned long long>(pool.report(0).runs), first);
    std::fflush(stdout);
  };
  for (std::uint32_t workers = 1; workers <= 6; ++workers) measure_workers(workers, true);
  for (std::uint32_t workers = 2; workers <= 3; ++workers) measure_workers(workers, false);
}

/// What each kernel takes in such a batch, one run at a time, so that no other's launches are beside it.
void run_kernels(const DeviceBatch& on) {
  struct Sum {
    std::uint64_t launches = 0, ns = 0;
  };
  std::map<std::string, Sum> kernels;
  Sum all;
  bool counted = false;
  DevicePool pool = on.pool(1, true, [&](const TraceSpan& span) {
    if (!counted || !span.on_device) return;
    for (Sum* sum : {&kernels[span.phase + " " + span.name], &all})
      ++sum->launches, sum->ns += span.end_ns - span.begin_ns;
  });
  for (const bool count : {false, false, true}) {  // programs are built, then memory is made
    counted = count;
    pool.triangulate(on.input(), {});
  }
  std::vector<std::pair<std::string, Sum>> sorted(kernels.begin(), kernels.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second.ns > b.second.ns; });
  sorted.emplace_back("all", all);
  std::printf("\n| phase, kernel | launches | ms | share |\n|---|---|---|---|\n");
  for (const auto& [name, sum] : sorted)
    std::printf("| %s | %llu | %.2f | %.3f |\n", name.c_str(), static_cast<unsigned long long>(sum.launches),
                1e-6 * static_cast<double>(sum.ns), static_cast<double>(sum.ns) / static_cast<double>(all.ns));
}

}  // namespace

int main(int count, char** arguments) try {
  const bool batches = count > 1 && std::strcmp(arguments[1], "--batches") == 0;
  if (batches) --count, ++arguments;
  if (count > 3) {
    std::fprintf(stderr, "usage: gcdt_bench_ablation [--batches] [DEVICE [RUNS]]\n");
    return 2;
  }
  const cl::Device device = runtime::all_devices().at(select_device(count > 1 ? arguments[1] : "auto"));
  const int runs = count > 2 ? std::atoi(arguments[2]) : 11;
  bool same = true;
  if (!batches)
    for (const char* name : {"uniform", "synthetic_cons_1", "synthetic_cons_6", "letters"})
      same = run(device, {name, name == std::string("letters") ? 970000u : 1000000u, {}}, std::max(1, runs)) && same;
  const DeviceBatch on(device);
  run_workers(on, std::max(1, std::min(runs, 5)));
  run_kernels(on);
  return same ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "gcdt_bench_ablation: %s\n", error.what());
  return 1;
}

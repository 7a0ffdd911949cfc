// SPDX-License-Identifier: Apache-2.0
// Times a batch of small problems on a pool of devices, and CGAL on one core on the same problems, verifies a sample,
// and prints a row of JSON (bench/README.md, "Batches"): gcdt_bench_batch [DEVICES [PROBLEMS [RUNS]]]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
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
    view.neighbours = result.neighbours(p).data;
    view.constrained = result.constrained(p).data;
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
    mix(triangles.data, 12 * triangles.size);
    mix(result.neighbours(p).data, 12 * triangles.size);
    mix(result.constrained(p).data, triangles.size);
  }
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(h));
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string devices = argc > 1 ? argv[1] : "";
  const std::size_t problems = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 100000;
  const int runs = argc > 3 ? std::atoi(argv[3]) : 5;
  if (problems == 0 || runs < 1) return std::fputs("gcdt_bench_batch [DEVICES [PROBLEMS [RUNS]]]\n", stderr), 2;
  try {
    const SketchBatch batch = sketches(problems);
    const BatchView view = {batch.vertices, batch.vertex_offsets, batch.constraints, batch.constraint_offsets};
    Pool pool(devices);
    std::string found, bytes;
    {
      const BatchResult first = pool.triangulate(view);  // also builds the programs
      found = fault(batch, first);
      bytes = hash(batch, first);
    }
    std::vector<double> times;
    std::uint64_t triangles = 0;
    for (int i = 0; i < runs; ++i)
      times.push_back(milliseconds([&] { triangles = pool.triangulate(view).statistics().triangles; }));
    Object row;
    row.add("workload", "sketches").add("problems", static_cast<unsigned long long>(problems));
    row.add("n", static_cast<unsigned long long>(batch.vertices.size()));
    row.add("m", static_cast<unsigned long long>(batch.constraints.size()));
    row.add("triangles", static_cast<unsigned long long>(triangles));
    row.add("call_ms", median(times)).add("least_ms", *std::min_element(times.begin(), times.end()));
    std::string names;
    for (const PoolDevice& device : pool.devices())
      names += (names.empty() ? "" : ", ") + device.info.name + ": " + std::to_string(device.problems);
    row.add("devices", names).add("bytes", bytes);
#ifdef GCDT_BENCH_CGAL
    std::vector<double> cgal_times;
    std::uint64_t cgal_triangles = 0;
    for (int i = 0; i < std::min(runs, 3); ++i)
      cgal_times.push_back(milliseconds([&] { cgal_triangles = triangulate_with_cgal(batch); }));
    row.add("cgal_ms", median(cgal_times)).add("speedup", median(cgal_times) / median(times));
    if (found.empty() && cgal_triangles != triangles)
      found = "CGAL has " + std::to_string(cgal_triangles) + " triangles";
#endif
    row.add("verified", found.empty()).add("fault", found).add("date", date());
    std::printf("%s\n", row.text().c_str());
    return found.empty() ? 0 : 1;
  } catch (const Error& error) {
    return std::fprintf(stderr, "gcdt_bench_batch: %s\n", error.what()), 4;
  }
}

// SPDX-License-Identifier: Apache-2.0
// What a call costs on the caller's clock, with each of its remedies changed at a time (bench/NOTES.md, "The caller's
// clock"). Reaches the internals through the static library. Every variant must give the same bytes.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "api/state.hpp"
#include "inputs.hpp"

namespace {

using namespace gcdt;

struct Variant {
  std::string name;
  Tuning tuning;
  bool vectors = false;  ///< zeroed before they are overwritten
  bool late = false;     ///< arrays are made when the device is done
};

/// `as_gpu`: on any device, as on a GPU.
std::vector<Variant> variants(bool as_gpu) {
  std::vector<Variant> all;
  const auto add = [&](const std::string& name) -> Variant& {
    all.push_back({name, {}});
    if (as_gpu) all.back().tuning.prepares_host_memory = true;
    return all.back();
  };
  add("as it is");
  Variant& before = add("vectors, no room, no chunks");
  before.vectors = true, before.tuning.prepares_host_memory = false;
  Variant& arrays = add("arrays, no room, no chunks");
  arrays.late = true, arrays.tuning.prepares_host_memory = false;
  Variant& chunks = add("arrays, no room, chunks");
  chunks.late = true;
  Variant& room = add("arrays, room, no chunks");
  room.tuning.least_chunked = ~std::size_t{0};
  for (const std::uint32_t threads : {0u, 1u, 3u, 4u, 6u, 8u})
    add("room by " + std::to_string(threads) + " threads").tuning.room_threads = threads;
  for (const std::uint32_t threads : {1u, 2u, 3u, 6u, 8u}) {
    Variant& v = add("copied by " + std::to_string(threads) + " threads");
    v.tuning.copy_threads = threads, v.tuning.transfer_chunks = std::max(2 * threads, 4u);
  }
  for (const std::size_t kibi : {256u, 512u, 2048u, 4096u})
    add("chunks of " + std::to_string(kibi) + " KiB").tuning.transfer_chunk = kibi << 10;
  for (const std::uint32_t count : {4u, 16u, 32u})
    add(std::to_string(count) + " chunks").tuning.transfer_chunks = count;
  for (const std::uint32_t threads : {4u, 8u}) {
    Variant& v = add("room by 4, copied by " + std::to_string(threads) + ", 16 chunks of 4 MiB");
    v.tuning.room_threads = 4, v.tuning.copy_threads = threads;
    v.tuning.transfer_chunks = 16, v.tuning.transfer_chunk = std::size_t{4} << 20;
  }
  for (const std::size_t mebi : {1u, 16u})
    add("a thread more for " + std::to_string(mebi) + " MiB").tuning.copied_by_thread = mebi << 20;
  return all;
}

/// All arrays in vectors.
struct Vectors {
#define GCDT_ARRAY(number, name, type, width, ...) std::vector<detail::Element<type, width>> name;
#include <gcdt/arrays.def>

  void download(const Result& result) {
    std::vector<std::int32_t> arrays;
    std::vector<void*> destinations;
    std::vector<std::uint64_t> capacities;
    const auto add = [&](std::int32_t array, auto& to) {
      to.resize(result.count(array));
      arrays.push_back(array), destinations.push_back(to.data()), capacities.push_back(to.size());
    };
#define GCDT_ARRAY(number, name, ...) add(number, name);
#include <gcdt/arrays.def>
    detail::check(
        gcdt_result_copy_arrays(result.handle(), arrays.data(), destinations.data(), capacities.data(), arrays.size()));
  }
};

template <class Arrays>
std::uint64_t hash(const Arrays& mesh) {
  std::uint64_t h = 0;
  const auto mix = [&h](const void* data, std::size_t bytes) {
    for (std::size_t at = 0; at < bytes; at += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, static_cast<const char*>(data) + at, std::min<std::size_t>(8, bytes - at));
      h = (h ^ word) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
    }
  };
#define GCDT_ARRAY(number, name, ...) mix(mesh.name.data(), mesh.name.size() * sizeof mesh.name[0]);
#include <gcdt/arrays.def>
  return h;
}

struct Measured {
  std::vector<double> total, solve;
  Statistics statistics;
  std::uint64_t hash = 0;
};

Measured measure(const cl::Device& device, const Variant& variant, const bench::Workload& work, int runs) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  };
  runtime::CallHook hook;
  hook.tuning = variant.tuning;
  auto handle = std::make_unique<gcdt_solver>();
  handle->state = std::make_shared<api::State>(cl::Context(), device, runtime::Log(), Trace(), hook);
  Solver solver(handle.release());
  Measured measured;
  for (int i = -2; i < runs; ++i) {  // the first two build and warm up
    Triangulation mesh;
    Vectors vectors;
    double solved = 0;
    const auto start = Clock::now();
    if (variant.vectors || variant.late) {
      const Result result = solver.solve(work.points, work.constraints);
      solved = since(start);
      if (variant.vectors) {
        vectors.download(result);
        mesh.statistics = result.statistics();
      } else {
        mesh = result.download();
      }
    } else {
      mesh = solver.triangulate(work.points, work.constraints);
    }
    const double total = since(start);
    if (i == -2) measured.hash = variant.vectors ? hash(vectors) : hash(mesh);
    if (i < 0) continue;
    measured.total.push_back(total), measured.solve.push_back(solved);
    measured.statistics = mesh.statistics;
  }
  for (auto* times : {&measured.total, &measured.solve}) std::sort(times->begin(), times->end());
  return measured;
}

/// One table of Markdown. Returns whether all bytes were the same.
bool run(const cl::Device& device, const bench::Input& input, const std::vector<Variant>& variants, int runs) {
  const bench::Workload work =
      bench::make(input, [](const std::vector<bench::Point>& points) { return triangulate(points).triangles; });
  std::printf("\n%s, %zu vertices, %zu constraints, %d calls\n\n", input.name.c_str(), work.points.size(),
              work.constraints.size(), runs);
  std::printf(
      "| variant | call ms (least to most) | until solved | core | order | output |\n|---|---|---|---|---|---|\n");
  std::uint64_t bytes = 0;
  bool same = true;
  for (const Variant& variant : variants) {
    const Measured m = measure(device, variant, work, runs);
    if (bytes == 0) bytes = m.hash;
    same = same && m.hash == bytes;
    const std::size_t middle = m.total.size() / 2;
    const auto& ms = m.statistics.ms;
    std::printf("| %s%s | %.1f (%.1f to %.1f) | %.1f | %.2f | %.2f | %.2f |\n", variant.name.c_str(),
                m.hash == bytes ? "" : " OTHER BYTES", m.total[middle], m.total.front(), m.total.back(),
                m.solve[middle], ms.core, ms.order, ms.output);
    std::fflush(stdout);
  }
  return same;
}

}  // namespace

int main(int count, char** words) try {
  std::string device, only, rows;
  int runs = 11;
  bool as_gpu = false;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const bool more = i + 1 < count;
    if (word == "--device" && more)
      device = words[++i];
    else if (word == "--only" && more)
      only = words[++i];
    else if (word == "--runs" && more)
      runs = std::max(std::atoi(words[++i]), 1);
    else if (word == "--as-gpu")
      as_gpu = true;
    else if (word.rfind("--", 0) != 0)
      rows += (rows.empty() ? "" : ",") + word;
    else {
      std::fputs(
          "usage: gcdt_bench_clock [--device SPEC] [--runs N] [--only PART_OF_VARIANT] [--as-gpu]\n"
          "                        NAME:SIZE...\n",
          stderr);
      return 2;
    }
  }
  const std::vector<cl::Device> all = runtime::all_devices();
  const cl::Device chosen = all.at(runtime::choose_device(device, nullptr));
  std::vector<Variant> chosen_variants;
  for (Variant& variant : variants(as_gpu)) {
    if (variant.name.find(only) != std::string::npos) chosen_variants.push_back(std::move(variant));
  }
  bool same = true;
  for (const bench::Input& input : bench::inputs(bench::List::gpu, {}))
    if (!rows.empty() && bench::selected(input, rows)) same = run(chosen, input, chosen_variants, runs) && same;
  return same ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "gcdt_bench_clock: %s\n", error.what());
  return 1;
}

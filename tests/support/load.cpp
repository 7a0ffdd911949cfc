// SPDX-License-Identifier: Apache-2.0
// Uses the library for a long time in one process, and sees that nothing grows: batches at random whose results are
// released in any order, threads with solvers of their own, solvers made and released, calls cancelled anywhere. All
// bytes are compared with those of the first time. OpenCL objects are counted by the layer libcall_layer.so, which is
// to lie beside the program. Ends with a line of figures; status 1 and a line that says why if something is wrong.
//   load DEVICE BATCHES [CALLS [LIVES [CANCELS]]]
//     BATCHES   batches on a pool      CALLS     of each of eight threads (default: BATCHES / 50)
//     LIVES     solvers made           CANCELS   calls cancelled (default of both: BATCHES / 100)
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gcdt/gcdt_pool.hpp>

#include "call_layer.hpp"
#include "result_hash.hpp"
#include "workloads.hpp"

namespace {

using namespace gcdt;
using namespace gcdt::test;

[[noreturn]] void wrong(const std::string& what) { throw std::runtime_error(what); }

/// MiB of this process.
double resident() {
  std::ifstream file("/proc/self/statm");
  double all = 0, pages = 0;
  if (!(file >> all >> pages)) wrong("cannot read /proc/self/statm");
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// MiB of the heap that are in use. What was freed is not, though it may stay resident: glibc keeps it for each thread,
/// so that after threads with contexts of their own much is resident and little in use.
double in_use() {
  const struct mallinfo2 heap = mallinfo2();
  return static_cast<double>(heap.uordblks + heap.hblkhd) / (1 << 20);
}

/// Driver and C library keep some memory for reuse; what grows with the work is more than that.
constexpr double spare_mib = 24;

void require_flat(const char* part, double before, double after) {
  std::fprintf(stderr, "load: %s: %.0f MiB, then %.0f\n", part, before, after);
  if (after > before + spare_mib)
    wrong(std::string(part) + ": the process grew from " + std::to_string(before) + " to " + std::to_string(after) +
          " MiB");
}

void require_freed(const char* part, double before, double after) {
  std::fprintf(stderr, "load: %s: %.0f MiB of the heap in use, then %.0f\n", part, before, after);
  if (after > before + spare_mib)
    wrong(std::string(part) + ": of the heap " + std::to_string(before) + " MiB were in use, then " +
          std::to_string(after));
}

void require_objects(const char* part, const Held& before, const Held& after) {
  if (after.objects != before.objects)
    wrong(std::string(part) + ": objects " + before.text() + " became " + after.text());
}

/// Of a pool that has done all that it does. Each of a CPU's two workers makes programs and kernels when it first needs
/// them, and one may have needed none so far.
void require_bounded(const char* part, const Held& before, const Held& after) {
  for (const Kind kind : {Kind::context, Kind::queue, Kind::program, Kind::kernel, Kind::event}) {
    const bool of_workers = kind == Kind::program || kind == Kind::kernel;
    if (after.of(kind) > (of_workers ? 2 : 1) * before.of(kind))
      wrong(std::string(part) + ": objects " + before.text() + " became " + after.text());
  }
}

/// Says how long a part took.
class Part {
 public:
  explicit Part(const char* name) : name_(name) {}
  Part(const Part&) = delete;
  ~Part() {
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start_;
    const double processor = static_cast<double>(std::clock() - clock_) / CLOCKS_PER_SEC;
    std::fprintf(stderr, "load: %s: %.1f s, %.1f s of processors, %.0f MiB\n", name_, wall.count(), processor,
                 resident());
  }

 private:
  const char* name_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::clock_t clock_ = std::clock();
};

struct Load {
  std::string device;
  Calls* calls = nullptr;
  std::uint64_t problems = 0, bytes_peak = 0;
};

/// A batch that a number stands for, and what is wanted of it. One in ten has some problems, crossings as vertices or
/// tiles; the others are so small that a million of them are a matter of an hour.
struct Case {
  Batch batch;
  Options options;
};

Case case_of(std::uint64_t number) {
  std::mt19937_64 random(number);
  Case made;
  const bool small = number % 10 != 0;
  const std::uint64_t way = small ? 2 * (random() % 2) : random() % 5;
  made.options.crossing = way == 1 ? Crossing::split : Crossing::drop;
  if (way == 2) made.options.domain = Domain::even_odd;
  if (way == 3) made.options.tiles = 2;
  for (std::uint64_t p = 0, count = 1 + random() % (small ? 3 : 12); p < count; ++p) {
    const Workload work = random_crossing(3 + random() % (small ? 8 : 28), random() % 2 == 0 ? 12 : 1000,
                                          random() % (small ? 3 : 8), random());
    made.batch.add(work.points, work.constraints);
  }
  return made;
}

std::uint64_t hash_of(const BatchResult& result) {
  Hash hash;
  for (std::size_t p = 0; p < result.size(); ++p) {
    if (result.error(p)) wrong(result.error(p)->what());
    hash.add(result_hash(gcdt::detail::triangulation(result, p)));
  }
  return hash.value();
}

void run_batches(Load& load, std::uint64_t count) {
  const Part part("batches");
  constexpr std::uint64_t different = 100;
  std::vector<Case> cases;
  std::vector<std::uint64_t> expected;
  Pool pool(load.device);
  for (std::uint64_t c = 0; c < different; ++c) {
    cases.push_back(case_of(c));
    expected.push_back(hash_of(pool.triangulate(cases[c].batch, cases[c].options)));
  }
  std::mt19937_64 random(1);
  std::vector<BatchResult> kept;  // which hold host memory
  const Held begin = load.calls->held();
  double early = 0;
  std::uint64_t early_bytes = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t c = random() % different;
    kept.push_back(pool.triangulate(cases[c].batch, cases[c].options));
    load.problems += kept.back().size();
    if (i % 16 == 0 && hash_of(kept.back()) != expected[c]) wrong("batch " + std::to_string(i) + " has other bytes");
    if (kept.size() == 20) {
      std::shuffle(kept.begin(), kept.end(), random);
      kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(1 + random() % 20));
    }
    const std::uint64_t bytes = load.calls->held().bytes;
    load.bytes_peak = std::max(load.bytes_peak, bytes);
    if (i < count / 4) early_bytes = load.bytes_peak;
    if (i == count / 4) early = resident();
    if (i % 20000 == 19999)
      std::fprintf(stderr, "load: %" PRIu64 " batches: %.0f MiB, %" PRIu64 " bytes on the device at most\n", i + 1,
                   resident(), load.bytes_peak);
  }
  kept.clear();
  require_flat("batches", early, resident());
  // Twice: the larger of its jobs may have been one worker's until then, and the smaller ones the other's. And what one
  // worker keeps of such small jobs from two calls before, which are of other sizes whenever the cores are shared.
  constexpr std::uint64_t spare_bytes = 1 << 18;
  if (load.bytes_peak > 2 * early_bytes + spare_bytes)
    wrong("device memory grew from " + std::to_string(early_bytes) + " to " + std::to_string(load.bytes_peak) +
          " bytes");
  const Held end = load.calls->held();
  require_bounded("batches", begin, end);
}

/// Eight threads, whose results outlive calls, and solvers where that is how it comes.
void run_threads(Load& load, std::uint64_t rounds) {
  const Part part("threads");
  const Workload work = random_crossing(80, 1000, 30, 5);
  Options options;
  options.crossing = Crossing::split;
  const std::uint64_t expected = result_hash(Solver(load.device).triangulate(work.points, work.constraints, options));
  const Held begin = load.calls->held();
  const double used = in_use();
  std::atomic<std::uint64_t> right{0};
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < 8; ++t)
    threads.emplace_back([&, t] {
      try {
        std::mt19937_64 random(t);
        std::vector<Result> kept;
        auto own = std::make_unique<Solver>(load.device);
        for (std::uint64_t i = 0; i < rounds; ++i) {
          kept.push_back(own->solve(work.points, work.constraints, options));
          std::swap(kept[random() % kept.size()], kept.back());
          right += result_hash(kept.back().download()) == expected;
          if (kept.size() > 6) kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(random() % 6), kept.end());
          if (random() % 200 == 0) own = std::make_unique<Solver>(load.device);  // results of the last live on
        }
      } catch (const std::exception& error) {
        std::fprintf(stderr, "load: a thread: %s\n", error.what());
      }
    });
  for (std::thread& thread : threads) thread.join();
  if (right != 8 * rounds) wrong("threads: " + std::to_string(8 * rounds - right) + " calls had other bytes");
  require_objects("threads", begin, load.calls->held());
  require_freed("threads", used, in_use());
}

void run_lives(Load& load, std::uint64_t count) {
  const Part part("lives");
  const Workload work = uniform(20);
  Solver(load.device).triangulate(work.points);
  const Held begin = load.calls->held();
  for (std::uint64_t i = 0; i < count; ++i) {
    Solver made(load.device);
    if (i % 500 == 0) made.triangulate(work.points);
  }
  require_objects("lives", begin, load.calls->held());
}

void run_cancelled(Load& load, std::uint64_t count, std::uint64_t& cancelled) {
  const Part part("cancelled calls");
  Solver solver(load.device);
  Pool pool(load.device);
  const Workload work = random_crossing(300, 5000, 100, 5);
  Options options;
  options.crossing = Crossing::split;
  const auto hash = [&] { return result_hash(solver.triangulate(work.points, work.constraints, options)); };
  const std::uint64_t expected = hash();
  std::uint64_t asked = 0, stop = 0;
  Options stopped = options;
  stopped.progress = [&](const char*, double) { return ++asked != stop; };
  Batch batch;
  for (std::uint64_t p = 0; p < 4; ++p) batch.add(work.points, work.constraints);
  const std::uint64_t of_batch = hash_of(pool.triangulate(batch, options));
  stop = 0;
  solver.triangulate(work.points, work.constraints, stopped);
  const std::uint64_t all = asked;
  std::mt19937_64 random(3);
  double early = 0;
  Held begin = load.calls->held();
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i == count / 4) early = resident(), begin = load.calls->held();
    asked = 0, stop = 1 + random() % all;
    try {
      if (i % 8 == 7)
        pool.triangulate(batch, stopped);
      else
        solver.triangulate(work.points, work.constraints, stopped);
    } catch (const Error& error) {
      if (error.status() != Status::cancelled) throw;
      ++cancelled;
    }
    if (i % 50 == 0 && (hash() != expected || hash_of(pool.triangulate(batch, options)) != of_batch))
      wrong("other bytes after a call that was cancelled");
  }
  if (cancelled < count / 2) wrong("too few calls were cancelled: " + std::to_string(cancelled));
  require_flat("cancelled calls", early, resident());
  const Held end = load.calls->held();
  require_bounded("cancelled calls", begin, end);
}

std::string layer_beside_program() {
  char path[4096];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path);
  if (length <= 0) wrong("cannot read /proc/self/exe");
  const std::string program(path, static_cast<std::size_t>(length));
  return program.substr(0, program.rfind('/')) + "/libcall_layer.so";
}

void run(const std::string& device, const std::array<std::uint64_t, 4>& counts) {
  const std::string layer = layer_beside_program();
  setenv("OPENCL_LAYERS", layer.c_str(), 1);
  const auto start = std::chrono::steady_clock::now();
  Load load;
  load.device = device;
  const std::string name = Solver(device).device().name;
  load.calls = &calls_of(layer);
  const Held begin = load.calls->held();
  std::uint64_t cancelled = 0;
  run_batches(load, counts[0]);
  require_objects("after batches", begin, load.calls->held());
  const double batches_mib = resident();
  run_threads(load, counts[1]);
  run_lives(load, counts[2]);
  run_cancelled(load, counts[3], cancelled);
  require_objects("at the end", begin, load.calls->held());
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const double end_mib = resident();
  malloc_trim(0);
  std::printf("load: %s: %" PRIu64 " batches of %" PRIu64 " problems, 8 x %" PRIu64 " calls of threads, %" PRIu64
              " solvers made, %" PRIu64 " of %" PRIu64
              " calls cancelled; %.0f MiB after batches, %.0f at the end, "
              "%.0f when the heap has given back what is free; %.1f MiB on the device at most, %s left; %.0f s\n",
              name.c_str(), counts[0], load.problems, counts[1], counts[2], cancelled, counts[3], batches_mib, end_mib,
              resident(), static_cast<double>(load.bytes_peak) / (1 << 20), load.calls->held().text().c_str(),
              seconds.count());
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 3 || count > 6) {
    std::fprintf(stderr, "usage: load DEVICE BATCHES [CALLS [LIVES [CANCELS]]]\n");
    return 2;
  }
  const auto number = [&](int i, std::uint64_t usual) {
    return count > i ? std::strtoull(arguments[i], nullptr, 10) : usual;
  };
  const std::uint64_t batches = number(2, 0);
  run(arguments[1], {batches, number(3, batches / 50), number(4, batches / 100), number(5, batches / 100)});
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "load: %s\n", error.what());
  return 1;
}

// SPDX-License-Identifier: Apache-2.0
// Tiles that leave a device which has too little memory: in a queue beside the runs, to the result's arrays, to memory
// of their own, to files; and when calls fail meanwhile.
#include <random>
#include <thread>
#include <utility>

#include "batch/pipeline.hpp"
#include "faulty_device.hpp"
#include "pool_cases.hpp"
#include "scratch_folder.hpp"
#include "tiles/spilled.hpp"
#include "tiles/tiled.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

constexpr std::uint32_t tiles_wanted = 6;

/// A device of which a further worker's queue is lent, with room for one tile, the input, and what so many tiles keep.
runtime::CallHook small(const Workload& work, runtime::CallHook hook, double tiles_beside) {
  const std::uint64_t n = work.points.size() / tiles_wanted;
  const std::uint64_t tile = forest_bytes(1, n + n / 8, work.constraints.size() / 4);
  const std::uint64_t capacity =
      tile + 16 * work.points.size() + static_cast<std::uint64_t>(tiles_beside * 62 * static_cast<double>(n));
  hook.tuning.memory_bytes = capacity / 3 * 4;  // of which a pool takes three quarters
  hook.tuning.workers = 2;
  hook.tuning.shares_context = hook.tuning.prepares_host_memory = true;
  return hook;
}

/// Random points, and in their upper right corner a chain of constraints: so the last tile is the largest one, and is
/// solved first.
Workload last_is_first() {
  Workload work = uniform(60000);
  constexpr std::uint32_t links = 1500;
  for (std::uint32_t i = 0; i < links; ++i) {
    work.points.push_back({0.9 + i * 1e-5, 0.9 + (i % 2) * 1e-5});
    const auto last = static_cast<std::uint32_t>(work.points.size() - 1);
    if (i > 0) work.constraints.push_back({last - 1, last});
  }
  return work;
}

Options in_tiles() {
  Options options;
  options.tiles = tiles_wanted;
  return options;
}

/// Spans of spills: by the queue of the runs, and by the one beside.
struct Spills {
  std::atomic<int> own{0}, beside{0};
  Trace trace() {
    return [this](const TraceSpan& span) {
      if (!span.on_device && span.name == "spill") ++(span.device_number == 0 ? own : beside);
    };
  }
};

}  // namespace

TEST_CASE(
    "tiles leave in a queue beside the runs where the next one but one would have no room, and bytes are the same") {
  for (const Workload& work : {uniform(60000), last_is_first(), workload("spiral", 60000)}) {
    CAPTURE(work.constraints.size());
    const RaggedBatch batch({work});
    const Singles expected({work});
    const testing::ScratchFolder folder;
    for (const bool to_files : {false, true}) {
      CAPTURE(to_files);
      Spills spills;
      DevicePool pool({{cl::Context(), app_device(), small(work, healthy(), 1.5)}}, {}, spills.trace());
      if (to_files) pool.spill_to(folder / "");
      for (int call = 0; call < 2; ++call) {
        spills.own = spills.beside = 0;
        expected.check(tiles::triangulate(pool, batch.view(), in_tiles()));
        CHECK(spills.beside > 0);
        CHECK(folder.names().empty());
      }
    }
  }
}

TEST_CASE("a large tile is written in two parts, of which the first is read beside, and bytes are the same") {
  const Workload work = workload("letters", 30000);
  const RaggedBatch batch({work});
  const Singles expected({work});
  runtime::CallHook hook = small(work, healthy(), 20);
  hook.tuning.least_chunked = 64;
  std::atomic<int> reads_beside{0};
  DevicePool pool({{cl::Context(), app_device(), hook}, {cl::Context(), app_device(), hook}}, {},
                  [&](const TraceSpan& span) { reads_beside += span.name == "read beside"; });
  for (int call = 0; call < 2; ++call) {
    reads_beside = 0;
    expected.check(tiles::triangulate(pool, batch.view(), in_tiles()));
    CHECK(reads_beside > 0);
  }
}

TEST_CASE("a large tile is written whose final triangles are all before, or all behind, the end of the first part") {
  runtime::CallHook hook = healthy();
  hook.tuning.workers = 2;
  hook.tuning.shares_context = hook.tuning.prepares_host_memory = true;
  hook.tuning.least_chunked = 0;
  std::atomic<int> reads_beside{0};
  DevicePool pool({{cl::Context(), app_device(), hook}}, {},
                  [&](const TraceSpan& span) { reads_beside += span.name == "read beside"; });
  constexpr cl_uint count = 16, part = count / 8;
  for (const bool before : {false, true}) {
    CAPTURE(before);
    bool right = false;
    CHECK(pool.on_each(DevicePool::Who::all, [&](DevicePool::Lent& lent) {
      const cl_uint finals = before ? part : count - part, begin = before ? 0 : part;
      std::vector<cl_uint> corners, ids, scan{0};
      for (cl_uint t = 0; t < count; ++t) {
        corners.insert(corners.end(), {t, t + 1, t + 2});
        scan.push_back(scan.back() + (t >= begin && t < begin + finals ? 1 : 0));
      }
      for (cl_uint v = 0; v < count + 2; ++v) ids.push_back(100 + v);
      tiles::FinalTriangles final;
      final.count = finals, final.triangles = count;
      final.corners = lent.runtime.upload("corners", corners);
      final.neighbours = lent.runtime.filled<cl_int>("neighbours", 3 * count, -1);
      final.constrained = lent.runtime.filled<cl_uchar>("flags", count, 5);
      final.before = lent.runtime.upload("finals before", scan);
      final.ids = lent.runtime.upload("ids", ids);
      final.points = lent.runtime.filled<cl_int2>("points", count + 2, {{0, 0}});
      std::vector<tiles::Triangle> triangles(finals);
      std::vector<tiles::Neighbours> neighbours(finals);
      std::vector<std::uint8_t> constrained(finals);
      tiles::write_tile(lent, final, {}, {triangles.data(), neighbours.data(), constrained.data()}, {});
      right = true;
      for (cl_uint r = 0; r < finals; ++r) {
        const cl_uint v = 100 + begin + r;
        right = right && triangles[r] == tiles::Triangle{v, v + 1, v + 2} && constrained[r] == 5 &&
                neighbours[r] == tiles::Neighbours{-1, -1, -1};
      }
    }));
    CHECK(right);
    CHECK(reads_beside == 0);  // one of two reads would be of nothing, which is an error in OpenCL
  }
}

TEST_CASE("tiles leave a device treated as a GPU") {
  const Workload work = uniform(60000);
  const RaggedBatch batch({work});
  runtime::CallHook hook = small(work, healthy(), 1.5);
  hook.tuning.kind = DeviceKind::gpu;
  Spills spills;
  DevicePool pool({{cl::Context(), app_device(), hook}}, {}, spills.trace());
  Singles({work}).check(tiles::triangulate(pool, batch.view(), in_tiles()));
  CHECK(spills.beside > 0);
}

TEST_CASE("where there is no room beside a run, tiles leave before it; where there is for all, none does") {
  const Workload work = uniform(60000);
  const RaggedBatch batch({work});
  const Singles expected({work});
  const auto spilled = [&](double tiles_beside) {
    Spills spills;
    DevicePool pool({{cl::Context(), app_device(), small(work, healthy(), tiles_beside)}}, {}, spills.trace());
    expected.check(tiles::triangulate(pool, batch.view(), in_tiles()));
    return spills.own + spills.beside;
  };
  CHECK(spilled(0.2) == tiles_wanted - 1);
  CHECK(spilled(1.5) > 0);
  CHECK(spilled(1.5) < static_cast<int>(tiles_wanted));
  CHECK(spilled(8) == 0);
}

TEST_CASE("two such devices, which solve tiles out of turn, give the same bytes") {
  const Workload work = uniform(60000);
  const RaggedBatch batch({work});
  const Singles expected({work});
  DevicePool pool({{cl::Context(), app_device(), small(work, healthy(), 0.2)},
                   {cl::Context(), app_device(), small(work, healthy(), 1.2)}},
                  {}, {});
  for (int call = 0; call < 3; ++call) expected.check(tiles::triangulate(pool, batch.view(), in_tiles()));
}

TEST_CASE("a device that fails at its k-th OpenCL call while tiles leave it changes no byte") {
  const Workload work = uniform(24000);
  const RaggedBatch batch({work});
  const Singles expected({work});
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  const auto run = [&](std::uint64_t k, bool for_good, cl_int code) {
    *calls = 0;
    DevicePool pool({{cl::Context(), app_device(), small(work, failing(calls, k, for_good, code), 1.5)},
                     {cl::Context(), app_device(), healthy()}},
                    {}, {});
    expected.check(tiles::triangulate(pool, batch.view(), in_tiles()));
    const bool lost = pool.report(0).lost.has_value();
    expected.check(tiles::triangulate(pool, batch.view(), in_tiles()));
    return lost;
  };
  CHECK(!run(0, false, CL_SUCCESS));
  const std::uint64_t all = *calls / 2;
  REQUIRE(all > 300);
  std::uint64_t lost = 0;
  for (std::uint64_t i = 0; i < 20; ++i) lost += run(1 + i * all / 20, i % 2 == 0, CL_INVALID_COMMAND_QUEUE);
  CHECK(lost > 5);
  for (std::uint64_t i = 0; i < 10; ++i) run(1 + i * all / 10, false, CL_OUT_OF_RESOURCES);
}

TEST_CASE("where reads beside the runs fail, a tile stays on its device, and is read when it is written") {
  const Workload work = uniform(60000);
  const RaggedBatch batch({work});
  const Singles expected({work});
  const auto failed = std::make_shared<std::atomic<int>>(0);
  const auto making_tiles = std::make_shared<std::atomic<bool>>(false);
  runtime::CallHook hook = healthy();
  hook.before = [=](const char* call, const char*) {
    static thread_local bool launches = false;  // what goes on beside the runs is in threads that do not
    launches = launches || std::string(call) == "clEnqueueNDRangeKernel";
    if (!*making_tiles || launches || std::string(call) != "clEnqueueReadBuffer") return CL_SUCCESS;
    ++*failed;
    return CL_OUT_OF_RESOURCES;
  };
  Options options = in_tiles();
  options.progress = [=](const char* phase, double) {
    if (std::string(phase) != "tiles") *making_tiles = false;
    return true;
  };
  {
    *making_tiles = true;
    DevicePool pool({{cl::Context(), app_device(), small(work, hook, 1.5)}}, {}, {});
    const PoolResult made = tiles::triangulate(pool, batch.view(), options);
    REQUIRE(made.errors.count(0) == 1);
    CHECK(made.errors.at(0).status() == Status::out_of_memory);
    CHECK(*failed > 0);
    CHECK(!pool.report(0).lost);
    *failed = 0;
  }
  runtime::CallHook waiting = healthy();  // until a tile of the other device was to leave: that one makes its second
  waiting.before = [=](const char*, const char*) {
    for (int waits = 0; *making_tiles && *failed == 0 && waits < 50; ++waits)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return CL_SUCCESS;
  };
  for (int call = 0; call < 3; ++call) {
    DevicePool pool({{cl::Context(), app_device(), small(work, hook, 1.5)}, {cl::Context(), app_device(), waiting}}, {},
                    {});
    *failed = 0;
    *making_tiles = true;
    expected.check(tiles::triangulate(pool, batch.view(), options));
    CHECK(!pool.report(0).lost);
    CHECK(*failed > 0);
  }
}

TEST_CASE("a read beside the runs that fails when no tile is left to make takes no device away") {
  const Workload work = uniform(60000);
  const RaggedBatch batch({work});
  const Singles expected({work});
  const auto began = std::make_shared<std::atomic<int>>(0), are_made = std::make_shared<std::atomic<int>>(0);
  const auto wait_until = [](const std::atomic<int>& some) {
    for (int waits = 0; some == 0 && waits < 20000; ++waits) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  // From its first read beside the runs on, the device goes on only when the other one has made all tiles.
  runtime::CallHook hook = healthy();
  hook.before = [=](const char* call, const char*) {
    static thread_local bool launches = false;
    launches = launches || std::string(call) == "clEnqueueNDRangeKernel";
    const bool beside = !launches && std::string(call) == "clEnqueueReadBuffer" && *are_made == 0;
    if (beside) ++*began;
    if (*began > 0) wait_until(*are_made);
    return beside ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
  };
  // That makes no tile before: so the first device makes a second one, and has the first to read.
  const auto are_begun = std::make_shared<std::atomic<bool>>(false);
  runtime::CallHook waiting = healthy();
  waiting.before = [=](const char* call, const char*) {
    if (*are_begun && std::string(call) == "clEnqueueNDRangeKernel") wait_until(*began);
    return CL_SUCCESS;
  };
  Options options = in_tiles();
  options.progress = [=](const char* phase, double done) {
    *are_begun = true;
    const double all_but_one = 0.6;  // of what is told of the whole, of which tiles are 0.7
    if (std::string(phase) != "tiles" || done > all_but_one) *are_made = 1;
    return true;
  };
  DevicePool pool({{cl::Context(), app_device(), small(work, hook, 1.5)}, {cl::Context(), app_device(), waiting}}, {},
                  {});
  expected.check(tiles::triangulate(pool, batch.view(), options));
  CHECK(*began > 0);
  CHECK(!pool.report(0).lost);
}

TEST_CASE("a tile whose spill fails when its corners have got the input's numbers has these once") {
  const Workload work = uniform(60000);
  const RaggedBatch batch({work});
  const Singles expected({work});
  const auto numbered = std::make_shared<std::atomic<int>>(0), first = std::make_shared<std::atomic<int>>(0);
  runtime::CallHook hook = healthy();
  hook.before = [=](const char* call, const char* kernel) {
    static thread_local bool launched = false;  // what follows waits for it
    const bool launches = std::string(call) == "clEnqueueNDRangeKernel";
    *first += launches;
    if (std::exchange(launched, launches && std::string(kernel) == "tile_input_numbers") && ++*numbered == 1)
      return CL_OUT_OF_RESOURCES;
    return CL_SUCCESS;
  };
  runtime::CallHook waiting = healthy();
  waiting.before = [=](const char*, const char*) {
    for (int waits = 0; *first > 0 && *numbered == 0 && waits < 50; ++waits)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return CL_SUCCESS;
  };
  DevicePool pool({{cl::Context(), app_device(), small(work, hook, 1.5)}, {cl::Context(), app_device(), waiting}}, {},
                  {});
  expected.check(tiles::triangulate(pool, batch.view(), in_tiles()));
  CHECK(*numbered > 0);
  CHECK(!pool.report(0).lost);
}

TEST_CASE("shifts: how many of the seam's triangles come before each final one") {
  std::mt19937 random(3);
  for (const std::uint32_t finals : {0u, 1u, 255u, 256u, 257u, 5000u})
    for (const std::size_t count : {0u, 1u, 7u, 3000u}) {
      std::vector<std::uint32_t> before(count);
      for (std::uint32_t& b : before) b = static_cast<std::uint32_t>(random() % (finals + 1));
      std::sort(before.begin(), before.end());
      const tiles::Shifts shifts(before, finals);
      bool right = true;
      for (std::uint32_t r = 0; r < finals; ++r) {
        const auto shift = static_cast<std::uint32_t>(
            std::count_if(before.begin(), before.end(), [&](std::uint32_t b) { return b <= r; }));
        right = right && shifts.at(r) == shift && shifts.begin_of(shift) <= r && r < shifts.end_of(shift);
      }
      CHECK(right);
    }
}

// SPDX-License-Identifier: Apache-2.0
// Transfers to and from host memory that a driver has pinned go straight; and such memory for results is kept.
#include <thread>

#include "device/pinned_store.hpp"
#include "device/shared_upload.hpp"
#include "faulty_device.hpp"
#include "random_bytes.hpp"

using namespace gcdt;
using namespace gcdt::runtime;
using namespace gcdt::test;

namespace {

constexpr std::size_t chunk = 4096, length = 40 * chunk - 1;

/// As on a GPU, with small chunks; counts writes and reads, and has a call of that name fail.
struct Counted {
  std::atomic<int> writes{0}, reads{0};
  std::string failing;

  CallHook hook() {
    CallHook hook;
    hook.keep_programs = true;
    hook.tuning.prepares_host_memory = true;
    hook.tuning.transfer_chunk = chunk, hook.tuning.transfer_chunks = 4, hook.tuning.least_chunked = 1;
    hook.before = [this](const char* call, const char*) -> cl_int {
      if (call == failing) return CL_OUT_OF_RESOURCES;
      writes += call == std::string("clEnqueueWriteBuffer"), reads += call == std::string("clEnqueueReadBuffer");
      return CL_SUCCESS;
    };
    return hook;
  }
};

}  // namespace

TEST_CASE("memory is known to be pinned from its first to its last byte, and as often as it was added") {
  PinnedRanges ranges;
  const std::vector<unsigned char> memory(100);
  const unsigned char* const first = memory.data() + 10;
  CHECK(!ranges.contains(first, 1));
  ranges.add(first, 50);
  CHECK(ranges.contains(first, 50));
  CHECK(ranges.contains(first + 49, 1));
  CHECK(ranges.contains(first + 20, 0));
  CHECK(!ranges.contains(first, 51));
  CHECK(!ranges.contains(first - 1, 1));
  CHECK(!ranges.contains(first + 50, 1));
  CHECK(!ranges.contains(first + 49, 2));
  {
    const KnownPinned again(ranges, first, 50);
    ranges.remove(first, 49);
    ranges.remove(first + 1, 50);
    CHECK(ranges.contains(first, 50));
    ranges.remove(first, 50);
    CHECK(ranges.contains(first, 50));
  }
  CHECK(!ranges.contains(first, 1));
}

TEST_CASE("what is pinned is written and read in one piece, and what is not through chunks") {
  const std::vector<unsigned char> given = random_bytes(length, 1);
  const auto ranges = std::make_shared<PinnedRanges>();
  for (const bool is_pinned : {false, true}) {
    CAPTURE(is_pinned);
    Counted counted;
    Runtime runtime(app_device(), counted.hook());
    runtime.use_transfer_chunks();
    runtime.know_pinned(ranges);
    const auto buffer = runtime.allocate<cl_uchar>("bytes", length),
               other = runtime.allocate<cl_uchar>("others", length);
    std::vector<unsigned char> found(length), beside(length);
    std::optional<KnownPinned> from, to;
    if (is_pinned) from.emplace(*ranges, given.data(), length), to.emplace(*ranges, found.data(), length);
    counted.writes = counted.reads = 0;
    runtime.write(buffer, given.data(), length);
    CHECK(counted.writes == (is_pinned ? 1 : 40));
    runtime.read(buffer, found.data(), length);
    CHECK(counted.reads == (is_pinned ? 1 : 40));
    CHECK(found == given);
    // Some of several reads.
    runtime.write(other, random_bytes(length, 2).data(), length);
    std::fill(found.begin(), found.end(), static_cast<unsigned char>(0));
    counted.reads = 0;
    runtime.read_all({{buffer.handle(), found.data(), length}, {other.handle(), beside.data(), length}});
    CHECK(counted.reads == (is_pinned ? 41 : 80));
    CHECK(found == given);
    CHECK(beside == random_bytes(length, 2));
    // Errors, after which all is as before.
    for (const char* const call : {"clEnqueueWriteBuffer", "clEnqueueReadBuffer", "clWaitForEvents", "clFlush"}) {
      CAPTURE(call);
      const auto both = [&] {
        runtime.write(buffer, given.data(), length);
        runtime.read(buffer, found.data(), length);
      };
      counted.failing = call;
      CHECK(error_of(both).opencl_code() == CL_OUT_OF_RESOURCES);
      counted.failing.clear();
      both();
      CHECK(found == given);
    }
  }
}

TEST_CASE("several devices are sent what is pinned from where it is, each by one write") {
  const std::vector<unsigned char> given = random_bytes(length, 3), others = random_bytes(length, 4);
  const auto ranges = std::make_shared<PinnedRanges>();
  const KnownPinned known(*ranges, given.data(), length);
  Counted counted[2];
  std::vector<std::unique_ptr<Runtime>> runtimes;
  for (Counted& one : counted) {
    runtimes.push_back(std::make_unique<Runtime>(app_device(), one.hook()));
    runtimes.back()->set_alone(true);
    runtimes.back()->know_pinned(ranges);
  }
  SharedUpload shared(2, 16);
  std::vector<std::thread> threads;
  std::array<bool, 2> right{};
  for (std::size_t i = 0; i < 2; ++i)
    threads.emplace_back([&, i] {
      Runtime& runtime = *runtimes[i];
      const auto pinned = runtime.allocate<cl_uchar>("pinned", length),
                 copied = runtime.allocate<cl_uchar>("not", length);
      {
        SharedUpload::Taker taker(shared, runtime);
        counted[i].writes = 0;
        taker.write(pinned.handle(), given.data(), length);
        const int straight = counted[i].writes;
        taker.write(copied.handle(), others.data(), length);
        right[i] = straight == 1 && counted[i].writes == 41;
      }
      shared.wait_until_left();
      std::vector<unsigned char> found(length);
      runtime.read(pinned, found.data(), length);
      right[i] = right[i] && found == given;
      runtime.read(copied, found.data(), length);
      right[i] = right[i] && found == others;
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(right == std::array<bool, 2>{true, true});
}

TEST_CASE("pinned memory that is handed back serves again, and does not pile up where sizes change") {
  Counted counted;
  const auto ranges = std::make_shared<PinnedRanges>();
  auto store = std::make_shared<PinnedStore>(std::make_unique<Runtime>(app_device(), counted.hook()), ranges);
  unsigned char* const first = store->take(1000);
  unsigned char* const second = store->take(700);
  REQUIRE(first);
  REQUIRE(second);
  CHECK(first != second);
  CHECK(ranges->contains(first, 1000));
  CHECK(ranges->contains(second, 700));
  store->give_back(first);
  CHECK(store->take(501) == first);
  store->give_back(second), store->give_back(first);
  CHECK(store->take(600) == second);  // the smaller one
  CHECK(store->take(600) == first);
  store->give_back(first);
  CHECK(ranges->contains(first, 1000));
  CHECK(store->take(5000));  // larger than what is free, which goes
  CHECK(!ranges->contains(first, 1000));
  CHECK(ranges->contains(second, 700));

  HostArray array;
  array.source = store;
  auto* const made = array.make<std::uint32_t>(100000);
  CHECK(ranges->contains(made, 400000));
  CHECK(array.reuse<std::uint32_t>(90000) == made);
  HostArray moved = std::move(array);
  store.reset();  // the array keeps it
  made[99999] = 7;
  CHECK(moved.reuse<std::uint32_t>(1)[99999] == 7);
  moved = {};
  CHECK(!ranges->contains(made, 1));
}

TEST_CASE("where a driver has no memory to pin, arrays are the system's") {
  for (const char* const call : {"clCreateBuffer", "clEnqueueMapBuffer"}) {
    Counted counted;
    const auto ranges = std::make_shared<PinnedRanges>();
    HostArray array;
    array.source = std::make_shared<PinnedStore>(std::make_unique<Runtime>(app_device(), counted.hook()), ranges);
    counted.failing = call;
    auto* const made = array.make<std::uint32_t>(1000);
    made[999] = 1;
    CHECK(!ranges->contains(made, 4));
    counted.failing.clear();
    CHECK(ranges->contains(array.make<std::uint32_t>(1000), 4000));
  }
}

// SPDX-License-Identifier: Apache-2.0
// What several devices are sent from one copy, each has, whichever of them leaves or fails.
#include "device/shared_upload.hpp"

#include <thread>

#include "faulty_device.hpp"
#include "pool_cases.hpp"

using namespace gcdt;
using namespace gcdt::test;

namespace {

constexpr std::size_t chunk = 4096, chunks = 4, all_words = 50000;
constexpr std::size_t host_cores = 16;  // so that threads help wherever the tests run

runtime::CallHook with_chunks(runtime::CallHook hook = {}) {
  hook.tuning.prepares_host_memory = true;
  hook.tuning.transfer_chunk = chunk;
  hook.tuning.transfer_chunks = chunks;
  hook.tuning.least_chunked = 1;
  return hook;
}

/// One that is sent the words from the first on, so many at a time, until it has some, or fails.
struct Receiver {
  explicit Receiver(const runtime::CallHook& hook) : runtime(app_device(), hook) {
    runtime.set_alone(true);
    buffer = runtime.allocate<cl_uint>("received", all_words);
  }
  void take(runtime::SharedUpload& shared, const std::vector<cl_uint>& sent, std::size_t at_once, std::size_t most) {
    try {
      runtime::SharedUpload::Taker taker(shared, runtime);
      for (std::size_t first = 0; first < most; first += at_once) {
        const std::size_t count = std::min(at_once, all_words - first);
        const auto part = runtime.allocate<cl_uint>("part", count);
        taker.write(part.handle(), sent.data() + first, count * sizeof(cl_uint));
        runtime.copy_out(part, buffer.handle(), count, first);
        has = first + count;
        if (!reads_between) continue;
        std::vector<cl_uint> there(count);
        runtime.read(part, there.data(), count);
        read_right &= std::equal(there.begin(), there.end(), sent.begin() + static_cast<std::ptrdiff_t>(first));
      }
    } catch (const Error&) {
      failed = true;
    }
  }
  bool is_right(const std::vector<cl_uint>& sent) {
    const auto received = [&] {
      std::vector<cl_uint> all(all_words);
      runtime.read(buffer, all.data(), all_words);
      return all;
    }();
    return std::equal(sent.begin(), sent.begin() + static_cast<std::ptrdiff_t>(has), received.begin());
  }
  runtime::Runtime runtime;
  runtime::Buffer<cl_uint> buffer;
  std::size_t has = 0;
  bool failed = false, reads_between = false, read_right = true;
};

std::vector<cl_uint> some_words() {
  std::vector<cl_uint> all(all_words);
  for (std::size_t i = 0; i < all_words; ++i) all[i] = static_cast<cl_uint>(i * 2654435761u + 1);
  return all;
}

void send(std::vector<std::unique_ptr<Receiver>>& receivers, const std::vector<cl_uint>& sent, std::size_t at_once,
          const std::vector<std::size_t>& most) {
  runtime::SharedUpload shared(receivers.size(), host_cores);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < receivers.size(); ++i)
    threads.emplace_back([&, i] { receivers[i]->take(shared, sent, at_once, most[i]); });
  for (std::thread& thread : threads) thread.join();
  shared.wait_until_left();
}

}  // namespace

TEST_CASE("devices have what they are sent from one copy, however much at once, and with any number of helpers") {
  const std::vector<cl_uint> sent = some_words();
  for (const std::uint32_t copy_threads : {1u, 6u})
    for (const std::size_t count : {1, 2, 3})
      for (const std::size_t at_once :
           {std::size_t{1}, std::size_t{700}, std::size_t{1024}, std::size_t{9999}, all_words}) {
        CAPTURE(copy_threads);
        CAPTURE(count);
        CAPTURE(at_once);
        runtime::CallHook hook = with_chunks();
        hook.tuning.copy_threads = copy_threads;
        std::vector<std::unique_ptr<Receiver>> receivers;
        for (std::size_t i = 0; i < count; ++i) receivers.push_back(std::make_unique<Receiver>(hook));
        const std::size_t most = at_once == 1 ? 50 : all_words;
        for (int time = 0; time < 2; ++time) send(receivers, sent, at_once, std::vector<std::size_t>(count, most));
        for (const auto& receiver : receivers) {
          CHECK(receiver->has == most);
          CHECK(!receiver->failed);
          CHECK(receiver->is_right(sent));
        }
      }
}

TEST_CASE("a device may read and write by itself meanwhile: not through the memory that others read") {
  const std::vector<cl_uint> sent = some_words();
  std::vector<std::unique_ptr<Receiver>> receivers;
  for (int i = 0; i < 3; ++i) receivers.push_back(std::make_unique<Receiver>(with_chunks()));
  receivers[0]->reads_between = receivers[2]->reads_between = true;
  for (int time = 0; time < 5; ++time) send(receivers, sent, 1500, {all_words, all_words, all_words});
  for (const auto& receiver : receivers) {
    CHECK(receiver->is_right(sent));
    CHECK(receiver->read_right);
  }
}

TEST_CASE("a device that leaves early, or that has no pinned memory, keeps nothing from the others") {
  const std::vector<cl_uint> sent = some_words();
  std::vector<std::unique_ptr<Receiver>> receivers;
  for (int i = 0; i < 3; ++i) receivers.push_back(std::make_unique<Receiver>(with_chunks()));
  for (const std::size_t leaves : {std::size_t{0}, std::size_t{1500}, std::size_t{30000}}) {
    send(receivers, sent, 1500, {all_words, leaves, all_words});
    CHECK(receivers[0]->has == all_words);
    CHECK(receivers[2]->has == all_words);
    for (const auto& receiver : receivers) CHECK(receiver->is_right(sent));
  }
  receivers[1] = std::make_unique<Receiver>(runtime::CallHook());
  send(receivers, sent, 1500, {all_words, all_words, all_words});
  for (const auto& receiver : receivers) CHECK((receiver->has == all_words && receiver->is_right(sent)));
}

TEST_CASE("a device that fails at its k-th call changes nothing of what the others are sent") {
  const std::vector<cl_uint> sent = some_words();
  const auto calls = std::make_shared<std::atomic<std::uint64_t>>(0);
  constexpr std::uint64_t never = std::uint64_t{1} << 40;
  int failed = 0;
  for (std::uint64_t k = 1; k < 400; k += 13) {
    CAPTURE(k);
    std::vector<std::unique_ptr<Receiver>> receivers;
    *calls = 0;
    receivers.push_back(
        std::make_unique<Receiver>(with_chunks(failing(calls, never, k % 2 == 0, CL_INVALID_COMMAND_QUEUE))));
    receivers.push_back(std::make_unique<Receiver>(with_chunks()));
    *calls = never - k;
    send(receivers, sent, 5000, {all_words, all_words});
    CHECK(receivers[1]->has == all_words);
    CHECK(receivers[1]->is_right(sent));
    failed += receivers[0]->failed;
  }
  CHECK(failed > 10);
}

TEST_CASE("when all have left, after errors, too, nothing is copied any more, and chunks are their devices' own") {
  // Many parts are begun ahead of the first that is sent, and copied for long after that.
  constexpr std::size_t large_chunk = std::size_t{1} << 21, of_device = 16, bytes = 2 * of_device * large_chunk;
  const std::vector<unsigned char> sent(bytes, 1);
  const auto sending = std::make_shared<std::atomic<bool>>(false);
  runtime::CallHook hook = with_chunks();
  hook.tuning.transfer_chunk = large_chunk;
  hook.tuning.transfer_chunks = of_device;
  hook.before = [=](const char* call, const char*) {
    return *sending && std::string(call) == "clEnqueueWriteBuffer" ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
  };
  for (int time = 0; time < 5; ++time) {
    runtime::Runtime first(app_device(), hook), second(app_device(), hook);
    std::vector<unsigned char*> places;  // some of each chunk
    for (runtime::Runtime* one : {&first, &second}) {
      one->set_alone(true);
      runtime::TransferChunks* const own = one->pinned_chunks();
      REQUIRE(own);
      for (std::size_t i = 0; i < own->count(); ++i)
        for (std::size_t at = 0; at < large_chunk; at += large_chunk / 64) places.push_back(own->memory(i) + at);
    }
    runtime::SharedUpload shared(2, host_cores);
    std::atomic<int> failed{0};
    const auto take = [&](runtime::Runtime& runtime) {
      const auto buffer = runtime.allocate<unsigned char>("received", bytes);
      try {
        runtime::SharedUpload::Taker taker(shared, runtime);
        *sending = true;
        taker.write(buffer.handle(), sent.data(), bytes);
      } catch (const Error&) {
        ++failed;
      }
    };
    std::thread other([&] { take(second); });
    take(first);
    shared.wait_until_left();
    for (unsigned char* const place : places) *place = 2;
    CHECK(!first.pinned_chunks()->lent());
    other.join();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    CHECK(std::all_of(places.begin(), places.end(), [](const unsigned char* place) { return *place == 2; }));
    CHECK(failed == 2);
    *sending = false;
  }
}

// SPDX-License-Identifier: Apache-2.0
// Threads that touch new memory: every page of it, nothing beside it, and nothing once they are told to stop.
#include <doctest/doctest.h>

#include <algorithm>

#include "device/host_room.hpp"
#include "fresh_memory.hpp"
#include "threads_here.hpp"

using gcdt::runtime::HostRoom;
using namespace gcdt::test;

TEST_CASE("every page of the ranges is touched, whatever their ends, and no other") {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (const unsigned threads : {1u, 2u, 5u}) {
    CAPTURE(threads);
    const Fresh memory((std::size_t{9} << 20));
    const std::size_t second = std::size_t{6} << 20;
    std::vector<bool> wanted(memory.bytes / page);
    const auto range = [&](std::size_t from, std::size_t bytes) {
      for (std::size_t at = from; at < from + bytes; ++at) wanted[at / page] = true;
      return HostRoom::Range{memory.first + from, bytes};
    };
    HostRoom room({range(3 * page + 17, 5 * page), range(0, 0), range(20 * page - 1, 2),
                   range(30 * page, (std::size_t{5} << 20) - 30 * page), range(second + 5, std::size_t{3} << 19)},
                  threads);
    CHECK(comes_true([&] { return memory.touched() == wanted; }));
    room.stop();
    CHECK(memory.touched() == wanted);
  }
}

#ifdef __linux__
TEST_CASE("as many threads touch as are wanted, until they are told to stop") {
  const Fresh memory(std::size_t{2} << 30);  // which takes them long
  const std::size_t before = threads_here();
  HostRoom room({{memory.first, memory.bytes}}, 3);
  CHECK(comes_true([&] { return threads_here() == before + 3; }));
  room.stop();
  CHECK(comes_true([&] { return threads_here() == before; }));
}
#endif

TEST_CASE("bytes beside the ranges stay") {
  std::vector<unsigned char> memory(std::size_t{5} << 20, 0xee);
  const std::size_t from = 12345, bytes = (std::size_t{4} << 20) + 7;
  {
    const Fresh last(4096);  // touched at the end, which tells when
    HostRoom room({{memory.data() + from, bytes}, {last.first, last.bytes}}, 1);
    CHECK(comes_true([&] { return last.touched() == std::vector<bool>{true}; }));
  }
  bool beside = true, changed = false;
  for (std::size_t i = 0; i < memory.size(); ++i)
    if (i < from || i >= from + bytes)
      beside = beside && memory[i] == 0xee;
    else
      changed = changed || memory[i] == 0;
  CHECK(beside);
  CHECK(changed);
}

TEST_CASE("nothing is written once it has been told to stop, however early") {
  std::vector<unsigned char> memory(std::size_t{32} << 20);
  for (int i = 0; i < 50; ++i) {
    HostRoom room({{memory.data(), memory.size()}}, 1 + i % 3);
    if (i % 2) std::this_thread::sleep_for(std::chrono::microseconds(i * 10));
    room.stop();
    std::fill(memory.begin(), memory.end(), static_cast<unsigned char>(0xee));
    if (i % 10 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const bool kept = std::all_of(memory.begin(), memory.end(), [](unsigned char b) { return b == 0xee; });
    REQUIRE(kept);
  }
}

TEST_CASE("without threads, ranges or bytes nothing happens") {
  unsigned char byte = 0xee;
  HostRoom none, no_threads({{&byte, 1}}, 0), no_ranges({}, 3), no_bytes({{&byte, 0}, {nullptr, 0}}, 3);
  for (HostRoom* room : {&none, &no_threads, &no_ranges, &no_bytes}) room->stop();
  CHECK(byte == 0xee);
}

TEST_CASE("what is left to the caller is not written, whether it has been touched or not; the rest is touched") {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (int i = 0; i < 50; ++i) {
    std::vector<unsigned char> memory(std::size_t{32} << 20);
    const Fresh last(page);
    HostRoom room({{memory.data(), memory.size()}, {last.first, last.bytes}}, 1 + i % 3);
    if (i % 2) std::this_thread::sleep_for(std::chrono::microseconds(i * 10));
    unsigned char* const own = memory.data() + static_cast<std::size_t>(i) * (std::size_t{1} << 18) + 5;
    const std::size_t bytes = (std::size_t{5} << 20) + static_cast<std::size_t>(i) * 4099;
    room.leave({own, bytes});
    std::fill_n(own, bytes, static_cast<unsigned char>(0xee));
    REQUIRE(comes_true([&] { return last.touched() == std::vector<bool>{true}; }));
    room.stop();
    REQUIRE(std::all_of(own, own + bytes, [](unsigned char b) { return b == 0xee; }));
  }
}

// SPDX-License-Identifier: Apache-2.0
// Loops that are shared out to threads that wait for them: every part once, by several threads, errors as without.
#include <doctest/doctest.h>

#include <atomic>
#include <set>
#include <stdexcept>

#include "device/parts.hpp"

using namespace gcdt;

namespace {

/// How often each part of so many was called.
std::vector<int> parts_of_loop(Crew& crew, std::size_t parts) {
  std::vector<std::atomic<int>> called(parts);
  crew.run(parts, [&](std::size_t part) { ++called[part]; });
  return {called.begin(), called.end()};
}

}  // namespace

TEST_CASE("a crew does every part of a loop once, however many threads it has, loop after loop") {
  for (const std::size_t threads : {0, 1, 2, 7}) {
    CAPTURE(threads);
    Crew crew(threads);
    for (int loop = 0; loop < 300; ++loop)
      for (const std::size_t parts : {0, 1, 2, 5, 40})
        REQUIRE(parts_of_loop(crew, parts) == std::vector<int>(parts, 1));
  }
  for (int i = 0; i < 50; ++i) Crew(3);  // over before the threads have begun
}

TEST_CASE("parts are done by the crew's threads, at once") {
  Crew crew(3);
  std::atomic<int> inside{0};
  std::mutex mutex;
  std::set<std::thread::id> ids;
  // Ends only if four threads are in the loop at the same time.
  crew.run(4, [&](std::size_t) {
    ++inside;
    while (inside < 4) std::this_thread::yield();
    const std::lock_guard<std::mutex> lock(mutex);
    ids.insert(std::this_thread::get_id());
  });
  CHECK(ids.size() == 4);
  CHECK(ids.count(std::this_thread::get_id()) == 1);
}

TEST_CASE("loops of the thread that has made a crew are the crew's, and those of others are not") {
  CHECK(Crew::of_this_thread() == nullptr);
  {
    Crew outer(1);
    CHECK(Crew::of_this_thread() == &outer);
    {
      Crew inner(1);
      CHECK(Crew::of_this_thread() == &inner);
    }
    CHECK(Crew::of_this_thread() == &outer);
    Crew* elsewhere = &outer;
    std::thread([&] { elsewhere = Crew::of_this_thread(); }).join();
    CHECK(elsewhere == nullptr);
    Crew* within = &outer;
    outer.run(1, [&](std::size_t) { within = Crew::of_this_thread(); });
    CHECK(within == nullptr);
  }
  CHECK(Crew::of_this_thread() == nullptr);
}

TEST_CASE("a loop within a loop is done, and what a part throws comes out, the first part's first") {
  Crew crew(4);
  std::vector<std::atomic<int>> called(2000);
  const auto inner = [&](std::size_t i) {
    for_each_in_threads(
        20, [&](std::size_t j) { ++called[20 * i + j]; }, 1);
  };
  for_each_in_threads(100, inner, 1);
  CHECK(std::all_of(called.begin(), called.end(), [](const auto& count) { return count == 1; }));
  CHECK(count_in_threads(100000, [](std::size_t i) { return i % 3 == 0; }) == 33334);
  const Parts parts(64, 1);
  for (int time = 0; time < 20; ++time)
    CHECK_THROWS_WITH_AS(parts.run([&](std::size_t part, std::size_t, std::size_t) {
      throw std::runtime_error("part " + std::to_string(part));
    }),
                         "part 0", std::runtime_error);
  CHECK(count_in_threads(100000, [](std::size_t i) { return i % 2; }) == 50000);
}

// SPDX-License-Identifier: Apache-2.0
// Workers without memory and lost devices: every problem of a batch is settled once, whatever workers do.
#include <atomic>
#include <random>
#include <thread>

#include "schedule_cases.hpp"

using namespace gcdt;
using namespace schedule_cases;

TEST_CASE("a worker without memory has its neighbour end first, and is refused only when it is alone") {
  const Sizes sizes({1000000, 10});
  const BatchInput batch = sizes.view();
  Schedule schedule(batch, {worker(0), worker(0)});
  const auto large = schedule.take(0), small = schedule.take(1);
  REQUIRE(large->problems == std::vector<std::uint32_t>{0});
  schedule.too_large(0, large, shortage());
  CHECK(schedule.state(1).evicted);
  CHECK(!schedule.state(0).evicted);
  std::atomic<bool> ended{false};
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    finish(schedule, 1, small);
    CHECK(bool(schedule.take(1)) == false);
    ended = true;
    schedule.end(1);
  });
  auto again = schedule.take(0);
  CHECK(ended);
  CHECK(again->problems == large->problems);
  other.join();
  SUBCASE("then there is enough") { finish(schedule, 0, again); }
  SUBCASE("then there is not") {
    schedule.too_large(0, again, shortage());
    CHECK(bool(schedule.take(0)) == false);
    REQUIRE(schedule.errors.count(0) == 1);
    CHECK(schedule.errors.at(0).status() == Status::out_of_memory);
  }
  CHECK(bool(schedule.take(0)) == false);
  check_settled(schedule, 2);
}

TEST_CASE("both workers of a device without memory: one goes on alone") {
  const Sizes sizes({30000, 30000});
  const BatchInput batch = sizes.view();
  Schedule schedule(batch, {worker(0), worker(0)});
  const auto a = schedule.take(0), b = schedule.take(1);
  schedule.too_large(1, b, shortage());
  schedule.too_large(0, a, shortage());  // evicted meanwhile: no fault of the job's
  CHECK(bool(schedule.take(0)) == false);
  schedule.end(0);
  const auto both = schedule.take(1);
  CHECK(both->problems.size() == 2);
  finish(schedule, 1, both);
  check_settled(schedule, 2);
}

TEST_CASE("a lost device's workers end, and its work goes to others") {
  const Sizes sizes(std::vector<std::uint64_t>(10, 9000));
  const BatchInput batch = sizes.view();
  Schedule schedule(batch, {worker(0), worker(0), worker(1)});
  const auto a = schedule.take(0), b = schedule.take(1), c = schedule.take(2);
  schedule.lose(0, a);
  CHECK(bool(schedule.take(0)) == false);
  finish(schedule, 1, b);  // what was running still counts
  CHECK(bool(schedule.take(1)) == false);
  finish(schedule, 2, c);
  while (const auto rest = schedule.take(2)) finish(schedule, 2, rest);
  check_settled(schedule, 10);
}

TEST_CASE("a problem that needs more than its size says goes to another device, by itself, or is refused") {
  const Sizes sizes({900, 500, 20, 10});
  const BatchInput batch = sizes.view();
  const std::uint64_t little = std::uint64_t{1} << 30;
  SUBCASE("another device") {
    Schedule schedule(batch, {worker(0, 0, little), worker(1, 0, little)});
    const auto job = schedule.take(0);
    const std::uint32_t outgrown = job->problems.back();
    schedule.too_large(0, job, shortage(), outgrown);
    for (auto more = schedule.take(1); more; more = schedule.take(1)) {
      if (std::count(more->problems.begin(), more->problems.end(), outgrown) > 0) CHECK(more->problems.size() == 1);
      finish(schedule, 1, more);
    }
    CHECK(bool(schedule.take(0)) == false);
    check_settled(schedule, 4);
    CHECK(schedule.errors.empty());
  }
  SUBCASE("no other device") {
    Schedule schedule(batch, {worker(0, 0, little)});
    const auto job = schedule.take(0);
    REQUIRE(job->problems.size() == 4);
    schedule.too_large(0, job, shortage(), 2);
    // Larger ones are not refused for its sake.
    for (const auto& expected : {std::vector<std::uint32_t>{0, 1}, std::vector<std::uint32_t>{3}}) {
      const auto rest = schedule.take(0);
      CHECK(rest->problems == expected);
      finish(schedule, 0, rest);
    }
    CHECK(bool(schedule.take(0)) == false);
    check_settled(schedule, 4);
    REQUIRE(schedule.errors.count(2) == 1);
    CHECK(schedule.errors.at(2).status() == Status::out_of_memory);
  }
}

TEST_CASE("whatever workers do, in any order, everything is settled once") {
  std::mt19937 seeds(11);
  for (int round = 0; round < 60; ++round) {
    CAPTURE(round);
    std::vector<std::uint64_t> given(1 + seeds() % 200);
    for (auto& n : given) n = seeds() % (seeds() % 10 == 0 ? 100000 : 1000);
    const Sizes sizes(given);
    const BatchInput batch = sizes.view();
    std::vector<WorkerState> states;
    for (std::size_t device = 0, count = 1 + seeds() % 3; device < count; ++device)
      for (std::size_t i = 0, workers = 1 + seeds() % 3; i < workers; ++i)
        states.push_back(worker(device, seeds() % 2 ? 0 : 1 + seeds() % 1000, 40000000));
    Schedule schedule(batch, states);
    std::vector<std::thread> threads;
    // The last device's workers never fail.
    const std::size_t safe = states.back().device;
    for (std::size_t number = 0; number < states.size(); ++number)
      threads.emplace_back([&, number, random = std::mt19937(seeds())]() mutable {
        while (const auto job = schedule.take(number)) {
          const auto chance = random() % 10;
          if (chance < 2 && states[number].device != safe) {
            schedule.lose(number, job);
          } else if (chance < 4) {
            schedule.too_large(number, job, shortage());
          } else if (chance == 4) {
            schedule.too_large(number, job, shortage(), job->problems[random() % job->problems.size()]);
          } else if (chance < 6 && schedule.needless(*job)) {
            schedule.drop(number, job);
          } else {
            std::this_thread::sleep_for(std::chrono::microseconds(random() % 300));
            finish(schedule, number, job, 0.01 + static_cast<double>(random() % 100));
          }
        }
        schedule.end(number);
      });
    for (std::thread& thread : threads) thread.join();
    // A problem is refused only for want of memory.
    check_settled(schedule, given.size());
  }
}

// SPDX-License-Identifier: Apache-2.0
// Who gets which problems of a batch, while all workers work.
#include <thread>

#include "batch/backoff.hpp"
#include "schedule_cases.hpp"

using namespace gcdt;
using namespace schedule_cases;

TEST_CASE("a single worker takes everything at once, largest first") {
  const Sizes sizes({5, 100, 7, 100, 1});
  const BatchInput batch = sizes.view();
  Schedule schedule(batch, {worker(0)});
  const auto job = schedule.take(0);
  REQUIRE(bool(job));
  CHECK(job->problems == std::vector<std::uint32_t>{1, 3, 2, 0, 4});
  finish(schedule, 0, job);
  CHECK(bool(schedule.take(0)) == false);
  check_settled(schedule, 5);
}

TEST_CASE("workers that are shared out work so that they end together") {
  CHECK(common_end({{0, 10}}, 100) == doctest::Approx(10));
  CHECK(common_end({{0, 10}, {0, 30}}, 100) == doctest::Approx(2.5));
  // 30 milliseconds of the first one alone, then both: 300 + 40 (end - 30) = 700.
  CHECK(common_end({{30, 30}, {0, 10}}, 700) == doctest::Approx(40));
  CHECK(common_end({{30, 30}, {0, 10}}, 299) == doctest::Approx(29.9));  // before the second one is free
  CHECK(common_end({{5, 10}, {0, 0}}, 100) == doctest::Approx(15));      // whoever is not measured gets none
}

TEST_CASE("a throughput is that of the latest runs, large ones above all") {
  Throughput throughput;
  CHECK(!throughput.known());
  throughput.add(10, 10);
  CHECK(throughput.value() == doctest::Approx(1));
  throughput.add(10000, 100);
  CHECK(throughput.value() == doctest::Approx(10005.0 / 105));
  throughput.add(10, 1);  // a small one says little
  CHECK(throughput.value() == doctest::Approx(5012.5 / 53.5));
  for (int run = 0; run < 20; ++run) throughput.add(10, 1);
  CHECK(throughput.value() == doctest::Approx(10).epsilon(0.01));
}

TEST_CASE("workers of one device take jobs as if all were to end together, which shrink") {
  const Sizes sizes = thousands(1000);
  const BatchInput batch = sizes.view();
  Schedule schedule(batch, {worker(0, 1), worker(0, 1)});
  const auto first = schedule.take(0), second = schedule.take(1);
  CHECK(first->weight == 400 * 1000u);             // four fifths of half
  CHECK(nearly(second->weight, 400));              // the same
  finish(schedule, 0, first, 400000);              // at once, in truth: the other has 400 s to go
  CHECK(schedule.take(0)->weight == 160 * 1000u);  // of what is left, which it could do in 200 s
  finish(schedule, 1, second, 400000);
  CHECK(schedule.take(1)->weight == 32 * 1000u);
}

TEST_CASE("when the end is near a worker takes all that it would have, and does not leave crumbs") {
  const Sizes sizes = thousands(10);
  const BatchInput batch = sizes.view();
  SUBCASE("an even part") {
    Schedule schedule(batch, {worker(0, 250), worker(0, 250)});  // 20 ms
    CHECK(schedule.take(0)->weight == 5 * 1000u);
    CHECK(schedule.take(1)->weight == 5 * 1000u);
  }
  SUBCASE("the rest") {
    Schedule schedule(batch, {worker(0, 1000), worker(1, 100)});
    CHECK(schedule.take(0)->weight == 10 * 1000u);  // 9.09 of it would leave less than 10 ms of its time
  }
}

TEST_CASE("a job is worth its overhead, which is no part of a worker's throughput") {
  const Sizes sizes = thousands(100);
  const BatchInput batch = sizes.view();
  WorkerState state = worker(0, 1000);  // 50 ms each
  state.plan.job_overhead = 20;
  Schedule schedule(batch, {state, state});
  const auto first = schedule.take(0);
  CHECK(first->weight == 60 * 1000u);  // three overheads' worth
  finish(schedule, 0, first, 80);
  CHECK(schedule.state(0).throughput.value() == doctest::Approx(1000));
  CHECK(schedule.take(1)->weight == 40 * 1000u);
  SUBCASE("whatever is thought of the overhead") {
    Schedule other(batch, {state, state});
    finish(other, 0, other.take(0), 16);  // at least a quarter
    CHECK(other.state(0).throughput.value() == doctest::Approx((500.0 + 60000) / (0.5 + 4)));
  }
}

TEST_CASE("the first jobs of a device's workers differ as asked for, later ones do not") {
  const Sizes sizes = thousands(1000);
  const BatchInput batch = sizes.view();
  std::vector<WorkerState> workers = {worker(0, 1), worker(0, 1)};
  workers[0].first_part = 0.5;
  Schedule schedule(batch, workers);
  const auto first = schedule.take(0), second = schedule.take(1);
  CHECK(first->weight == 200 * 1000u);
  CHECK(nearly(second->weight, 400));
  finish(schedule, 0, first, 200000);
  CHECK(nearly(schedule.take(0)->weight, 320));
}

TEST_CASE("problems are taken by size, then by number, whatever digits their sizes differ in") {
  std::vector<std::uint64_t> counts;
  for (std::uint64_t i = 0; i < 3000; ++i) counts.push_back(std::uint64_t{1} << (i * 7919 % 27));
  const Sizes sizes(counts);
  const BatchInput batch = sizes.view();
  WorkerState any = worker(0);
  any.plan.capacity = any.plan.job_bytes = any.plan.job_weight = UINT64_MAX;
  Schedule schedule(batch, {any});
  std::vector<std::uint32_t> taken, expected;
  while (const auto job = schedule.take(0)) {
    taken.insert(taken.end(), job->problems.begin(), job->problems.end());
    finish(schedule, 0, job);
  }
  for (std::uint32_t p = 0; p < counts.size(); ++p) expected.push_back(p);
  std::stable_sort(expected.begin(), expected.end(), [&](std::uint32_t p, std::uint32_t q) {
    return forest_bytes(1, counts[p], 0) > forest_bytes(1, counts[q], 0);
  });
  CHECK(taken == expected);
}

TEST_CASE("a worker takes over a job of a slow device, but none of its own device's") {
  const Sizes sizes({500000, 400000, 300000});
  const BatchInput batch = sizes.view();
  Schedule schedule(batch, {worker(0, 1), worker(1, 1000), worker(1, 1000)});
  const auto slow = schedule.take(0), second = schedule.take(1), third = schedule.take(2);
  REQUIRE(bool(second));
  REQUIRE(bool(third));
  finish(schedule, 2, third, 300);
  const auto stolen = schedule.take(2);
  const bool same = stolen == slow;
  CHECK(same);
  finish(schedule, 2, stolen, 500);
  CHECK(schedule.needless(*slow));
  CHECK(!schedule.needless(*second));
  CHECK(!schedule.finish(0, slow, result_of(*slow), {}, 1));
  finish(schedule, 1, second);
  for (std::size_t i = 0; i < 3; ++i) CHECK(bool(schedule.take(i)) == false);
  check_settled(schedule, 3);
}

TEST_CASE("a job that is overdue is taken over, however soon it was to be done") {
  const Sizes sizes({500000, 400000});
  const BatchInput batch = sizes.view();
  std::vector<WorkerState> workers = {worker(0, 1e6), worker(1, 1e6)};  // half a millisecond
  for (WorkerState& state : workers) state.plan.job_weight = 1;         // so one problem at a time
  Schedule schedule(batch, workers);
  const auto first = schedule.take(0), second = schedule.take(1);
  finish(schedule, 1, second, 0.4);
  const auto taken = schedule.take(1);  // blocks until it is
  const bool same = taken == first;
  CHECK(same);
  finish(schedule, 1, taken);
  CHECK(schedule.needless(*first));
  CHECK(!schedule.finish(0, first, result_of(*first), {}, 1));
  check_settled(schedule, 2);
}

TEST_CASE("whose job was done by another before it is known to be no faster than that") {
  const Sizes sizes({5000, 4000});
  const BatchInput batch = sizes.view();
  for (const double throughput : {0.0, 1e6}) {
    std::vector<WorkerState> workers = {worker(0, throughput), worker(1, 1e6)};
    for (WorkerState& state : workers) state.plan.job_weight = 1;
    Schedule schedule(batch, workers);
    const auto slow = schedule.take(0);
    finish(schedule, 1, schedule.take(1), 0.004);
    finish(schedule, 1, schedule.take(1), 0.004);  // taken over
    CHECK(schedule.needless(*slow));
    schedule.drop(0, slow);
    CHECK(schedule.state(0).throughput.known());
    CHECK(schedule.state(0).throughput.value() <
          (5000.0 + Tuning::problem_weight) / 5);  // no theft takes less than 5 ms
    check_settled(schedule, 2);
  }
}

TEST_CASE("a CPU beside a much faster GPU takes one small job a call, and what the GPU has no memory for") {
  const Sizes sizes = thousands(1000);
  const BatchInput batch = sizes.view();
  WorkerState cpu = worker(1, 100);
  cpu.plan.beside_gpus = true;
  SUBCASE("one small job") {
    Schedule schedule(batch, {worker(0, 1000), cpu});
    const auto small = schedule.take(1);
    REQUIRE(bool(small));
    CHECK(small->weight == 20000u);
    finish(schedule, 1, small, 200);
    std::thread other([&] { CHECK(bool(schedule.take(1)) == false); });
    while (schedule.unsettled() > 0) finish(schedule, 0, schedule.take(0));
    other.join();
    check_settled(schedule, 1000);
  }
  SUBCASE("none if it sits out") {
    cpu.started = true;
    Schedule schedule(batch, {worker(0, 1000), cpu});
    std::thread other([&] { CHECK(bool(schedule.take(1)) == false); });
    while (schedule.unsettled() > 0) finish(schedule, 0, schedule.take(0));
    other.join();
    check_settled(schedule, 1000);
  }
  SUBCASE("what it is fast enough for") {
    cpu.throughput = Throughput(200);
    Schedule schedule(batch, {worker(0, 1000), cpu});
    CHECK(schedule.take(1)->weight > 100000u);
  }
  SUBCASE("what the GPU has no memory for") {
    Schedule schedule(batch, {worker(0, 1000, 1), cpu});
    CHECK(bool(schedule.take(1)));
    CHECK(bool(schedule.take(1)));
  }
}

TEST_CASE("a worker that is too slow sits out ever more calls, until it is not") {
  Backoff worker;
  std::string calls;
  for (int call = 0; call < 17; ++call) {
    calls += worker.sits_out() ? '.' : 'x';
    worker.next_call(true);
  }
  CHECK(calls == "x.x..x....x......");
  while (worker.sits_out()) worker.next_call(true);
  worker.next_call(false);
  CHECK(!worker.sits_out());
  worker.next_call(true);
  worker.next_call(true);
  CHECK(!worker.sits_out());
}

TEST_CASE("the workers of a device do not take over from one another, however slow one was") {
  const Sizes sizes({500000, 400000});
  const BatchInput batch = sizes.view();
  Schedule schedule(batch, {worker(0, 1), worker(0, 1000)});
  const auto slow = schedule.take(0), second = schedule.take(1);
  finish(schedule, 1, second, 400);
  std::shared_ptr<Job> taken;
  std::thread other([&] { taken = schedule.take(1); });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  finish(schedule, 0, slow);
  other.join();
  CHECK(bool(taken) == false);
  check_settled(schedule, 2);
}

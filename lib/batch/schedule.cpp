// SPDX-License-Identifier: Apache-2.0
#include "batch/schedule.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace gcdt {

namespace {

using Clock = std::chrono::steady_clock;
// The most progress that is reported while workers are busy. When all is settled, some may still warm up or run in
// vain.
constexpr double most_told = 0.99;

std::chrono::nanoseconds nanoseconds(double milliseconds) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(milliseconds * 1e6));
}

}  // namespace

Schedule::Schedule(const BatchInput& batch, std::vector<WorkerState> workers)
    : batch_(batch), workers_(std::move(workers)) {
  places.resize(batch.problems);
  unsettled_ = batch.problems;
  bytes_.reserve(batch.problems), waiting_.reserve(batch.problems);
  for (std::uint32_t p = 0; p < batch.problems; ++p) {
    bytes_.push_back(forest_bytes(1, batch.n(p), batch.m(p)));
    weight_ += weight(p);
    if (batch.n(p) > max_vertices) {
      settle(p, Error(Status::too_many_vertices, std::to_string(batch.n(p)) + " vertices; at most " +
                                                     std::to_string(max_vertices) + " can be numbered"));
    } else if (batch.m(p) > GCDT_MAX_CONSTRAINTS) {
      settle(p, Error(Status::invalid_argument, "more than 2^31 - 1 constraints: " + std::to_string(batch.m(p))));
    } else {
      waiting_weight_ += weight(p), waiting_.push_back(p);
    }
  }
  sort_waiting();
}

// A radix sort, since all devices wait for it: it sorts 100,000 problems in 1 ms, std::sort in 12. Each pass keeps the
// order of equals, so problems of one size stay in the order of their numbers.
void Schedule::sort_waiting() {
  constexpr unsigned digit_bits = 11, all_bits = 64;
  constexpr std::uint64_t digit_mask = (std::uint64_t{1} << digit_bits) - 1;
  std::uint64_t any = 0, all = ~std::uint64_t{0};
  for (const std::uint32_t p : waiting_) any |= bytes(p), all &= bytes(p);
  std::vector<std::uint32_t> moved(waiting_.size());
  for (unsigned shift = 0; shift < all_bits; shift += digit_bits) {
    if (((any ^ all) >> shift & digit_mask) == 0) continue;  // all have the same digit
    const auto digit = [&](std::uint32_t p) { return ~bytes(p) >> shift & digit_mask; };
    std::array<std::size_t, digit_mask + 2> begins = {};
    for (const std::uint32_t p : waiting_) ++begins[digit(p) + 1];
    for (std::size_t d = 0; d <= digit_mask; ++d) begins[d + 1] += begins[d];
    for (const std::uint32_t p : waiting_) moved[begins[digit(p)]++] = p;
    waiting_.swap(moved);
  }
}

// Larger first, then by number, so that the order does not depend on chance.
bool Schedule::is_before(std::uint32_t p, std::uint32_t q) const {
  return bytes(p) != bytes(q) ? bytes(p) > bytes(q) : p < q;
}

std::uint64_t Schedule::bytes(const Job& job) const {
  std::uint64_t n = 0, m = 0;
  for (const std::uint32_t p : job.problems) n += batch_.n(p), m += batch_.m(p);
  return forest_bytes(job.problems.size(), n, m);
}

std::shared_ptr<Job> Schedule::take(std::size_t worker) {
  Lock lock(mutex_);
  // The loop ends, because a worker waits only while another one runs or is about to end. Every run ends. Each end
  // settles problems, shrinks a capacity, makes a worker refuse a problem, or makes workers end.
  for (;;) {
    if (cancelled_ || workers_[worker].lost || unsettled_ == 0) return nullptr;
    if (!must_wait(worker)) {
      if (auto job = take_waiting(worker)) return job;
      if (auto job = steal(worker)) return job;
      if (running_.empty()) {
        refuse_what_is_too_large();
        changed_.notify_all();
        if (unsettled_ == 0) return nullptr;
      }
    }
    changed_.wait_for(lock, Tuning::steal_interval);
  }
}

// The mean of the workers of the device that have been measured, because all are equally fast; 0 if none has.
double Schedule::throughput_of(std::size_t device) const {
  double throughputs = 0, known = 0;
  for (const WorkerState& state : workers_)
    if (state.device == device && state.throughput.known()) throughputs += state.throughput.value(), ++known;
  return known > 0 ? throughputs / known : 0;
}

// Shares the rest out so that all workers end together, and returns in how many milliseconds they end. `worker` is idle
// and has a throughput.
double Schedule::milliseconds_of_rest(std::size_t worker) const {
  std::vector<BusyWorker> workers(workers_.size());
  for (std::size_t i = 0; i < workers_.size(); ++i)
    if (i == worker || (!workers_[i].lost && !workers_[i].too_slow))
      workers[i].throughput = throughput_of(workers_[i].device);
  for (const auto& job : running_) {
    const std::chrono::duration<double, std::milli> left = remaining(*job);
    if (!job->done && job->owner != worker) workers[job->owner].milliseconds = left.count();
  }
  return common_end(std::move(workers), static_cast<double>(waiting_weight_));
}

// The weight that the worker's next job should have, before the limits for memory and weight.
double Schedule::wanted_weight(std::size_t worker) const {
  const WorkerState& state = workers_[worker];
  const auto rest = static_cast<double>(waiting_weight_);
  double alive = 0;
  bool alike = true;
  for (const WorkerState& other : workers_)
    if (!other.lost) ++alive, alike = alike && other.device == state.device;
  if (alive == 1) return rest;
  const double part = state.started ? 1 : state.first_part, throughput = throughput_of(state.device);
  if (throughput <= 0)
    return part * (alike ? std::max(Tuning::first_weight, rest / alive * Tuning::part_of_rest)
                         : std::min(Tuning::first_weight, rest / alive));
  const double end = milliseconds_of_rest(worker),
               least = throughput * state.plan.job_overhead * Tuning::least_overheads;
  if (!state.started && end > Tuning::little_milliseconds)
    return std::max(least, part * throughput * end * Tuning::part_of_rest);
  const double wanted =
      std::max(least, throughput * end * (end <= Tuning::last_milliseconds ? 1 : Tuning::part_of_rest));
  return rest - wanted < throughput * Tuning::least_left_milliseconds ? rest : wanted;
}

// Whether the worker should leave problem p to a GPU. It should if it is a CPU's, and much slower than a GPU that can
// take p.
bool Schedule::leaves_to_gpu(std::size_t worker, std::uint32_t p) const {
  const WorkerState& state = workers_[worker];
  if (!state.plan.beside_gpus || !state.throughput.known()) return false;
  std::map<std::size_t, double> throughputs;  // of devices
  for (const WorkerState& other : workers_)
    if (!other.plan.beside_gpus && !other.lost && other.plan.capacity >= bytes(p) && other.refused.count(p) == 0)
      throughputs[other.device] += other.throughput.value();
  return std::any_of(throughputs.begin(), throughputs.end(), [&](const auto& device) {
    return state.throughput.value() < device.second * Tuning::least_part_of_gpu;
  });
}

// Whether the worker needs memory that other workers of its device still hold, which are about to end.
bool Schedule::must_wait(std::size_t worker) const {
  return std::any_of(workers_.begin(), workers_.end(), [&](const WorkerState& other) {
    return other.device == workers_[worker].device && other.lost && !other.ended;
  });
}

// Makes a job of the largest problem in the list that fits, and of problems that follow it.
std::shared_ptr<Job> Schedule::take_waiting(std::size_t worker) {
  const WorkerState& state = workers_[worker];
  const auto fits = std::partition_point(waiting_.begin(), waiting_.end(),
                                         [&](std::uint32_t p) { return bytes(p) > state.plan.capacity; });
  const auto begin = std::find_if(fits, waiting_.end(), [&](std::uint32_t p) { return state.refused.count(p) == 0; });
  if (begin == waiting_.end()) return nullptr;
  double wanted = std::min(wanted_weight(worker), static_cast<double>(state.plan.job_weight));
  if (leaves_to_gpu(worker, *begin)) {
    workers_[worker].too_slow = true;
    if (state.started) return nullptr;
    wanted = std::min(wanted, std::max(Tuning::first_weight, state.throughput.value() * Tuning::little_milliseconds));
  }
  auto job = std::make_shared<Job>();
  const auto end = begin + static_cast<std::ptrdiff_t>(
                               count_that_fit(state, static_cast<std::size_t>(begin - waiting_.begin()), wanted));
  job->problems.assign(begin, end);
  for (const std::uint32_t p : job->problems) job->weight += weight(p);
  waiting_.erase(begin, end);
  waiting_weight_ -= job->weight;
  workers_[worker].started = true;
  start(worker, job, true);
  return job;
}

// How many waiting problems from `begin` on make a job, at least one. The memory formula takes longest here, and all
// workers wait for it. So it is asked once for all problems that the other limits allow, and only if they do not fit
// again, by bisection.
std::size_t Schedule::count_that_fit(const WorkerState& state, std::size_t begin, double most_weight) const {
  std::vector<std::array<std::uint64_t, 2>> sums;  // [i]: vertices and constraints of the first i + 1 problems
  std::uint64_t n = 0, m = 0, all = 0;
  for (std::size_t i = begin; i < waiting_.size(); ++i) {
    const std::uint32_t p = waiting_[i];
    n += batch_.n(p), m += batch_.m(p), all += weight(p);
    const bool by_itself = outgrown(waiting_[begin]) || outgrown(p);
    // Triangle numbers are 30 bits wide, and a root counts as a vertex at most.
    if (i > begin && (by_itself || static_cast<double>(all) > most_weight || n + i + 1 - begin > max_vertices)) break;
    sums.push_back({n, m});
  }
  const std::uint64_t most_bytes = std::min(state.plan.job_bytes, state.plan.capacity);
  const auto fits = [&](std::size_t count) {
    return forest_bytes(count, sums[count - 1][0], sums[count - 1][1]) <= most_bytes;
  };
  if (fits(sums.size())) return sums.size();
  std::size_t least = 1, most = sums.size();  // one fits, or is taken in any case; `most` do not fit
  while (most - least > 1) (fits(least + (most - least) / 2) ? least : most) = least + (most - least) / 2;
  return least;
}

// A job that is overdue is taken to need as long again as it is late, because nothing better is known.
Clock::duration Schedule::remaining(const Job& job) {
  const auto now = Clock::now();
  return now < job.due ? job.due - now : now - job.due;
}

// Takes the job of another device that will be done last, if this worker would be done with it well before.
std::shared_ptr<Job> Schedule::steal(std::size_t worker) {
  const WorkerState& state = workers_[worker];
  const double throughput = throughput_of(state.device);
  if (throughput <= 0) return nullptr;
  std::shared_ptr<Job> latest;
  for (const auto& job : running_)
    if (!job->done && job->runners == 1 && workers_[job->owner].device != state.device &&
        (!latest || remaining(*job) > remaining(*latest)))
      latest = job;
  if (!latest) return nullptr;
  if (bytes(*latest) > state.plan.capacity) return nullptr;
  for (const std::uint32_t p : state.refused)
    if (std::count(latest->problems.begin(), latest->problems.end(), p) > 0) return nullptr;
  const double own = std::max(state.plan.job_overhead + static_cast<double>(latest->weight) / throughput,
                              Tuning::least_theft_milliseconds);
  if (nanoseconds(own * Tuning::theft_margin) >= remaining(*latest)) return nullptr;
  start(worker, latest, false);
  return latest;
}

void Schedule::start(std::size_t worker, const std::shared_ptr<Job>& job, bool first) {
  ++job->runners;
  if (!first) return;
  job->owner = worker;
  const double throughput = throughput_of(workers_[worker].device);
  job->began = job->due = Clock::now();
  if (throughput > 0)
    job->due += nanoseconds(workers_[worker].plan.job_overhead + static_cast<double>(job->weight) / throughput);
  running_.push_back(job);
}

bool Schedule::finish(std::size_t worker, const std::shared_ptr<Job>& job, ForestResult result,
                      std::vector<std::pair<std::uint32_t, Error>> own_errors, double milliseconds) {
  const std::vector<std::uint32_t> problems = result.problems;
  Lock lock(mutex_);
  WorkerState& state = workers_[worker];
  state.throughput.add(static_cast<double>(job->weight),
                       std::max(milliseconds - state.plan.job_overhead, milliseconds * Tuning::least_part_of_contents));
  if (job->done) {
    stop_running(job);
    return false;
  }
  // From here on nothing throws, so the job is marked as done.
  const auto number = static_cast<std::uint32_t>(results.size());
  results.push_back(std::move(result));
  for (auto& [p, error] : own_errors) errors.insert_or_assign(p, std::move(error));
  job->done = true;
  settled_weight_ += job->weight;
  unsettled_ -= job->problems.size();
  stop_running(job);
  lock.unlock();  // no other worker writes these places, and nobody reads them before all workers have ended
  for (std::uint32_t i = 0; i < problems.size(); ++i) places[problems[i]] = {number, i};
  return true;
}

void Schedule::settle(std::uint32_t p, Error error) {
  errors.emplace(p, std::move(error));
  settled_weight_ += weight(p);
  --unsettled_;
}

void Schedule::stop_running(const std::shared_ptr<Job>& job) {
  if (--job->runners == 0) running_.remove(job);
  changed_.notify_all();
}

// Puts the job's problems back into the list, unless another worker has done the job or is running it.
void Schedule::put_back(const std::shared_ptr<Job>& job) {
  stop_running(job);
  if (job->done || job->runners > 0) return;
  const std::size_t middle = waiting_.size();
  waiting_.insert(waiting_.end(), job->problems.begin(), job->problems.end());
  std::inplace_merge(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(middle), waiting_.end(),
                     [&](std::uint32_t p, std::uint32_t q) { return is_before(p, q); });
  waiting_weight_ += job->weight;
}

void Schedule::too_large(std::size_t worker, const std::shared_ptr<Job>& job, const Error& error,
                         std::optional<std::uint32_t> problem) {
  const Lock lock(mutex_);
  if (evict_others(worker)) {
    put_back(job);
    return;
  }
  shortage_ = error;
  if (problem) {
    workers_[worker].refused.insert(*problem);
    outgrown_.insert(*problem);
    put_back(job);
    return;
  }
  const std::uint64_t needed = bytes(*job);
  // The worker takes half as much from now on, but enough for the largest problem of several, and not again this one.
  workers_[worker].plan.capacity =
      std::min(workers_[worker].plan.capacity,
               job->problems.size() > 1 ? std::max(needed / 2, bytes(job->problems[0])) : needed - 1);
  put_back(job);
}

// Makes the other workers of the device end. Returns whether there were any, or whether the worker itself is to end.
bool Schedule::evict_others(std::size_t worker) {
  bool shared = workers_[worker].lost;
  for (std::size_t other = 0; other < workers_.size(); ++other)
    if (other != worker && workers_[other].device == workers_[worker].device && !workers_[worker].lost &&
        !workers_[other].lost)
      shared = workers_[other].lost = workers_[other].evicted = true;
  return shared;
}

void Schedule::end(std::size_t worker) {
  const Lock lock(mutex_);
  workers_[worker].lost = workers_[worker].ended = true;
  changed_.notify_all();
}

void Schedule::lose(std::size_t worker, const std::shared_ptr<Job>& job) {
  const Lock lock(mutex_);
  for (WorkerState& other : workers_)
    if (other.device == workers_[worker].device) other.lost = true;
  if (job) put_back(job);
  changed_.notify_all();
}

// If another worker has done the job, this one's throughput is at most the job's weight over the time until now. If the
// job was its first, nothing else is known of its throughput.
void Schedule::drop(std::size_t worker, const std::shared_ptr<Job>& job) {
  const Lock lock(mutex_);
  if (job->owner == worker && job->done) {
    const std::chrono::duration<double, std::milli> took = Clock::now() - job->began;
    const double most = static_cast<double>(job->weight) / std::max(took.count(), 1e-3);
    Throughput& throughput = workers_[worker].throughput;
    if (!throughput.known() || most < throughput.value()) throughput = Throughput(most);
  }
  put_back(job);
}

void Schedule::cancel() {
  const Lock lock(mutex_);
  cancelled_ = true;
  changed_.notify_all();
}

// No worker runs, and a living one has found nothing that it can take. So the problems that are too large for every
// living worker get an error.
void Schedule::refuse_what_is_too_large() {
  std::uint64_t most = 0;
  for (const WorkerState& state : workers_)
    if (!state.lost) most = std::max(most, state.plan.capacity);
  const auto refuse = [&](std::uint32_t p) {
    waiting_weight_ -= weight(p);
    std::string message = "the problem needs ";
    message += outgrown(p) ? "more than its size says" : "about " + std::to_string(bytes(p)) + " bytes";
    message += " of device memory; ";
    message += shortage_ ? shortage_->what() : "the devices have " + std::to_string(most) + " at most";
    settle(p, Error(Status::out_of_memory, message));
  };
  while (!waiting_.empty() && bytes(waiting_.front()) > most) {
    refuse(waiting_.front());
    waiting_.erase(waiting_.begin());
  }
  for (const std::uint32_t p : outgrown_) {
    const auto found = std::find(waiting_.begin(), waiting_.end(), p);
    if (found == waiting_.end() || std::any_of(workers_.begin(), workers_.end(), [&](const WorkerState& state) {
          return !state.lost && state.refused.count(p) == 0 && bytes(p) <= state.plan.capacity;
        }))
      continue;
    refuse(p);
    waiting_.erase(found);
  }
}

double Schedule::wait() {
  Lock lock(mutex_);
  const auto ended = [&] {
    return std::all_of(workers_.begin(), workers_.end(), [](const WorkerState& state) { return state.ended; });
  };
  if (!ended()) changed_.wait_for(lock, Tuning::progress_interval);
  if (ended()) return 1;
  const double settled = weight_ > 0 ? static_cast<double>(settled_weight_) / static_cast<double>(weight_) : 1;
  return std::min(settled, most_told);
}

WorkerState Schedule::state(std::size_t worker) {
  const Lock lock(mutex_);
  return workers_[worker];
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "batch/schedule.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace gcdt {

namespace {

using Clock = std::chrono::steady_clock;
// The most progress that is reported while lanes are busy; all may be settled, and they rehearse, or run in vain.
constexpr double most_told = 0.99;

std::chrono::nanoseconds nanoseconds(double milliseconds) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(milliseconds * 1e6));
}

}  // namespace

Schedule::Schedule(const BatchInput& batch, std::vector<LaneShare> lanes) : batch_(batch), lanes_(std::move(lanes)) {
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

// A radix sort: it sorts 100,000 problems in 1 ms instead of 12, and all devices wait for it. Each pass keeps the order
// of equals, so problems of one size stay in the order of their numbers.
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
bool Schedule::before(std::uint32_t p, std::uint32_t q) const {
  return bytes(p) != bytes(q) ? bytes(p) > bytes(q) : p < q;
}

std::uint64_t Schedule::bytes(const Pack& pack) const {
  std::uint64_t n = 0, m = 0;
  for (const std::uint32_t p : pack.problems) n += batch_.n(p), m += batch_.m(p);
  return forest_bytes(pack.problems.size(), n, m);
}

std::shared_ptr<Pack> Schedule::take(std::size_t lane) {
  Lock lock(mutex_);
  // The loop ends: a lane waits only while another one runs or is about to end. Every run ends, and each end settles
  // problems, shrinks a capacity, makes a lane refuse a problem, or makes lanes end.
  for (;;) {
    if (cancelled_ || lanes_[lane].lost || unsettled_ == 0) return nullptr;
    if (!must_wait(lane)) {
      if (auto pack = cut(lane)) return pack;
      if (auto pack = steal(lane)) return pack;
      if (running_.empty()) {
        refuse_what_is_too_large();
        changed_.notify_all();
        if (unsettled_ == 0) return nullptr;
      }
    }
    changed_.wait_for(lock, Tuning::glance);
  }
}

// The mean over the lanes of the device that have been measured, as they are equally fast; 0 if none has.
double Schedule::speed_of(std::size_t device) const {
  double speeds = 0, known = 0;
  for (const LaneShare& share : lanes_)
    if (share.device == device && share.speed.known()) speeds += share.speed.value(), ++known;
  return known > 0 ? speeds / known : 0;
}

// In how many milliseconds all lanes would end if the rest were shared out so that they end together. `lane` is idle
// and has a speed.
double Schedule::milliseconds_of_rest(std::size_t lane) const {
  std::vector<BusyLane> lanes(lanes_.size());
  for (std::size_t i = 0; i < lanes_.size(); ++i)
    if (i == lane || (!lanes_[i].lost && !lanes_[i].left_out)) lanes[i].speed = speed_of(lanes_[i].device);
  for (const auto& pack : running_) {
    const std::chrono::duration<double, std::milli> left = remaining(*pack);
    if (!pack->done && pack->owner != lane) lanes[pack->owner].milliseconds = left.count();
  }
  return common_end(std::move(lanes), static_cast<double>(waiting_weight_));
}

// The weight that the lane's next pack should have, before the limits for memory and weight.
double Schedule::wanted_weight(std::size_t lane) const {
  const LaneShare& share = lanes_[lane];
  const auto rest = static_cast<double>(waiting_weight_);
  double alive = 0;
  bool alike = true;
  for (const LaneShare& other : lanes_)
    if (!other.lost) ++alive, alike = alike && other.device == share.device;
  if (alive == 1) return rest;
  const double part = share.started ? 1 : share.first_part, speed = speed_of(share.device);
  if (speed <= 0)
    return part * (alike ? std::max(Tuning::first_weight, rest / alive * Tuning::part_of_rest)
                         : std::min(Tuning::first_weight, rest / alive));
  const double end = milliseconds_of_rest(lane), least = speed * share.overhead * Tuning::least_overheads;
  if (!share.started && end > Tuning::little_milliseconds)
    return std::max(least, part * speed * end * Tuning::part_of_rest);
  const double wanted = std::max(least, speed * end * (end <= Tuning::last_milliseconds ? 1 : Tuning::part_of_rest));
  return rest - wanted < speed * Tuning::least_left_milliseconds ? rest : wanted;
}

// Whether the lane should leave problem p to a GPU: the lane is a CPU's, and much slower than a GPU that can take p.
bool Schedule::leaves(std::size_t lane, std::uint32_t p) const {
  const LaneShare& share = lanes_[lane];
  if (!share.beside_gpus || !share.speed.known()) return false;
  std::map<std::size_t, double> speeds;  // of devices
  for (const LaneShare& other : lanes_)
    if (!other.beside_gpus && !other.lost && other.capacity >= bytes(p) && other.refused.count(p) == 0)
      speeds[other.device] += other.speed.value();
  return std::any_of(speeds.begin(), speeds.end(), [&](const auto& device) {
    return share.speed.value() < device.second * Tuning::least_part_of_gpu;
  });
}

// Whether lanes of the same device are about to end: they still hold memory that the lane needs.
bool Schedule::must_wait(std::size_t lane) const {
  return std::any_of(lanes_.begin(), lanes_.end(), [&](const LaneShare& other) {
    return other.device == lanes_[lane].device && other.lost && !other.ended;
  });
}

// A pack from the front of the list, from the largest problem that fits on.
std::shared_ptr<Pack> Schedule::cut(std::size_t lane) {
  const LaneShare& share = lanes_[lane];
  const auto fits = std::partition_point(waiting_.begin(), waiting_.end(),
                                         [&](std::uint32_t p) { return bytes(p) > share.capacity; });
  const auto begin = std::find_if(fits, waiting_.end(), [&](std::uint32_t p) { return share.refused.count(p) == 0; });
  if (begin == waiting_.end()) return nullptr;
  double wanted = std::min(wanted_weight(lane), static_cast<double>(share.most_weight));
  if (leaves(lane, *begin)) {
    lanes_[lane].left_out = true;
    if (share.started) return nullptr;
    wanted = std::min(wanted, std::max(Tuning::first_weight, share.speed.value() * Tuning::little_milliseconds));
  }
  auto pack = std::make_shared<Pack>();
  const auto end =
      begin + static_cast<std::ptrdiff_t>(that_fit(share, static_cast<std::size_t>(begin - waiting_.begin()), wanted));
  pack->problems.assign(begin, end);
  for (const std::uint32_t p : pack->problems) pack->weight += weight(p);
  waiting_.erase(begin, end);
  waiting_weight_ -= pack->weight;
  lanes_[lane].started = true;
  start(lane, pack, true);
  return pack;
}

// How many waiting problems from `begin` on make a pack, at least one. The memory formula is the slowest part, and all
// lanes wait for it. So it is asked once, for all problems that the other limits allow, and then by bisection.
std::size_t Schedule::that_fit(const LaneShare& share, std::size_t begin, double most_weight) const {
  std::vector<std::array<std::uint64_t, 2>> sums;  // [i]: vertices and constraints of the first i + 1 problems
  std::uint64_t n = 0, m = 0, all = 0;
  for (std::size_t i = begin; i < waiting_.size(); ++i) {
    const std::uint32_t p = waiting_[i];
    n += batch_.n(p), m += batch_.m(p), all += weight(p);
    const bool alone = outgrown(waiting_[begin]) || outgrown(p);
    // Triangle numbers are 30 bits wide, and a root counts as a vertex at most.
    if (i > begin && (alone || static_cast<double>(all) > most_weight || n + i + 1 - begin > max_vertices)) break;
    sums.push_back({n, m});
  }
  const std::uint64_t most_bytes = std::min(share.most_bytes, share.capacity);
  const auto fits = [&](std::size_t count) {
    return forest_bytes(count, sums[count - 1][0], sums[count - 1][1]) <= most_bytes;
  };
  if (fits(sums.size())) return sums.size();
  std::size_t least = 1, most = sums.size();  // one fits, or is taken in any case; `most` do not fit
  while (most - least > 1) (fits(least + (most - least) / 2) ? least : most) = least + (most - least) / 2;
  return least;
}

// A pack that is overdue may take as long again as it is late: nothing better is known.
Clock::duration Schedule::remaining(const Pack& pack) {
  const auto now = Clock::now();
  return now < pack.due ? pack.due - now : now - pack.due;
}

// The pack of another device that will be done last, if this lane would be done with it well before.
std::shared_ptr<Pack> Schedule::steal(std::size_t lane) {
  const LaneShare& share = lanes_[lane];
  const double speed = speed_of(share.device);
  if (speed <= 0) return nullptr;
  std::shared_ptr<Pack> latest;
  for (const auto& pack : running_)
    if (!pack->done && pack->runners == 1 && lanes_[pack->owner].device != share.device &&
        (!latest || remaining(*pack) > remaining(*latest)))
      latest = pack;
  if (!latest) return nullptr;
  if (bytes(*latest) > share.capacity) return nullptr;
  for (const std::uint32_t p : share.refused)
    if (std::count(latest->problems.begin(), latest->problems.end(), p) > 0) return nullptr;
  const double own =
      std::max(share.overhead + static_cast<double>(latest->weight) / speed, Tuning::least_theft_milliseconds);
  if (nanoseconds(own * Tuning::theft_margin) >= remaining(*latest)) return nullptr;
  start(lane, latest, false);
  return latest;
}

void Schedule::start(std::size_t lane, const std::shared_ptr<Pack>& pack, bool first) {
  ++pack->runners;
  if (!first) return;
  pack->owner = lane;
  const double speed = speed_of(lanes_[lane].device);
  pack->began = pack->due = Clock::now();
  if (speed > 0) pack->due += nanoseconds(lanes_[lane].overhead + static_cast<double>(pack->weight) / speed);
  running_.push_back(pack);
}

bool Schedule::finish(std::size_t lane, const std::shared_ptr<Pack>& pack, ForestResult result,
                      std::vector<std::pair<std::uint32_t, Error>> own_errors, double milliseconds) {
  const std::vector<std::uint32_t> problems = result.problems;
  Lock lock(mutex_);
  LaneShare& share = lanes_[lane];
  share.speed.add(static_cast<double>(pack->weight),
                  std::max(milliseconds - share.overhead, milliseconds * Tuning::least_part_of_contents));
  if (pack->done) {
    stop_running(pack);
    return false;
  }
  // From here on nothing throws, so the pack is marked as done.
  const auto number = static_cast<std::uint32_t>(results.size());
  results.push_back(std::move(result));
  for (auto& [p, error] : own_errors) errors.insert_or_assign(p, std::move(error));
  pack->done = true;
  settled_weight_ += pack->weight;
  unsettled_ -= pack->problems.size();
  stop_running(pack);
  lock.unlock();  // no other lane writes these places, and nobody reads them before all lanes have ended
  for (std::uint32_t i = 0; i < problems.size(); ++i) places[problems[i]] = {number, i};
  return true;
}

void Schedule::settle(std::uint32_t p, Error error) {
  errors.emplace(p, std::move(error));
  settled_weight_ += weight(p);
  --unsettled_;
}

void Schedule::stop_running(const std::shared_ptr<Pack>& pack) {
  if (--pack->runners == 0) running_.remove(pack);
  changed_.notify_all();
}

// The pack's problems go back into the list, unless another lane has done the pack or is running it.
void Schedule::put_back(const std::shared_ptr<Pack>& pack) {
  stop_running(pack);
  if (pack->done || pack->runners > 0) return;
  const std::size_t middle = waiting_.size();
  waiting_.insert(waiting_.end(), pack->problems.begin(), pack->problems.end());
  std::inplace_merge(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(middle), waiting_.end(),
                     [&](std::uint32_t p, std::uint32_t q) { return before(p, q); });
  waiting_weight_ += pack->weight;
}

void Schedule::too_large(std::size_t lane, const std::shared_ptr<Pack>& pack, const Error& error,
                         std::optional<std::uint32_t> problem) {
  const Lock lock(mutex_);
  if (crowd_out_others(lane)) {
    put_back(pack);
    return;
  }
  shortage_ = error;
  if (problem) {
    lanes_[lane].refused.insert(*problem);
    outgrown_.insert(*problem);
    put_back(pack);
    return;
  }
  const std::uint64_t needed = bytes(*pack);
  // Half of what the pack needs, but enough for its largest problem; less than that if it is the only one.
  lanes_[lane].capacity = std::min(
      lanes_[lane].capacity, pack->problems.size() > 1 ? std::max(needed / 2, bytes(pack->problems[0])) : needed - 1);
  put_back(pack);
}

// Makes the other lanes of the device end. Returns whether there were any, or the lane itself is to end.
bool Schedule::crowd_out_others(std::size_t lane) {
  bool shared = lanes_[lane].lost;
  for (std::size_t other = 0; other < lanes_.size(); ++other)
    if (other != lane && lanes_[other].device == lanes_[lane].device && !lanes_[lane].lost && !lanes_[other].lost)
      shared = lanes_[other].lost = lanes_[other].crowded_out = true;
  return shared;
}

bool Schedule::crowded_out(std::size_t lane) {
  const Lock lock(mutex_);
  return lanes_[lane].crowded_out;
}

void Schedule::end(std::size_t lane) {
  const Lock lock(mutex_);
  lanes_[lane].lost = lanes_[lane].ended = true;
  changed_.notify_all();
}

void Schedule::lose(std::size_t lane, const std::shared_ptr<Pack>& pack) {
  const Lock lock(mutex_);
  for (LaneShare& other : lanes_)
    if (other.device == lanes_[lane].device) other.lost = true;
  if (pack) put_back(pack);
  changed_.notify_all();
}

// A lane that was not done with its pack by now is no faster than the pack's weight over this time. If it was its first
// pack, that bound is all that is known of its speed.
void Schedule::drop(std::size_t lane, const std::shared_ptr<Pack>& pack) {
  const Lock lock(mutex_);
  if (pack->owner == lane && pack->done) {
    const std::chrono::duration<double, std::milli> took = Clock::now() - pack->began;
    const double most = static_cast<double>(pack->weight) / std::max(took.count(), 1e-3);
    Speed& speed = lanes_[lane].speed;
    if (!speed.known() || most < speed.value()) speed = Speed(most);
  }
  put_back(pack);
}

void Schedule::cancel() {
  const Lock lock(mutex_);
  cancelled_ = true;
  changed_.notify_all();
}

// No lane runs, and one that lives has found nothing that it can take. So the problems that are too large for every
// lane that lives get an error.
void Schedule::refuse_what_is_too_large() {
  std::uint64_t most = 0;
  for (const LaneShare& share : lanes_)
    if (!share.lost) most = std::max(most, share.capacity);
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
    if (found == waiting_.end() || std::any_of(lanes_.begin(), lanes_.end(), [&](const LaneShare& share) {
          return !share.lost && share.refused.count(p) == 0 && bytes(p) <= share.capacity;
        }))
      continue;
    refuse(p);
    waiting_.erase(found);
  }
}

double Schedule::wait() {
  Lock lock(mutex_);
  const auto ended = [&] {
    return std::all_of(lanes_.begin(), lanes_.end(), [](const LaneShare& share) { return share.ended; });
  };
  if (!ended()) changed_.wait_for(lock, Tuning::beat);
  if (ended()) return 1;
  const double settled = weight_ > 0 ? static_cast<double>(settled_weight_) / static_cast<double>(weight_) : 1;
  return std::min(settled, most_told);
}

bool Schedule::left_out(std::size_t lane) {
  const Lock lock(mutex_);
  return lanes_[lane].left_out;
}

Speed Schedule::speed(std::size_t lane) {
  const Lock lock(mutex_);
  return lanes_[lane].speed;
}

}  // namespace gcdt

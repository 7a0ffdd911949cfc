// SPDX-License-Identifier: Apache-2.0
#include "schedule.hpp"

#include <algorithm>

namespace gcdt {

namespace {

using Clock = std::chrono::steady_clock;

// A device whose speed is not known gets so much first: enough to tell, little enough to lose no time on a slow one.
constexpr std::uint64_t first_weight = 20000;
// A pack should take so long at least: below, launches that find no work are the time.
constexpr double least_milliseconds = 20;
// A thief must be sure to win.
constexpr double theft_margin = 1.5;
// Triangle numbers are 30 bits wide, and a root counts as a vertex at most.
constexpr std::uint64_t most_vertices = max_vertices;
// How long to wait before looking again whether a pack is worth stealing, and to tell progress.
constexpr auto glance = std::chrono::milliseconds(5), beat = std::chrono::milliseconds(50);

std::chrono::nanoseconds nanoseconds(double milliseconds) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(milliseconds * 1e6));
}

}  // namespace

Schedule::Schedule(const BatchInput& batch, std::vector<DeviceShare> devices)
    : batch_(batch), devices_(std::move(devices)) {
  places.resize(batch.problems);
  errors.resize(batch.problems);
  unsettled_ = batch.problems;
  for (std::uint32_t p = 0; p < batch.problems; ++p) bytes_.push_back(forest_bytes(1, batch.n(p), batch.m(p)));
  for (std::uint32_t p = 0; p < batch.problems; ++p) {
    weight_ += weight(p);
    waiting_weight_ += weight(p);
    if (batch.n(p) > max_vertices)
      settle(p, Error(Status::too_many_vertices, std::to_string(batch.n(p)) + " vertices; at most " +
                                                     std::to_string(max_vertices) + " can be numbered"));
    else if (batch.m(p) > GCDT_MAX_CONSTRAINTS)
      settle(p, Error(Status::invalid_argument, "more than 2^31 - 1 constraints: " + std::to_string(batch.m(p))));
    else
      waiting_.push_back(p);
    if (errors[p]) waiting_weight_ -= weight(p);
  }
  std::sort(waiting_.begin(), waiting_.end(), [&](std::uint32_t p, std::uint32_t q) { return before(p, q); });
}

// Larger first, then by number: what packs hold does not depend on chance.
bool Schedule::before(std::uint32_t p, std::uint32_t q) const {
  return bytes(p) != bytes(q) ? bytes(p) > bytes(q) : p < q;
}

std::uint64_t Schedule::bytes(const Pack& pack) const {
  std::uint64_t n = 0, m = 0;
  for (const std::uint32_t p : pack.problems) n += batch_.n(p), m += batch_.m(p);
  return forest_bytes(pack.problems.size(), n, m);
}

std::shared_ptr<Pack> Schedule::take(std::size_t device) {
  Lock lock(mutex_);
  // Ends: a device waits only while another runs, and every run ends; each settles problems, shrinks a capacity or
  // loses a device.
  for (;;) {
    if (cancelled_ || devices_[device].lost || unsettled_ == 0) return nullptr;
    if (auto pack = cut(device)) return pack;
    if (auto pack = steal(device)) return pack;
    if (running_.empty()) {
      refuse_what_is_too_large();
      changed_.notify_all();
      if (unsettled_ == 0) return nullptr;
    }
    changed_.wait_for(lock, glance);
  }
}

// From the largest that fits on.
std::shared_ptr<Pack> Schedule::cut(std::size_t device) {
  const DeviceShare& share = devices_[device];
  const auto begin = std::partition_point(waiting_.begin(), waiting_.end(),
                                          [&](std::uint32_t p) { return bytes(p) > share.capacity; });
  if (begin == waiting_.end()) return nullptr;
  double speeds = 0;
  std::size_t alive = 0;
  for (const DeviceShare& other : devices_)
    if (!other.lost) speeds += other.speed, ++alive;
  double wanted = std::min<double>(first_weight, static_cast<double>(waiting_weight_) / static_cast<double>(alive));
  if (alive == 1)
    wanted = static_cast<double>(waiting_weight_);
  else if (share.speed > 0)
    wanted =
        std::max(share.speed * least_milliseconds, static_cast<double>(waiting_weight_) * share.speed / speeds / 2);
  wanted = std::min(wanted, static_cast<double>(share.most_weight));
  auto pack = std::make_shared<Pack>();
  std::uint64_t n = 0, m = 0;
  auto end = begin;
  for (; end != waiting_.end(); ++end) {
    const std::uint64_t more_n = n + batch_.n(*end), more_m = m + batch_.m(*end);
    const std::uint64_t problems = pack->problems.size() + 1;
    if (problems > 1 && (static_cast<double>(pack->weight + weight(*end)) > wanted ||
                         more_n + problems > most_vertices || forest_bytes(problems, more_n, more_m) > share.capacity))
      break;
    pack->problems.push_back(*end);
    pack->weight += weight(*end);
    n = more_n, m = more_m;
  }
  waiting_.erase(begin, end);
  waiting_weight_ -= pack->weight;
  start(device, pack, true);
  return pack;
}

// The pack that is due last, if this device would be done with it well before.
std::shared_ptr<Pack> Schedule::steal(std::size_t device) {
  const DeviceShare& share = devices_[device];
  if (share.speed <= 0) return nullptr;
  std::shared_ptr<Pack> latest;
  for (const auto& pack : running_)
    if (!pack->done && pack->runners == 1 && pack->owner != device && pack->due != Clock::time_point() &&
        (!latest || pack->due > latest->due))
      latest = pack;
  if (!latest) return nullptr;
  if (bytes(*latest) > share.capacity) return nullptr;
  const double own = static_cast<double>(latest->weight) / share.speed;
  if (Clock::now() + nanoseconds(own * theft_margin) >= latest->due) return nullptr;
  start(device, latest, false);
  return latest;
}

void Schedule::start(std::size_t device, const std::shared_ptr<Pack>& pack, bool first) {
  ++pack->runners;
  if (!first) return;
  pack->owner = device;
  const double speed = devices_[device].speed;
  pack->due = speed > 0 ? Clock::now() + nanoseconds(static_cast<double>(pack->weight) / speed) : Clock::time_point();
  running_.push_back(pack);
}

bool Schedule::finish(std::size_t device, const std::shared_ptr<Pack>& pack, ForestResult result,
                      std::vector<std::pair<std::uint32_t, Error>> own_errors, double milliseconds) {
  const Lock lock(mutex_);
  // The latest run counts most: sizes change in the course of a batch.
  const double measured = static_cast<double>(pack->weight) / std::max(milliseconds, 1e-3);
  double& speed = devices_[device].speed;
  speed = speed > 0 ? (speed + 2 * measured) / 3 : measured;
  const bool first = !pack->done;
  if (first) {
    pack->done = true;
    const auto number = static_cast<std::uint32_t>(results.size());
    for (std::uint32_t i = 0; i < result.problems.size(); ++i) {
      places[result.problems[i]] = {number, i};
      settle(result.problems[i], std::nullopt);
    }
    for (auto& [p, error] : own_errors) settle(p, std::move(error));
    results.push_back(std::move(result));
  }
  stop_running(pack);
  return first;
}

void Schedule::settle(std::uint32_t p, std::optional<Error> error) {
  errors[p] = std::move(error);
  settled_weight_ += weight(p);
  --unsettled_;
}

void Schedule::stop_running(const std::shared_ptr<Pack>& pack) {
  if (--pack->runners == 0) running_.remove(pack);
  changed_.notify_all();
}

// Unless another has it or has done it, its problems wait again.
void Schedule::put_back(const std::shared_ptr<Pack>& pack) {
  stop_running(pack);
  if (pack->done || pack->runners > 0) return;
  const std::size_t middle = waiting_.size();
  waiting_.insert(waiting_.end(), pack->problems.begin(), pack->problems.end());
  std::inplace_merge(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(middle), waiting_.end(),
                     [&](std::uint32_t p, std::uint32_t q) { return before(p, q); });
  waiting_weight_ += pack->weight;
}

void Schedule::too_large(std::size_t device, const std::shared_ptr<Pack>& pack, const Error& error) {
  const Lock lock(mutex_);
  const std::uint64_t needed = bytes(*pack);
  // Half of it, or less than its only problem.
  devices_[device].capacity =
      std::min(devices_[device].capacity,
               pack->problems.size() > 1 ? std::max(needed / 2, bytes(pack->problems[0])) : needed - 1);
  shortage_ = error;
  put_back(pack);
}

void Schedule::lose(std::size_t device, const std::shared_ptr<Pack>& pack) {
  const Lock lock(mutex_);
  devices_[device].lost = true;
  if (pack) put_back(pack);
  changed_.notify_all();
}

void Schedule::drop(const std::shared_ptr<Pack>& pack) {
  const Lock lock(mutex_);
  put_back(pack);
}

bool Schedule::needless(const std::shared_ptr<Pack>& pack) {
  const Lock lock(mutex_);
  return cancelled_ || pack->done;
}

void Schedule::cancel() {
  const Lock lock(mutex_);
  cancelled_ = true;
  changed_.notify_all();
}

// Nobody runs, and somebody who lives has been asked: what all that live have no memory for is refused.
void Schedule::refuse_what_is_too_large() {
  std::uint64_t most = 0;
  for (const DeviceShare& share : devices_)
    if (!share.lost) most = std::max(most, share.capacity);
  while (!waiting_.empty() && bytes(waiting_.front()) > most) {
    const std::uint32_t p = waiting_.front();
    waiting_.erase(waiting_.begin());
    waiting_weight_ -= weight(p);
    std::string message = "the problem needs about " + std::to_string(bytes(p)) + " bytes of device memory; ";
    message += shortage_ ? shortage_->what() : "the devices have " + std::to_string(most) + " at most";
    settle(p, Error(Status::out_of_memory, message));
  }
}

double Schedule::wait() {
  Lock lock(mutex_);
  const auto nobody = [&] {
    return std::all_of(devices_.begin(), devices_.end(), [](const DeviceShare& share) { return share.lost; });
  };
  if (unsettled_ > 0 && !nobody()) changed_.wait_for(lock, beat);
  if (unsettled_ == 0 || nobody()) return 1;
  return static_cast<double>(settled_weight_) / static_cast<double>(weight_);
}

double Schedule::speed(std::size_t device) {
  const Lock lock(mutex_);
  return devices_[device].speed;
}

}  // namespace gcdt

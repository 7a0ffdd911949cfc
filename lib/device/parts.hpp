// SPDX-License-Identifier: Apache-2.0
// Work on host arrays, shared out to threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <future>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "device/crew.hpp"

namespace gcdt {

/// A range of numbers in parts of consecutive ones, one a thread. What is made part by part, in the order of the parts,
/// is in the order of the numbers.
class Parts {
 public:
  /// A part has `least` numbers or more, but the only one: a thread takes time to start.
  explicit Parts(std::size_t count, std::size_t least = 4096) : count_(count) {
    const std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
    parts_ = std::max<std::size_t>(1, std::min(threads, count / least));
  }
  std::size_t size() const { return parts_; }
  /// Calls use(part, first, end) for each part, at once, by the thread's crew (crew.hpp) or by new threads; where the
  /// system has no more threads, one after the other.
  /// Throws what the first part throws that does, or before any call.
  template <class Use>
  void run(Use&& use) const {
    std::vector<std::exception_ptr> failed(parts_);
    const auto one = [&](std::size_t part) {
      try {
        use(part, count_ * part / parts_, count_ * (part + 1) / parts_);
      } catch (...) {
        failed[part] = std::current_exception();
      }
    };
    if (Crew* const crew = parts_ > 1 ? Crew::of_this_thread() : nullptr)
      crew->run(parts_, one);
    else
      in_new_threads(one);
    for (const std::exception_ptr& error : failed)
      if (error) std::rethrow_exception(error);
  }

 private:
  template <class One>
  void in_new_threads(One&& one) const {
    std::vector<std::thread> threads;
    threads.reserve(parts_);
    for (std::size_t part = 1; part < parts_; ++part) {
      try {
        threads.emplace_back(one, part);
      } catch (const std::system_error&) {
        one(part);
      }
    }
    one(0);
    for (std::thread& thread : threads) thread.join();
  }

  std::size_t count_, parts_;
};

/// Calls use(i) for each i below `count`, in threads.
template <class Use>
void for_each_in_threads(std::size_t count, Use&& use, std::size_t least = 4096) {
  Parts(count, least).run([&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) use(i);
  });
}

/// Begins work() in a thread; where the system has none, it is done when it is waited for.
template <class Work>
std::future<void> begin_in_thread(Work&& work) {
  try {
    return std::async(std::launch::async, work);
  } catch (const std::system_error&) {
    return std::async(std::launch::deferred, std::forward<Work>(work));
  }
}

/// The sum of count(i) over all i below `end`.
template <class Count>
std::uint64_t count_in_threads(std::size_t end, Count&& count) {
  const Parts parts(end);
  std::vector<std::uint64_t> sums(parts.size(), 0);
  parts.run([&](std::size_t part, std::size_t first, std::size_t last) {
    std::uint64_t sum = 0;
    for (std::size_t i = first; i < last; ++i) sum += static_cast<std::uint64_t>(count(i));
    sums[part] = sum;
  });
  std::uint64_t sum = 0;
  for (const std::uint64_t some : sums) sum += some;
  return sum;
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "device/crew.hpp"

#include <system_error>

namespace gcdt {

namespace {
thread_local Crew* made_here = nullptr;
}

Crew::Crew(std::size_t threads) : outer_(made_here) {
  const auto make_others = [this, threads] {
    try {
      for (std::size_t i = 1; i < threads; ++i) threads_.emplace_back([this] { work(); });
    } catch (const std::exception&) {
      // There is no thread to be had, or no memory: those that there are do it.
    }
    work();
  };
  try {
    if (threads > 0) first_ = std::thread(make_others);
  } catch (const std::system_error&) {
  }
  made_here = this;
}

Crew::~Crew() {
  made_here = outer_;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
  }
  begun_.notify_all();
  if (first_.joinable()) first_.join();
  for (std::thread& thread : threads_) thread.join();
}

Crew* Crew::of_this_thread() { return made_here && !made_here->part_ ? made_here : nullptr; }

// `part_` is null or not by this thread alone, so that it may ask without the lock.
void Crew::run(std::size_t parts, const std::function<void(std::size_t)>& part) {
  std::unique_lock<std::mutex> lock(mutex_);
  part_ = &part, parts_ = left_ = parts, next_ = 0;
  begun_.notify_all();
  make_some(lock);
  done_.wait(lock, [&] { return left_ == 0; });
  part_ = nullptr;
}

// Ends when no part is left to begin.
void Crew::make_some(std::unique_lock<std::mutex>& lock) {
  while (next_ < parts_) {
    const std::size_t number = next_++;
    const auto& part = *part_;
    lock.unlock();
    part(number);
    lock.lock();
    if (--left_ == 0) done_.notify_one();
  }
}

void Crew::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!over_) {
    make_some(lock);
    if (!over_) begun_.wait(lock);
  }
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
#include "device/copy_crew.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "device/tuning.hpp"

namespace gcdt::runtime {

namespace {

// Copies without loading the destination into the caches.
void copy_past_caches(unsigned char* to, const unsigned char* from, std::size_t bytes) {
#ifdef __SSE2__
  constexpr std::size_t word = sizeof(__m128i);
  const std::size_t unaligned = std::min(bytes, (word - reinterpret_cast<std::uintptr_t>(to) % word) % word);
  std::memcpy(to, from, unaligned);
  std::size_t at = unaligned;
  for (; at + word <= bytes; at += word)
    _mm_stream_si128(reinterpret_cast<__m128i*>(to + at), _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + at)));
  _mm_sfence();
  std::memcpy(to + at, from + at, bytes - at);
#else
  std::memcpy(to, from, bytes);
#endif
}

}  // namespace

CopyCrew::~CopyCrew() {
  forget();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
  }
  begun_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void CopyCrew::limit(unsigned threads) { most_helpers_ = threads > 0 ? threads - 1 : 0; }

void CopyCrew::begin(std::size_t slot, const Copy& copy) {
  bool enough;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    busy_[slot] = true;
    waiting_.emplace_back(slot, copy);
    enough = waiting_.size() <= idle_;
  }
  if (!helpers_.empty()) begun_.notify_one();
  if (!enough && helpers_.size() < most_helpers_) start_helper();
}

void CopyCrew::start_helper() {
  try {
    helpers_.emplace_back([this] { help(); });
  } catch (const std::exception&) {
    most_helpers_ = helpers_.size();  // there is no thread to be had: those that are there copy
  }
}

void CopyCrew::forget() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (const auto& [slot, copy] : waiting_) busy_[slot] = false;
  waiting_.clear();
  done_.wait(lock, [this] { return std::find(busy_.begin(), busy_.end(), true) == busy_.end(); });
}

// A slot that is busy while nothing waits is a helper's, who tells when it is done.
void CopyCrew::wait(std::size_t slot) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (busy_[slot])
    if (waiting_.empty())
      done_.wait(lock);
    else
      make_next(lock);
}

void CopyCrew::help() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!over_)
    if (waiting_.empty()) {
      ++idle_;
      begun_.wait(lock);
      --idle_;
    } else {
      make_next(lock);
    }
}

void CopyCrew::make_next(std::unique_lock<std::mutex>& lock) {
  const auto [slot, copy] = waiting_.front();
  waiting_.pop_front();
  lock.unlock();
  if (copy.past_caches && copy.bytes >= Tuning::least_streamed)
    copy_past_caches(copy.to, copy.from, copy.bytes);
  else
    std::memcpy(copy.to, copy.from, copy.bytes);
  lock.lock();
  busy_[slot] = false;
  done_.notify_one();  // only one thread waits
}

}  // namespace gcdt::runtime

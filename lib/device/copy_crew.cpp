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

std::size_t pieces_of(const CopyCrew::Copy& copy) {
  return (copy.bytes + Tuning::copied_at_once - 1) / Tuning::copied_at_once;
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
    left_[slot] = copy.bytes;
    waiting_.push_back({slot, copy});
    std::size_t pieces = 0;
    for (const Waiting& waiting : waiting_) pieces += pieces_of(waiting.rest);
    enough = pieces <= idle_;
  }
  if (pieces_of(copy) > 1)
    begun_.notify_all();
  else
    begun_.notify_one();
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
  for (const Waiting& waiting : waiting_) left_[waiting.slot] -= waiting.rest.bytes;
  waiting_.clear();
  done_.wait(lock, [this] { return std::all_of(left_.begin(), left_.end(), [](std::size_t n) { return n == 0; }); });
}

// Bytes that are left while none wait are helpers', who tell when a copy has been made.
void CopyCrew::wait(std::size_t slot) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (left_[slot] > 0)
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
  auto& [slot_of_rest, rest] = waiting_.front();
  const std::size_t slot = slot_of_rest;
  Copy part = rest;
  const bool whole = part.to_caller && waiting_.size() > 1;
  if (!whole) part.bytes = std::min(part.bytes, Tuning::copied_at_once);
  rest.to += part.bytes, rest.from += part.bytes, rest.bytes -= part.bytes;
  if (rest.bytes == 0) waiting_.pop_front();
  lock.unlock();
  if (part.to_caller && part.bytes >= Tuning::least_streamed)
    copy_past_caches(part.to, part.from, part.bytes);
  else
    std::memcpy(part.to, part.from, part.bytes);
  lock.lock();
  left_[slot] -= part.bytes;
  if (left_[slot] == 0) done_.notify_one();  // only one thread waits
}

}  // namespace gcdt::runtime

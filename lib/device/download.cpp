// SPDX-License-Identifier: Apache-2.0
#include "device/download.hpp"

#include <algorithm>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace gcdt::runtime {

namespace {

constexpr std::size_t chunk = Tuning::download_chunk;

// Copies without loading the destination into the caches: nobody on the host reads it soon.
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

std::unique_ptr<Download> Download::make(Runtime& runtime) {
  auto made = std::make_unique<Download>(runtime);
  return made->memory_.get() ? std::move(made) : nullptr;
}

Download::Download(Runtime& runtime) : runtime_(runtime), memory_(runtime, 2 * chunk) {}

// The host empties one half of the memory while the device fills the other. After an error a read may still be under
// way into it; it is done before any read that is queued later.
void Download::read(cl_mem from, std::size_t offset, void* to, std::size_t bytes) {
  const std::size_t chunks = (bytes + chunk - 1) / chunk;
  cl::Event read[2];
  for (std::size_t i = 0; i <= chunks; ++i) {
    if (i < chunks)
      runtime_.read_later(from, offset + i * chunk, memory_.get() + i % 2 * chunk, std::min(chunk, bytes - i * chunk),
                          read[i % 2]);
    if (i == 0) continue;
    const std::size_t ready = i - 1, size = std::min(chunk, bytes - ready * chunk);
    runtime_.wait(std::exchange(read[ready % 2], cl::Event()));
    auto* place = static_cast<unsigned char*>(to) + ready * chunk;
    const unsigned char* there = memory_.get() + ready % 2 * chunk;
    if (size < Tuning::least_streamed)
      std::memcpy(place, there, size);
    else
      copy_past_caches(place, there, size);
  }
}

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
// The linker's --wrap sends the program's own calls of malloc(), aligned_alloc() and free() here; drivers are shared
// objects, which have theirs.
#include "host_heap.hpp"

#include <atomic>

namespace {

std::atomic<std::int64_t> in_use{0}, peak{0};

}  // namespace

#ifdef GCDT_BENCH_COUNTS_HEAP

#include <malloc.h>

#include <cstdlib>
#include <new>

namespace {

void* counted(void* memory) {
  if (!memory) return memory;
  const auto bytes = static_cast<std::int64_t>(malloc_usable_size(memory));
  const std::int64_t now = in_use += bytes;
  // Ends: the peak only grows.
  for (std::int64_t most = peak; now > most && !peak.compare_exchange_weak(most, now);) continue;
  return memory;
}

}  // namespace

extern "C" {
void* __real_malloc(std::size_t bytes);
void* __real_aligned_alloc(std::size_t alignment, std::size_t bytes);
void __real_free(void* memory);

void* __wrap_malloc(std::size_t bytes) { return counted(__real_malloc(bytes)); }
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t bytes) {
  return counted(__real_aligned_alloc(alignment, bytes));
}
void __wrap_free(void* memory) {
  if (memory) in_use -= static_cast<std::int64_t>(malloc_usable_size(memory));
  __real_free(memory);
}
}

void* operator new(std::size_t bytes) {
  void* memory = std::malloc(bytes > 0 ? bytes : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

#endif

namespace gcdt::bench {

std::int64_t heap_in_use() { return in_use; }

std::int64_t take_heap_peak() { return peak.exchange(in_use); }

bool counts_heap() {
#ifdef GCDT_BENCH_COUNTS_HEAP
  return true;
#else
  return false;
#endif
}

}  // namespace gcdt::bench

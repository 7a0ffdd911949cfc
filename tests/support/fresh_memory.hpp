// SPDX-License-Identifier: Apache-2.0
// Memory of the system's own, and which of its pages have been touched.
#pragma once

#include <doctest/doctest.h>

#include <sys/mman.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <vector>

namespace gcdt::test {

/// Memory of the system's own that nobody has touched.
struct Fresh {
  std::size_t bytes;
  unsigned char* first;
  explicit Fresh(std::size_t size)
      : bytes(size),
        first(static_cast<unsigned char*>(
            mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))) {
    REQUIRE(first != MAP_FAILED);
    madvise(first, bytes, MADV_NOHUGEPAGE);  // so that each page counts
  }
  Fresh(const Fresh&) = delete;
  Fresh& operator=(const Fresh&) = delete;
  ~Fresh() { munmap(first, bytes); }

  /// Of its pages, which of them the system has given memory to.
  std::vector<bool> touched() const {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    std::vector<unsigned char> found((bytes + page - 1) / page);
    REQUIRE(mincore(first, bytes, found.data()) == 0);
    std::vector<bool> there;
    for (const unsigned char flags : found) there.push_back(flags & 1);
    return there;
  }
};

/// Whether the condition comes true within a time that no machine needs.
template <class Condition>
bool comes_true(Condition&& condition) {
  for (int i = 0; i < 20000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace gcdt::test

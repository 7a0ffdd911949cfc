// SPDX-License-Identifier: Apache-2.0
// Arrays that cannot be written to, nor read beyond their end: whoever tries ends the process.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <vector>

#include <gcdt/types.hpp>

namespace gcdt::test {

/// A copy of an array in pages of its own, which are read only; it ends where a page begins that is not there.
template <class T>
class ReadOnly {
 public:
  explicit ReadOnly(const std::vector<T>& from) : count_(from.size()) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t bytes = count_ * sizeof(T), pages = (bytes + page - 1) / page * page;
    bytes_ = pages + page;
    void* memory = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("no memory to be protected");
    memory_ = static_cast<char*>(memory);
    char* const first = memory_ + pages - bytes;
    if (bytes > 0) std::memcpy(first, from.data(), bytes);
    data_ = reinterpret_cast<const T*>(first);
    if (mprotect(memory_, pages, PROT_READ) != 0 || mprotect(memory_ + pages, page, PROT_NONE) != 0)
      throw std::runtime_error("memory cannot be protected");
  }
  ~ReadOnly() { munmap(memory_, bytes_); }
  ReadOnly(const ReadOnly&) = delete;
  ReadOnly& operator=(const ReadOnly&) = delete;

  const T* data() const { return data_; }
  std::size_t size() const { return count_; }
  Span<T> span() const { return {data_, count_}; }

 private:
  std::size_t count_, bytes_ = 0;
  char* memory_ = nullptr;
  const T* data_ = nullptr;
};

}  // namespace gcdt::test

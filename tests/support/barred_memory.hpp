// SPDX-License-Identifier: Apache-2.0
// Memory at which a thread that reads it can be held: so a test decides who comes when.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <vector>

namespace gcdt::test {

/// A copy of bytes. Who reads its first page waits, within the handler of SIGSEGV, until open() is called. At most two
/// at a time, made and destroyed by one thread.
class BarredMemory {
 public:
  explicit BarredMemory(const std::vector<unsigned char>& from)
      : page_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))), bytes_((from.size() + page_ - 1) / page_ * page_) {
    void* memory = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("no memory to be barred");
    memory_ = static_cast<unsigned char*>(memory);
    std::memcpy(memory_, from.data(), from.size());
    if (mprotect(memory_, page_, PROT_NONE) != 0) throw std::runtime_error("memory cannot be barred");
    if (!live[0] && !live[1]) {
      struct sigaction holds {};
      holds.sa_sigaction = hold;
      holds.sa_flags = SA_SIGINFO | SA_NODEFER;
      if (sigaction(SIGSEGV, &holds, &before) != 0) throw std::runtime_error("signals cannot be handled");
    }
    live[live[0] ? 1 : 0] = this;
  }
  ~BarredMemory() {
    live[live[0] == this ? 0 : 1] = nullptr;
    if (!live[0] && !live[1]) sigaction(SIGSEGV, &before, nullptr);
    munmap(memory_, bytes_);
  }
  BarredMemory(const BarredMemory&) = delete;
  BarredMemory& operator=(const BarredMemory&) = delete;

  const unsigned char* data() const { return memory_; }
  /// Whether a thread waits, or has waited.
  bool reached() const { return reached_; }
  void open() { open_ = true; }

 private:
  // Ends when open() is called, which a test does before it waits for the thread that is held here. A fault elsewhere
  // goes to whom it went before.
  static void hold(int, siginfo_t* fault, void*) {
    const auto* at = static_cast<const unsigned char*>(fault->si_addr);
    for (BarredMemory* barred : live)
      if (barred && at >= barred->memory_ && at < barred->memory_ + barred->page_) {
        barred->reached_ = true;
        while (!barred->open_) std::this_thread::sleep_for(std::chrono::microseconds(100));
        mprotect(barred->memory_, barred->page_, PROT_READ);
        return;
      }
    sigaction(SIGSEGV, &before, nullptr);
  }

  static inline std::array<std::atomic<BarredMemory*>, 2> live{};
  static inline struct sigaction before {};

  std::size_t page_, bytes_;
  unsigned char* memory_ = nullptr;
  std::atomic<bool> reached_{false}, open_{false};
};

/// Lets go whom a test that fails would hold.
struct OpenedAtEnd {
  std::vector<BarredMemory*> memories;
  ~OpenedAtEnd() {
    for (BarredMemory* memory : memories) memory->open();
  }
};

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
#include "tiles/spill.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#ifdef _WIN32
#include <process.h>

#include <atomic>
#else
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace gcdt::tiles {

namespace {

// Bytes that go to or from a file at once: a multiple of every element's.
constexpr std::size_t most_at_once = std::size_t{3} << 23;

/// Null, with errno, if it cannot be made.
std::FILE* nameless_file(const std::string& directory) {
#ifdef _WIN32
  static std::atomic<unsigned> count{0};
  const std::string name = directory + "\\gcdt-" + std::to_string(_getpid()) + "-" + std::to_string(count++);
  return std::fopen(name.c_str(), "w+bTDx");  // D: deleted when it is closed, or the process ends
#else
  int descriptor = -1;
#ifdef O_TMPFILE
  descriptor = open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
#endif
  if (descriptor < 0) {  // not on every file system
    std::string name = directory + "/gcdt-XXXXXX";
    descriptor = mkstemp(name.data());
    if (descriptor < 0) return nullptr;
    unlink(name.c_str());
  }
  std::FILE* file = fdopen(descriptor, "w+b");
  if (!file) close(descriptor);
  return file;
#endif
}

[[noreturn]] void fail_in(const std::string& directory, const char* what) {
  throw Error(Status::spill_failed, "spilling to " + directory + ": " + what + ": " + std::strerror(errno));
}

}  // namespace

Spill::Spill(const std::string& directory) : directory_(directory) {
  file_.reset(nameless_file(directory));
  if (!file_) fail("no file can be made");
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
}

void Spill::fail(const char* what) const { fail_in(directory_, what); }

void Spill::put_bytes(runtime::Runtime& runtime, cl_mem from, std::size_t bytes) {
  sizes_.push_back(bytes);
  std::vector<unsigned char> part(std::min(bytes, most_at_once));
  for (std::size_t at = 0; at < bytes; at += part.size()) {
    const std::size_t count = std::min(part.size(), bytes - at);
    runtime.read_bytes(from, at, part.data(), count);
    if (std::fwrite(part.data(), 1, count, file_.get()) != count) fail("writing failed");
  }
}

void Spill::take_parts(
    std::size_t element,
    const std::function<void(const unsigned char* part, std::size_t first, std::size_t count)>& use) {
  const std::size_t number = taken_++, bytes = sizes_.at(number);
  if (number == 0) std::rewind(file_.get());
  HostArray part;
  const std::size_t most = std::min(bytes, most_at_once);
  part.make<unsigned char>(most);
  for (std::size_t at = 0; at < bytes; at += most) {
    const std::size_t count = std::min(most, bytes - at);
    if (std::fread(part.bytes.get(), 1, count, file_.get()) != count) fail("reading failed");
    use(part.bytes.get(), at / element, count / element);
  }
}

SpilledArrays::SpilledArrays(const std::string& directory, const std::vector<Span<unsigned char>>& arrays) {
  constexpr std::size_t alignment = 64;
  for (const Span<unsigned char>& array : arrays) {
    begins_.push_back(bytes_), sizes_.push_back(array.size());
    bytes_ += (array.size() + alignment - 1) / alignment * alignment;
  }
  if (bytes_ == 0) return;
#ifdef _WIN32
  first_ = memory_.make<unsigned char>(bytes_);
  for (std::size_t i = 0; i < arrays.size(); ++i)
    std::copy(arrays[i].begin(), arrays[i].end(), memory_.bytes.get() + begins_[i]);
#else
  file_.reset(nameless_file(directory));
  std::FILE* const file = file_.get();
  if (!file) fail_in(directory, "no file can be made");
  std::setvbuf(file, nullptr, _IONBF, 0);
  const unsigned char gap[alignment] = {};
  for (const Span<unsigned char>& array : arrays) {
    const std::size_t behind = (alignment - array.size() % alignment) % alignment;
    if (std::fwrite(array.data(), 1, array.size(), file) != array.size() || std::fwrite(gap, 1, behind, file) != behind)
      fail_in(directory, "writing failed");
  }
  void* const mapped = mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, fileno(file), 0);
  if (mapped == MAP_FAILED) fail_in(directory, "the file cannot be mapped");
  first_ = static_cast<const unsigned char*>(mapped);
#endif
}

SpilledArrays::~SpilledArrays() {
#ifndef _WIN32
  if (first_) munmap(const_cast<unsigned char*>(first_), bytes_);
#endif
}

}  // namespace gcdt::tiles

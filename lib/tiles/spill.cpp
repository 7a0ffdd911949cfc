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

}  // namespace

Spill::Spill(const std::string& directory) : directory_(directory) {
  file_.reset(nameless_file(directory));
  if (!file_) fail("no file can be made");
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
}

void Spill::fail(const char* what) const {
  throw Error(Status::spill_failed, "spilling to " + directory_ + ": " + what + ": " + std::strerror(errno));
}

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

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
#include "device/cache.hpp"

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <random>

namespace gcdt::cache {

namespace fs = std::filesystem;

namespace {

// First line of a file; the second is the digest of all that follows it.
constexpr char magic[] = "gcdt cache 3\n";
constexpr std::size_t digest_length = 32, header_length = sizeof magic - 1 + digest_length + 1;

// A program's binary has megabytes at most: what is larger is no entry.
constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 28;

// A set variable that is not empty.
std::optional<std::string> variable(const char* name) {
  const char* value = std::getenv(name);
  if (!value || !*value) return std::nullopt;
  return value;
}

}  // namespace

namespace {

constexpr std::uint64_t rotated(std::uint64_t word, int bits) { return word << bits | word >> (64 - bits); }

constexpr std::uint64_t mixed(std::uint64_t word) {
  word = (word ^ word >> 33) * 0xff51afd7ed558ccd;
  word = (word ^ word >> 33) * 0xc4ceb9fe1a85ec53;
  return word ^ word >> 33;
}

}  // namespace

// What is left of a block is filled up with zeros, which add nothing.
std::string digest(const std::string& bytes) {
  constexpr std::uint64_t c1 = 0x87c37b91114253d5, c2 = 0x4cf5ad432745937f;
  std::uint64_t a = 0, b = 0;
  std::uint64_t words[2];
  const auto take_words = [&](std::size_t at, std::size_t count) {
    std::memcpy(words, bytes.data() + at, count);
    words[0] = rotated(words[0] * c1, 31) * c2;
    words[1] = rotated(words[1] * c2, 33) * c1;
  };
  const std::size_t rest = bytes.size() % 16;
  for (std::size_t at = 0; at < bytes.size() - rest; at += 16) {
    take_words(at, 16);
    a = (rotated(a ^ words[0], 27) + b) * 5 + 0x52dce729;
    b = (rotated(b ^ words[1], 31) + a) * 5 + 0x38495ab5;
  }
  words[0] = words[1] = 0;
  take_words(bytes.size() - rest, rest);
  a ^= words[0], b ^= words[1];
  a ^= bytes.size(), b ^= bytes.size();
  a += b, b += a;
  a = mixed(a), b = mixed(b);
  a += b, b += a;
  std::string text;
  for (const std::uint64_t limb : {a, b})
    for (int shift = 60; shift >= 0; shift -= 4) text += "0123456789abcdef"[limb >> shift & 15];
  return text;
}

fs::path folder() {
  const auto disabled = variable("GCDT_DISABLE_CACHE");
  if (disabled && *disabled != "0") return {};
  if (const auto chosen = variable("GCDT_CACHE_DIR")) return *chosen;
#if defined(_WIN32)
  if (const auto local = variable("LOCALAPPDATA")) return fs::path(*local) / "gcdt";
#else
  // The XDG specification ignores relative paths.
  if (const auto xdg = variable("XDG_CACHE_HOME"); xdg && fs::path(*xdg).is_absolute()) return fs::path(*xdg) / "gcdt";
#if defined(__APPLE__)
  if (const auto home = variable("HOME")) return fs::path(*home) / "Library" / "Caches" / "gcdt";
#else
  if (const auto home = variable("HOME")) return fs::path(*home) / ".cache" / "gcdt";
#endif
#endif
  return {};
}

std::string entry(const char* kind, const std::vector<std::string>& parts) {
  std::string all;  // lengths keep ("ab", "c") apart from ("a", "bc")
  for (const auto& part : parts) all += std::to_string(part.size()) + ':' + part;
  return std::string(kind) + '-' + digest(all);
}

std::optional<std::string> load(const std::string& entry) {
  const fs::path place = folder();
  if (place.empty()) return std::nullopt;
  std::error_code error;
  if (!fs::is_regular_file(place / entry, error)) return std::nullopt;  // a pipe would be waited for
  const std::uintmax_t size = fs::file_size(place / entry, error);
  std::string all(error || size > most_bytes ? 0 : static_cast<std::size_t>(size), '\0');
  std::ifstream file(place / entry, std::ios::binary);
  const bool whole = static_cast<bool>(file.read(all.data(), static_cast<std::streamsize>(all.size())));
  file.close();
  if (whole && all.size() >= header_length) {
    std::string content = all.substr(header_length);
    if (all.compare(0, header_length, magic + digest(content) + '\n') == 0) return content;
  }
  remove(entry);
  return std::nullopt;
}

namespace {

// Of a file under way: an entry's, which ends with a digest, then a dot and a number.
bool is_temporary(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  return dot != std::string::npos && dot > digest_length && name[dot - digest_length - 1] == '-' &&
         name.find_first_not_of("0123456789abcdef", dot - digest_length) == dot && dot + 1 < name.size() &&
         name.find_first_not_of("0123456789", dot + 1) == std::string::npos;
}

// What processes left that were killed while they wrote: it is older than any write takes. Once a process and folder:
// who stores a hundred programs need not read a folder of thousands as often.
void remove_left(const fs::path& place) {
  static std::mutex mutex;
  static fs::path cleared;  // under mutex
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (cleared == place) return;
    cleared = place;
  }
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
  std::error_code error, ignored;
  for (fs::directory_iterator file(place, error), end; !error && file != end; file.increment(error)) {
    if (!is_temporary(file->path().filename().string())) continue;
    const fs::file_time_type written = fs::last_write_time(file->path(), ignored);
    if (!ignored && written < old) fs::remove(file->path(), ignored);
  }
}

}  // namespace

void store(const std::string& entry, const std::string& content) {
  const fs::path place = folder();
  if (place.empty()) return;
  std::error_code ignored;
  fs::create_directories(place, ignored);
  remove_left(place);
  std::random_device random;  // so that two writers do not share a temporary file
  const fs::path temporary = place / (entry + '.' + std::to_string(random()) + std::to_string(random()));
  std::ofstream file(temporary, std::ios::binary);
  file << magic << digest(content) << '\n' << content;
  file.close();
  std::error_code failed;
  if (file) fs::rename(temporary, place / entry, failed);
  if (!file || failed) fs::remove(temporary, ignored);
}

bool has(const std::string& entry) {
  std::error_code ignored;
  const fs::path place = folder();
  return !place.empty() && fs::is_regular_file(place / entry, ignored);
}

void remove(const std::string& entry) {
  std::error_code ignored;
  fs::remove(folder() / entry, ignored);
}

}  // namespace gcdt::cache

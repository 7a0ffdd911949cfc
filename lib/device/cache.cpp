// SPDX-License-Identifier: Apache-2.0
#include "device/cache.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>

namespace gcdt::cache {

namespace fs = std::filesystem;

namespace {

// First line of a file; the second is the digest of all that follows it.
constexpr char magic[] = "gcdt cache 1\n";
constexpr std::size_t digest_length = 64, header_length = sizeof magic - 1 + digest_length + 1;

// FIPS 180-4, 4.2.2.
constexpr std::array<std::uint32_t, 64> round_words = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

std::uint32_t rotated(std::uint32_t x, int by) { return x >> by | x << (32 - by); }

void digest_block(std::array<std::uint32_t, 8>& state, const unsigned char* block) {
  std::array<std::uint32_t, 64> w;
  for (int i = 0; i < 16; ++i)
    w[i] = std::uint32_t{block[4 * i]} << 24 | std::uint32_t{block[4 * i + 1]} << 16 |
           std::uint32_t{block[4 * i + 2]} << 8 | block[4 * i + 3];
  for (int i = 16; i < 64; ++i)
    w[i] = w[i - 16] + (rotated(w[i - 15], 7) ^ rotated(w[i - 15], 18) ^ w[i - 15] >> 3) + w[i - 7] +
           (rotated(w[i - 2], 17) ^ rotated(w[i - 2], 19) ^ w[i - 2] >> 10);
  auto [a, b, c, d, e, f, g, h] = state;
  for (int i = 0; i < 64; ++i) {
    const std::uint32_t t1 =
        h + (rotated(e, 6) ^ rotated(e, 11) ^ rotated(e, 25)) + ((e & f) ^ (~e & g)) + round_words[i] + w[i];
    const std::uint32_t t2 = (rotated(a, 2) ^ rotated(a, 13) ^ rotated(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
  }
  const std::array<std::uint32_t, 8> sum = {a, b, c, d, e, f, g, h};
  for (int i = 0; i < 8; ++i) state[i] += sum[i];
}

// A set variable that is not empty.
std::optional<std::string> variable(const char* name) {
  const char* value = std::getenv(name);
  if (!value || !*value) return std::nullopt;
  return value;
}

}  // namespace

std::string digest(const std::string& bytes) {
  std::array<std::uint32_t, 8> state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  // Padding: a one bit, zeros, the length in bits as 64-bit big-endian, up to a multiple of 64 bytes.
  std::string padded = bytes + '\x80';
  padded.append((120 - padded.size() % 64) % 64, '\0');
  for (int shift = 56; shift >= 0; shift -= 8)
    padded += static_cast<char>(std::uint64_t{bytes.size()} * 8 >> shift & 0xFF);
  for (std::size_t at = 0; at < padded.size(); at += 64)
    digest_block(state, reinterpret_cast<const unsigned char*>(padded.data()) + at);
  std::string text;
  for (std::uint32_t word : state)
    for (int shift = 28; shift >= 0; shift -= 4) text += "0123456789abcdef"[word >> shift & 15];
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
  std::ifstream file(place / entry, std::ios::binary);
  if (!file) return std::nullopt;
  const std::string all((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  file.close();
  if (all.size() >= header_length) {
    std::string content = all.substr(header_length);
    if (all.compare(0, header_length, magic + digest(content) + '\n') == 0) return content;
  }
  remove(entry);
  return std::nullopt;
}

void store(const std::string& entry, const std::string& content) {
  const fs::path place = folder();
  if (place.empty()) return;
  std::error_code ignored;
  fs::create_directories(place, ignored);
  std::random_device random;  // so that two writers do not share a temporary file
  const fs::path temporary = place / (entry + '.' + std::to_string(random()) + std::to_string(random()));
  std::ofstream file(temporary, std::ios::binary);
  file << magic << digest(content) << '\n' << content;
  file.close();
  std::error_code failed;
  if (file) fs::rename(temporary, place / entry, failed);
  if (!file || failed) fs::remove(temporary, ignored);
}

void remove(const std::string& entry) {
  std::error_code ignored;
  fs::remove(folder() / entry, ignored);
}

}  // namespace gcdt::cache

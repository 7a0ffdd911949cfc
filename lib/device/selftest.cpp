// SPDX-License-Identifier: Apache-2.0
// Does the device compute rightly? A driver whose mul_hi or carry is wrong would give wrong triangles
// without any other sign, so nothing runs before these few words have been right once.
#include <array>

#include "common/shared.h"
#include "device/cache.hpp"
#include "device/runtime.hpp"

namespace gcdt::runtime {

namespace {

// Worked out with arbitrary-precision integers, not by any code of this library.
struct Row {
  cl_ulong a, b, high, low, sum, carry, left, right, arithmetic_right;
};
constexpr Row rows[] = {
    {0x0, 0x0, 0x0, 0x0, 0x0, 0x0, 0x0, 0x0, 0x0},
    {0x1, 0xFFFFFFFFFFFFFFFF, 0x0, 0xFFFFFFFFFFFFFFFF, 0x0, 0x1, 0x8000000000000000, 0x0, 0x0},
    {0xFFFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFE, 0x1, 0xFFFFFFFFFFFFFFFE, 0x1, 0x8000000000000000, 0x1,
     0xFFFFFFFFFFFFFFFF},
    {0x8000000000000000, 0x8000000000000000, 0x4000000000000000, 0x0, 0x0, 0x1, 0x8000000000000000, 0x8000000000000000,
     0x8000000000000000},
    {0x7FFFFFFFFFFFFFFF, 0x8000000000000001, 0x3FFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF, 0x0, 0x1, 0xFFFFFFFFFFFFFFFE,
     0x3FFFFFFFFFFFFFFF, 0x3FFFFFFFFFFFFFFF},
    {0xFFFFFFFF, 0xFFFFFFFF, 0x0, 0xFFFFFFFE00000001, 0x1FFFFFFFE, 0x0, 0x8000000000000000, 0x0, 0x0},
    {0x100000000, 0xFFFFFFFF00000000, 0xFFFFFFFF, 0x0, 0x0, 0x1, 0x100000000, 0x100000000, 0x100000000},
    {0xFFFFFFFF00000001, 0x1FFFFFFFF, 0x1FFFFFFFD, 0x2FFFFFFFF, 0x100000000, 0x1, 0x8000000000000000, 0x1,
     0xFFFFFFFFFFFFFFFF},
    {0x3FFFFFFF00000001, 0x7FFFFFFE00000002, 0x1FFFFFFF00000002, 0xFFFFFFFC00000002, 0xBFFFFFFD00000003, 0x0,
     0xFFFFFFFC00000004, 0xFFFFFFFC0000000, 0xFFFFFFFC0000000},
    {0xC0000000FFFFFFFF, 0x3FFFFFFF00000001, 0x2FFFFFFF7FFFFFFF, 0x80000001FFFFFFFF, 0x0, 0x1, 0x80000001FFFFFFFE,
     0x600000007FFFFFFF, 0xE00000007FFFFFFF},
    {0xF2A74DE452E6B438, 0x6513270E269E0D37, 0x5FCE292AC345DCAF, 0xBE5A207711479008, 0x57BA74F27984C16F, 0x1,
     0x1C00000000000000, 0x1E5, 0xFFFFFFFFFFFFFFE5},
    {0xC5C7FD0A6A3A450, 0xD23F0824128B2F33, 0xA26EC013EF0F719, 0x1FBC5CD115346BF0, 0xDE9B87F4B92ED383, 0x0,
     0x2280000000000000, 0x18B, 0x18B},
    {0x1818E811892F902B, 0x9531985D5D9DC9F8, 0xE0B2A2E33DA8F6E, 0x4B09E6DD47A46CA8, 0xAD4A806EE6CD5A23, 0x0,
     0x2B00000000000000, 0x18, 0x18},
    {0xE8E25D940ED90475, 0x36F675CC81E74EF5, 0x31FFF46CA6BBC57D, 0xDFA272864F9FE9F9, 0x1FD8D36090C0536A, 0x1,
     0x8EA0000000000000, 0x747, 0xFFFFFFFFFFFFFF47},
    {0x1600A35A099950D8, 0x6B0D549B6F03675A, 0x93369947F1C95F5, 0x737D1125A9F553F0, 0x810DF7F5789CB832, 0x0,
     0x6826654360000000, 0x58028D682, 0x58028D682},
    {0x3D9C172411E20B8F, 0x8D116ECE1738F7D9, 0x21F32AC712618AF5, 0x2D7E6262A20AC537, 0xCAAD85F2291B0368, 0x0,
     0x4823C4171E000000, 0x1ECE0B9208, 0x1ECE0B9208},
};
constexpr std::size_t row_count = sizeof rows / sizeof rows[0];

constexpr cl_uint numbers = 1024;
constexpr std::array<cl_uint, 9> words_before = {0, GCDT_NONE, 0, 0, GCDT_NONE, 0, 0, GCDT_NONE, 0};
constexpr cl_uint sum_below_numbers = numbers * (numbers - 1) / 2;

constexpr char mul_hi[] = "mul_hi";

// The first operation that goes wrong, or nothing.
std::string first_wrong_word(Runtime& runtime) {
  std::array<cl_ulong, 2 * row_count> operands;
  for (std::size_t i = 0; i < row_count; ++i) operands[2 * i] = rows[i].a, operands[2 * i + 1] = rows[i].b;
  const auto in = runtime.allocate<cl_ulong>("self-test", operands.size());
  const auto out = runtime.allocate<cl_ulong>("self-test", 8 * row_count);
  runtime.write(in, operands.data(), operands.size());
  runtime.launch("selftest", "selftest_words", over(row_count), static_cast<cl_uint>(row_count), in, out);
  std::array<cl_ulong, 8 * row_count> results;
  runtime.read(out, results.data(), results.size());
  // mul_hi comes last: the others have no way around.
  const char* names[] = {
      "64-bit multiplication",    "32-bit products in 64 bits", "64-bit addition",         "carry of a 64-bit addition",
      "64-bit shift to the left", "64-bit shift to the right",  "64-bit arithmetic shift", mul_hi};
  constexpr std::size_t columns[] = {1, 2, 3, 4, 5, 6, 7, 0};
  for (std::size_t k = 0; k < 8; ++k)
    for (std::size_t i = 0; i < row_count; ++i) {
      const Row& r = rows[i];
      const cl_ulong wanted[] = {r.high, r.low, r.high, r.sum, r.carry, r.left, r.right, r.arithmetic_right};
      if (results[8 * i + columns[k]] != wanted[columns[k]]) return names[k];
    }
  return {};
}

std::string first_wrong_atomic(Runtime& runtime) {
  const auto buffer = runtime.allocate<cl_uint>("self-test", words_before.size());
  runtime.write(buffer, words_before.data(), words_before.size());
  runtime.launch("selftest", "selftest_atomics", over(numbers), numbers, buffer);
  std::array<cl_uint, words_before.size()> words;
  runtime.read(buffer, words.data(), words.size());
  if (words[0] != sum_below_numbers) return "atomic_add";
  if (words[1] != 5) return "atomic_min";
  if (words[2] != numbers + 4) return "atomic_max";
  if (words[3] != 0xFFFFFFFFu) return "atomic_or";
  if (words[4] != 0) return "atomic_and";
  if (words[5] != numbers) return "atomic_inc";
  if (words[6] != sum_below_numbers) return "the old value of atomic_inc";
  if (words[7] >= numbers || words[8] != 1) return "atomic_cmpxchg";
  return {};
}

}  // namespace

// The verdict holds for a device, driver and library version, and is kept beside the programs.
void Runtime::self_test() {
  constexpr char right[] = "right", emulate[] = "emulate mul_hi";
  const std::string entry = cache::entry("selftest", cache_parts("selftest"));
  const auto known = cache::load(entry);
  if (known == std::string(right)) return;
  if (known == std::string(emulate)) {
    emulate_mul_hi_ = true;
    return;
  }
  std::string wrong = first_wrong_word(*this);
  if (wrong == mul_hi) {
    log(GCDT_LOG_WARNING, info_.name + " computes mul_hi wrongly: emulated");
    emulate_mul_hi_ = true;
    programs_->clear();
    recent_ = {};
    kernels_.clear();
    wrong = first_wrong_word(*this);
  }
  if (wrong.empty()) wrong = first_wrong_atomic(*this);
  if (!wrong.empty())
    throw Error(Status::device_failed, info_.name + " (driver " + info_.driver + ") computes wrongly: " + wrong);
  cache::store(entry, emulate_mul_hi_ ? emulate : right);
  // Statistics are about the caller's work.
  launches_ = read_backs_ = 0;
  memory_->trim();
  meter().restart_peaks();
}

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
// Scan, compaction and sort against the standard library, both walks, under several launch geometries.
#include <doctest/doctest.h>
#include <gcdt/gcdt.hpp>

#include <algorithm>
#include <numeric>
#include <random>

#include "kinds.hpp"
#include "mesh/primitives.hpp"
#include "sort/sizes.h"

using namespace gcdt;
using runtime::Buffer;
using runtime::Geometry;
using runtime::Runtime;

namespace {

using Words = std::vector<cl_uint>;

constexpr std::size_t sizes[] = {0, 1, 2, 63, 64, 65, 127, 128, 129, 1000, 1023, 1025, 4097, 20011};
constexpr std::size_t million = 1000000;
constexpr cl_uint guard = 0xDEADBEEFu;

Runtime& test_runtime() {
  const auto all = runtime::all_devices();
  static Runtime runtime(all.at(select_device("")));  // no device: throws, and the test fails
  return runtime;
}

// Sets a launch geometry for its life.
class Shaken {
 public:
  Shaken(Runtime& runtime, Geometry geometry) : geometry_(runtime.geometry()), before_(geometry_) {
    geometry_ = geometry;
  }
  ~Shaken() { geometry_ = before_; }

 private:
  Geometry& geometry_;
  Geometry before_;
};

const Geometry geometries[] = {{64, 128}, {64, 1}, {1, 3}, {7, 2}, {16, 5}, {128, 1000}, {1024, 2}};

template <class Test>
void for_all_walks_and_geometries(Test test) {
  for (Primitives::Walk walk : {Primitives::Walk::serial, Primitives::Walk::group})
    for (const Geometry& geometry : geometries) {
      CAPTURE(static_cast<int>(walk));
      CAPTURE(geometry.local);
      CAPTURE(geometry.max_groups);
      Shaken shaken(test_runtime(), geometry);
      Primitives primitives(test_runtime(), walk);
      test(primitives);
    }
}

Words random_words(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  Words words(count);
  for (auto& w : words) w = random();
  return words;
}

Words exclusive(const Words& in) {
  Words out(in.size() + 1, 0);
  std::partial_sum(in.begin(), in.end(), out.begin() + 1);
  return out;
}

// A buffer of `values` followed by guard words.
template <class T>
Buffer<T> guarded(const std::vector<T>& values) {
  std::vector<T> all = values;
  all.resize(values.size() + 16, static_cast<T>(guard));
  auto buffer = test_runtime().allocate<T>("test", all.size());
  test_runtime().write(buffer, all.data(), all.size());
  return buffer;
}

template <class T>
std::vector<T> contents(const Buffer<T>& buffer, std::size_t count) {
  std::vector<T> all(count);
  test_runtime().read(buffer, all.data(), count);
  return all;
}

template <class T>
std::vector<T> with_guards(std::vector<T> values, std::size_t count) {
  values.resize(count, static_cast<T>(guard));
  return values;
}

template <class Key>
void check_sort(Primitives& primitives, std::vector<Key> keys, unsigned bits, unsigned prefix = 0) {
  const std::size_t count = keys.size();
  Words values(count);
  std::iota(values.begin(), values.end(), 7u);
  const Key mask = bits >= sizeof(Key) * 8 ? ~Key{0} : static_cast<Key>((Key{1} << bits) - 1);
  Words order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](cl_uint a, cl_uint b) { return (keys[a] & mask) < (keys[b] & mask); });
  std::vector<Key> keys_wanted(count);
  Words values_wanted(count);
  for (std::size_t i = 0; i < count; ++i) {
    keys_wanted[i] = keys[order[i]];
    values_wanted[i] = values[order[i]];
  }
  auto key_buffer = guarded(keys);
  auto value_buffer = guarded(values);
  const std::size_t capacity = key_buffer.size();
  if constexpr (sizeof(Key) == 8)
    prefix != 0 ? primitives.sort_by_prefix(key_buffer, value_buffer, count, bits, prefix)
                : primitives.sort(key_buffer, value_buffer, count, bits);
  else
    primitives.sort(key_buffer, value_buffer, count, bits);
  CHECK(contents(key_buffer, count) == keys_wanted);
  CHECK(contents(value_buffer, count) == values_wanted);
  CHECK(key_buffer.size() == capacity);
  CHECK(value_buffer.size() == capacity);
}

std::vector<cl_ulong> random_keys(std::size_t count, std::uint64_t seed, cl_ulong mask) {
  std::mt19937_64 random(seed);
  std::vector<cl_ulong> keys(count);
  for (auto& k : keys) k = random() & mask;
  return keys;
}

}  // namespace

TEST_CASE("a scan equals the standard library's, leaves its input and writes count + 1 words") {
  for_all_walks_and_geometries([](Primitives& primitives) {
    for (std::size_t count : sizes) {
      CAPTURE(count);
      const Words in = random_words(count, 1);
      const auto in_buffer = guarded(in);
      const auto out_buffer = guarded(Words(count + 1, 0));
      primitives.exclusive_scan(in_buffer, out_buffer, count);
      CHECK(contents(out_buffer, count + 17) == with_guards(exclusive(in), count + 17));
      CHECK(contents(in_buffer, count + 16) == with_guards(in, count + 16));
    }
  });
}

TEST_CASE("a scan in place equals a scan from buffer to buffer") {
  for_all_walks_and_geometries([](Primitives& primitives) {
    for (std::size_t count : sizes) {
      CAPTURE(count);
      const Words in = random_words(count, 2);
      Words room = in;
      room.push_back(0);
      const auto buffer = guarded(room);
      primitives.exclusive_scan(buffer, buffer, count);
      CHECK(contents(buffer, count + 17) == with_guards(exclusive(in), count + 17));
    }
  });
}

TEST_CASE("a scan of a million words equals the standard library's") {
  for (Primitives::Walk walk : {Primitives::Walk::serial, Primitives::Walk::group}) {
    Primitives primitives(test_runtime(), walk);
    const Words in = random_words(million + 3, 3);
    const auto buffer = guarded(in);
    const auto out = guarded(Words(in.size() + 1, 0));
    primitives.exclusive_scan(buffer, out, in.size());
    CHECK(contents(out, in.size() + 17) == with_guards(exclusive(in), in.size() + 17));
  }
}

TEST_CASE("compaction lists the flagged indices, ascending, and writes nothing else") {
  for_all_walks_and_geometries([](Primitives& primitives) {
    for (std::size_t count : sizes)
      for (cl_uint one_in : {1u, 3u, 100u, 0u}) {
        CAPTURE(count);
        CAPTURE(one_in);
        Words flags(count), wanted;
        std::mt19937 random(4);
        for (std::size_t i = 0; i < count; ++i) {
          flags[i] = one_in != 0 && random() % one_in == 0;
          if (flags[i]) wanted.push_back(static_cast<cl_uint>(i));
        }
        const auto offsets = guarded(exclusive(flags));
        const auto out = guarded(Words(wanted.size(), 0));
        primitives.compact_indices(offsets, out, count);
        CHECK(contents(out, wanted.size() + 16) == with_guards(wanted, wanted.size() + 16));
      }
  });
}

TEST_CASE("a sort of 64-bit keys equals a stable sort by the low bits") {
  for_all_walks_and_geometries([](Primitives& primitives) {
    for (std::size_t count : sizes)
      for (unsigned bits : {0u, 1u, 5u, 62u}) {
        CAPTURE(count);
        CAPTURE(bits);
        check_sort(primitives, random_keys(count, count + bits, ~0ull), bits);
      }
  });
}

TEST_CASE("a sort of 32-bit keys equals a stable sort by the low bits") {
  for_all_walks_and_geometries([](Primitives& primitives) {
    for (std::size_t count : sizes)
      for (unsigned bits : {3u, 8u, 17u, 32u}) {
        CAPTURE(count);
        CAPTURE(bits);
        check_sort(primitives, random_words(count, static_cast<std::uint32_t>(count + bits)), bits);
      }
  });
}

TEST_CASE("64-bit keys come to one order, as blocks that are merged and by digits") {
  const std::uint32_t before = test_runtime().tuning().most_merged;
  for (const std::uint32_t most : {std::uint32_t{GCDT_SORT_SMALL}, before}) {
    CAPTURE(most);
    test_runtime().tuning().most_merged = most;
    for_all_walks_and_geometries([](Primitives& primitives) {
      for (const std::size_t count : {2047, 2048, 2049, 4096, 4097, 6145, 14337}) {
        CAPTURE(count);
        check_sort(primitives, random_keys(count, count, ~cl_ulong{0}), 64);
        check_sort(primitives, random_keys(count, count, 0xF00000000000000Fu), 64);  // many equal ones
        check_sort(primitives, random_keys(count, count, ~cl_ulong{0}), 37);
      }
    });
  }
  test_runtime().tuning().most_merged = before;
}

TEST_CASE("equal keys keep their order, sorted and reversed keys sort, and one object serves many sizes") {
  for (Primitives::Walk walk : {Primitives::Walk::serial, Primitives::Walk::group}) {
    Primitives primitives(test_runtime(), walk);
    for (std::size_t count : {std::size_t{50000}, std::size_t{777}, std::size_t{123456}}) {
      check_sort(primitives, std::vector<cl_ulong>(count, 0x123456789ABCDEF0ull), 64);
      check_sort(primitives, random_keys(count, 9, 0xF0F0ull), 16);
      std::vector<cl_ulong> keys(count);
      std::iota(keys.begin(), keys.end(), ~0ull - count);
      check_sort(primitives, keys, 64);
      std::reverse(keys.begin(), keys.end());
      check_sort(primitives, keys, 64);
    }
    primitives.release();
    check_sort(primitives, random_words(5000, 10), 32);
  }
}

TEST_CASE("a sort by prefix equals the sort, with short runs, long ones, and equal keys") {
  constexpr cl_ulong all = (1ull << 62) - 1;
  for_all_walks_and_geometries([](Primitives& primitives) {
    Tuning tuning = test_runtime().tuning();
    tuning.most_merged = GCDT_SORT_SMALL;  // or groups would merge blocks
    const test::Tuned tuned(test_runtime(), tuning);
    for (std::size_t count : {std::size_t{1000}, std::size_t{20000}}) {
      CAPTURE(count);
      check_sort(primitives, random_keys(count, 21, all), 62, 18);
      // about 20, then 1000 keys of each prefix, and runs of equal keys within them
      check_sort(primitives, random_keys(count, 22, all & ~(0xFFFull << 40)), 62, 22);
      check_sort(primitives, random_keys(count, 23, 0x3C0000000000000Full), 62, 20);
      std::vector<cl_ulong> steps(count);
      for (std::size_t i = 0; i < count; ++i) steps[i] = i / 100 << 30 | (i * 7919 % 100);
      check_sort(primitives, steps, 62, 32);
      std::sort(steps.begin(), steps.end());
      check_sort(primitives, steps, 62, 32);
      // the longest runs that work-items and a work-group sort, one longer each, and equal keys in all
      for (std::size_t run : {32u, 33u, 64u, 65u, 2048u, 2049u, 5000u}) {
        for (std::size_t i = 0; i < count; ++i) steps[i] = i / run << 30 | (i * 7919 % run / 2);
        check_sort(primitives, steps, 62, 32);
      }
      // long runs at both ends and in the middle, less than half of all, between short ones
      const std::size_t seventh = count / 7;
      for (std::size_t i = 0; i < count; ++i) {
        const bool in_long = i < seventh || i >= count - seventh || (i >= 3 * seventh && i < 4 * seventh);
        steps[i] = (in_long ? i / seventh * 4096 : i / seventh * 4096 + 1 + i / 3) << 30 | (i * 7919 % seventh / 2);
      }
      check_sort(primitives, steps, 62, 32);
      std::shuffle(steps.begin(), steps.end(), std::mt19937(24));
      check_sort(primitives, steps, 62, 32);
    }
  });
}

TEST_CASE("an order by buckets puts the kept values in order, however many a bucket has") {
  for_all_walks_and_geometries([](Primitives& primitives) {
    for (std::size_t count : {1000u, 16384u, 20000u, 60000u})
      for (std::size_t in_a_bucket : {1u, 3u, 40u, 2048u, 3000u, 16384u, 16385u, 0u}) {  // 0: a long one, many of two
        CAPTURE(count);
        CAPTURE(in_a_bucket);
        const unsigned low = in_a_bucket % 2 == 0 ? 16 : 17;  // an even and an odd number of digits
        const std::size_t begin = count / 3, end = begin + std::min<std::size_t>(begin, count > 50000 ? 18000 : 4000);
        const auto bucket_of = [&](std::size_t i) {
          return in_a_bucket != 0 ? i / in_a_bucket : i < begin ? i / 2 : i < end ? begin : i / 2 + begin;
        };
        const std::size_t buckets = in_a_bucket != 0 ? std::max<std::size_t>(count / in_a_bucket / 2, 1)
                                                     : bucket_of(5 * count / 6);  // the other pairs are left out
        std::vector<std::pair<cl_ulong, cl_uint>> pairs(count);
        for (std::size_t i = 0; i < count; ++i)
          pairs[i] = {cl_ulong{bucket_of(i)} << low | (i * 2311 % 65536) << (low - 16), static_cast<cl_uint>(i)};
        std::shuffle(pairs.begin(), pairs.end(), std::mt19937(31));
        std::vector<cl_ulong> keys;
        Words values;
        for (const auto& [key, value] : pairs) keys.push_back(key), values.push_back(value);
        std::sort(pairs.begin(), pairs.end());
        Words values_wanted;
        for (const auto& [key, value] : pairs)
          if (key >> low < buckets) values_wanted.push_back(value);
        auto key_buffer = guarded(keys);
        auto value_buffer = guarded(values);
        const std::size_t kept = values_wanted.size();
        primitives.order_by_buckets(key_buffer, value_buffer, count, kept, 62, low, buckets);
        CHECK(contents(value_buffer, kept) == values_wanted);
      }
  });
}

TEST_CASE("segments are sorted where they stand") {
  for (const Geometry& geometry : geometries) {
    CAPTURE(geometry.local);
    CAPTURE(geometry.max_groups);
    Shaken shaken(test_runtime(), geometry);
    Primitives primitives(test_runtime(), Primitives::Walk::group);
    Words first = {5};  // a few pairs stand before the first segment
    for (cl_uint size : {0u, 1u, 2u, 3u, 0u, 64u, 65u, 1000u, 2047u, 2048u, 0u}) first.push_back(first.back() + size);
    const std::size_t count = first.back();
    const std::vector<cl_ulong> keys = random_keys(count, 41, 0xF00000000000000Full);  // many are equal
    Words values(count);
    std::iota(values.begin(), values.end(), 7u);
    Words order(count);
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t s = 0; s + 1 < first.size(); ++s)
      std::stable_sort(order.begin() + first[s], order.begin() + first[s + 1],
                       [&](cl_uint a, cl_uint b) { return keys[a] < keys[b]; });
    std::vector<cl_ulong> keys_wanted;
    Words values_wanted;
    for (cl_uint i : order) keys_wanted.push_back(keys[i]), values_wanted.push_back(values[i]);
    const auto key_buffer = guarded(keys);
    const auto value_buffer = guarded(values);
    primitives.sort_segments(key_buffer, value_buffer, guarded(first), first.size() - 1);
    CHECK(contents(key_buffer, count + 16) == with_guards(keys_wanted, count + 16));
    CHECK(contents(value_buffer, count + 16) == with_guards(values_wanted, count + 16));
  }
}

TEST_CASE("few keys sort by their low bits, equal ones in order") {
  for_all_walks_and_geometries([](Primitives& primitives) {
    for (std::size_t count : {2u, 3u, 1023u, 1024u, 1025u, 2048u, 2049u}) {
      CAPTURE(count);
      check_sort(primitives, random_keys(count, count, 0xFFull), 64);
      check_sort(primitives, random_keys(count, count, ~0ull), 64);
      check_sort(primitives, random_keys(count, count, ~0ull), 7);
    }
  });
}

TEST_CASE("a million 64-bit keys sort by 62 bits") {
  for (Primitives::Walk walk : {Primitives::Walk::serial, Primitives::Walk::group}) {
    Primitives primitives(test_runtime(), walk);
    check_sort(primitives, random_keys(million, 11, (1ull << 62) - 1), 62);
    check_sort(primitives, random_words(million + 1, 12), 29);
  }
}

TEST_CASE("a sort beyond `count` touches nothing: later elements are not mixed in") {
  Primitives primitives(test_runtime());
  const auto keys = random_keys(10000, 13, ~0ull);
  auto key_buffer = guarded(keys);
  auto value_buffer = guarded(Words(keys.size(), 1u));
  primitives.sort(key_buffer, value_buffer, 6000);
  std::vector<cl_ulong> wanted(keys.begin(), keys.begin() + 6000);
  std::sort(wanted.begin(), wanted.end());
  CHECK(contents(key_buffer, 6000) == wanted);
}

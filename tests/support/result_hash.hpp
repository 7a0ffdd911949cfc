// SPDX-License-Identifier: Apache-2.0
// A hash of everything a result holds but its statistics: equal results, equal hashes.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include <gcdt/gcdt.hpp>

namespace gcdt::test {

/// FNV-1a, 64 bits, over the numbers' bytes, least significant first, whatever the machine's order.
class Hash {
 public:
  template <class Integer>
  void add(Integer value) {
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      state_ ^= static_cast<std::uint64_t>(value) >> (8 * i) & 0xff;
      state_ *= 0x100000001b3u;
    }
  }
  void add(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  template <class T, class Allocator>
  void add(const std::vector<T, Allocator>& values) {
    add(static_cast<std::uint64_t>(values.size()));
    for (const T& value : values) add(value);
  }
  template <class T, std::size_t N>
  void add(const std::array<T, N>& values) {
    for (const T& value : values) add(value);
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// Arrays that only some options give count where they are not empty, so that plain results have the hashes of always.
inline std::uint64_t result_hash(const Triangulation& result) {
  Hash hash;
  hash.add(result.triangles);
  hash.add(result.neighbours);
  hash.add(result.constrained);
  hash.add(result.representative);
  hash.add(result.pieces);
  hash.add(result.source_offsets);
  hash.add(result.sources);
  hash.add(result.dropped);
  const auto add_if_any = [&](const auto& values) {
    if (!values.empty()) hash.add(values);
  };
  add_if_any(result.region);
  add_if_any(result.depth);
  add_if_any(result.winding);
  add_if_any(result.region_seed);
  add_if_any(result.added_on_grid);
  add_if_any(result.added);
  add_if_any(result.added_crossing);
  add_if_any(result.added_origin);
  return hash.value();
}

}  // namespace gcdt::test

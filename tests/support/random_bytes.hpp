// SPDX-License-Identifier: Apache-2.0
// Bytes to be copied.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

namespace gcdt::test {

inline std::vector<unsigned char> random_bytes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<unsigned char> made(count);
  for (unsigned char& byte : made) byte = static_cast<unsigned char>(random());
  return made;
}

}  // namespace gcdt::test

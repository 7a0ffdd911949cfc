// SPDX-License-Identifier: Apache-2.0
// How many threads there are, where the system tells.
#pragma once

#ifdef __linux__

#include <cstddef>
#include <filesystem>
#include <iterator>

namespace gcdt::test {

/// Threads of this process, those that have just ended included.
inline std::size_t threads_here() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

}  // namespace gcdt::test

#endif

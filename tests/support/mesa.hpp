// SPDX-License-Identifier: Apache-2.0
// A second vendor on any CPU: Mesa's software device.
#pragma once

#include <cstdlib>

namespace gcdt::test {

/// Mesa's rusticl hides that device unless it is asked for before anything lists devices.
inline void ask_for_mesa() {
#ifndef _WIN32
  setenv("RUSTICL_ENABLE", "swrast", 0);
#endif
}

}  // namespace gcdt::test

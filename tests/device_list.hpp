// SPDX-License-Identifier: Apache-2.0
// The OpenCL devices that tests run on.
#pragma once

#include <cstdlib>
#include <vector>

#include "opencl.hpp"

namespace gcdt::test {

/// All devices, Mesa's software one included where it is installed: rusticl hides it unless asked,
/// and it is a second vendor on any CPU. To be called before anything else lists devices.
inline std::vector<cl::Device> every_device() {
#ifndef _WIN32
  setenv("RUSTICL_ENABLE", "swrast", 0);
#endif
  return runtime::all_devices();
}

}  // namespace gcdt::test

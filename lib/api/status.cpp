// SPDX-License-Identifier: Apache-2.0
// The C interface: sentences for statuses.
#include <gcdt/statuses.hpp>

const char* gcdt_strerror(int32_t status) {
  const char* sentence =
      status < 0 && status > -20000 ? "an OpenCL call failed; its code is the status" : "unknown status";
  gcdt::detail::row_of(status, [&](const auto& row) { sentence = row.sentence; });
  return sentence;
}

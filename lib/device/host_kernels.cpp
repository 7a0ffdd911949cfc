// SPDX-License-Identifier: Apache-2.0
#include "device/host_kernels.hpp"

namespace gcdt::runtime {

#ifdef GCDT_HOST_KERNELS

// Generated. The last of each has no name.
#define GCDT_HOST_PROGRAMS(program)                                                                                  \
  program(core) program(constraints) program(flips) program(enforce) program(holes) program(crossings) program(fans) \
      program(select) program(split) program(route) program(given) program(check_faults) program(domain)             \
          program(regions) program(sort32_serial)
#define GCDT_DECLARE(program) extern const HostKernel host_kernels_of_##program[];
#define GCDT_NAMED(program) {#program, host_kernels_of_##program},
GCDT_HOST_PROGRAMS(GCDT_DECLARE)

namespace {
struct HostProgram {
  const char* name;
  const HostKernel* kernels;
};
const HostProgram host_programs[] = {GCDT_HOST_PROGRAMS(GCDT_NAMED)};
}  // namespace

const HostKernel* find_host_kernel(const char* program, const char* kernel) {
  for (const HostProgram& candidate : host_programs)
    if (std::strcmp(candidate.name, program) == 0)
      for (const HostKernel* k = candidate.kernels; k->name; ++k)
        if (std::strcmp(k->name, kernel) == 0) return k;
  return nullptr;
}

#else

const HostKernel* find_host_kernel(const char*, const char*) { return nullptr; }

#endif

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
#include "device/host_kernels.hpp"

namespace gcdt::runtime {

#ifdef GCDT_HOST_KERNELS

// The kernels of each program are generated (kernels/host.cmake), and so is the list of programs. The last kernel of
// each has no name.
#define PROGRAM(name) extern const HostKernel host_kernels_of_##name[];
#include <host_programs.def>
#undef PROGRAM

namespace {
struct HostProgram {
  const char* name;
  const HostKernel* kernels;
};
const HostProgram host_programs[] = {
#define PROGRAM(name) {#name, host_kernels_of_##name},
#include <host_programs.def>
#undef PROGRAM
};
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

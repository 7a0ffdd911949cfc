// SPDX-License-Identifier: Apache-2.0
// Builds the embedded programs.
#include <cstring>

#include "kernel_sources.hpp"
#include "opencl.hpp"

namespace gcdt::runtime {

std::string Runtime::build_options() const { return "-cl-std=CL1.2"; }

cl::Program build_program(Runtime& runtime, const char* name) {
  const KernelSource* found = nullptr;
  for (std::size_t i = 0; i < kernel_source_count; ++i)
    if (std::strcmp(kernel_sources[i].program, name) == 0) found = &kernel_sources[i];
  if (!found) throw Error(Status::device_failed, std::string("no program is named ") + name);
  cl::Program program(runtime.context(), std::string(found->text));
  try {
    runtime.call("clBuildProgram", name, [&] { return program.build({runtime.device()}, runtime.build_options().c_str()); });
  } catch (const Error& error) {
    std::string log;
    program.getBuildInfo(runtime.device(), CL_PROGRAM_BUILD_LOG, &log);
    throw Error(Status::device_failed, std::string(error.what()) + "\n" + log);
  }
  return program;
}

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
// Builds the embedded programs, or takes them built from the cache.
#include <algorithm>
#include <cstring>

#include "device/cache.hpp"
#include "device/runtime.hpp"

namespace gcdt::runtime {

Meshes Runtime::meshes_of(const char* program) const {
  return info_of(program).differs_for_many ? meshes_ : Meshes::one;
}

std::string Runtime::build_options(const char* program) const {
  std::string options = "-cl-std=CL1.2";
  if (kind_ == DeviceKind::gpu) options += " -DGCDT_GPU";
  if (contiguous()) options += " -DGCDT_CONTIGUOUS";
  if (meshes_of(program) == Meshes::many) options += " -DGCDT_FOREST";
  if (emulate_mul_hi_) options += " -DGCDT_EMULATE_MUL_HI";
  if (states_one_group()) options += " -DGCDT_ONE_GROUP=" + std::to_string(geometry_.single);
  if (!hook_.options.empty()) options += " " + hook_.options;
  return options;
}

std::vector<std::string> Runtime::cache_parts(const char* program) const {
  return {source(program), build_options(program), info_.name,     info_.vendor,
          info_.driver,    info_.version,          info_.platform, GCDT_VERSION};
}

// PoCL compiles kernels as they are launched, and keeps them in a cache of its own. Its binary of a program would have
// every kernel compiled once more, in a form that launches do not use (bench/NOTES.md).
bool Runtime::keeps_programs() const { return hook_.keep_programs || info_.platform != pocl_platform; }

std::string Runtime::source(const char* program) const {
  for (std::size_t i = 0; i < kernel_source_count; ++i)
    if (std::strcmp(kernel_sources[i].program, program) == 0) {
      std::string text = kernel_sources[i].text;
      if (hook_.edit) hook_.edit(text);
      return text;
    }
  throw Error(Status::device_failed, std::string("no program is named ") + program);
}

namespace {

cl::Program build_source(Runtime& runtime, const char* name) {
  cl::Program program;
  runtime.call("clCreateProgramWithSource", name, [&] {
    cl_int code;
    program = cl::Program(runtime.context(), runtime.source(name), false, &code);
    return code;
  });
  try {
    runtime.call("clBuildProgram", name,
                 [&] { return program.build({runtime.device()}, runtime.build_options(name).c_str()); });
  } catch (const Error& error) {
    std::string log;
    program.getBuildInfo(runtime.device(), CL_PROGRAM_BUILD_LOG, &log);
    throw Error(Status::device_failed, std::string(error.what()) + "\n" + log);
  }
  return program;
}

// The program from its binary, if the driver takes it.
std::optional<cl::Program> build_binary(Runtime& runtime, const char* name, const std::string& binary) {
  cl::Program program;
  const cl_int made = runtime.attempt("clCreateProgramWithBinary", name, [&] {
    cl_int code, status = CL_SUCCESS;
    const cl_device_id device = runtime.device()();
    const std::size_t size = binary.size();
    const auto* bytes = reinterpret_cast<const unsigned char*>(binary.data());
    program = cl::Program(clCreateProgramWithBinary(runtime.context()(), 1, &device, &size, &bytes, &status, &code));
    return code != CL_SUCCESS ? code : status;
  });
  if (made != CL_SUCCESS) return std::nullopt;
  const cl_int built = runtime.attempt(
      "clBuildProgram", name, [&] { return program.build({runtime.device()}, runtime.build_options(name).c_str()); });
  if (built != CL_SUCCESS) return std::nullopt;
  return program;
}

// Of the runtime's device: the context may have more. Empty if the driver gives none.
std::string binary_of(Runtime& runtime, const char* name, const cl::Program& program) {
  std::vector<cl::Device> devices;
  std::vector<std::vector<unsigned char>> binaries;  // by device
  const cl_int got = runtime.attempt("clGetProgramInfo", name, [&] {
    const cl_int listed = program.getInfo(CL_PROGRAM_DEVICES, &devices);
    return listed != CL_SUCCESS ? listed : program.getInfo(CL_PROGRAM_BINARIES, &binaries);
  });
  if (got != CL_SUCCESS) return {};
  for (std::size_t i = 0; i < std::min(devices.size(), binaries.size()); ++i)
    if (devices[i]() == runtime.device()()) return {binaries[i].begin(), binaries[i].end()};
  return {};
}

}  // namespace

cl::Program build_program(Runtime& runtime, const char* name) {
  if (!runtime.keeps_programs()) return build_source(runtime, name);
  const std::string entry = cache::entry("program", runtime.cache_parts(name));
  if (const auto binary = cache::load(entry)) {
    if (auto program = build_binary(runtime, name, *binary)) return *program;
    cache::remove(entry);  // whole, but not for this driver
  }
  const cl::Program program = build_source(runtime, name);
  if (cache::folder().empty()) return program;  // asking for the binary may compile kernels never used
  const std::string binary = binary_of(runtime, name, program);
  if (!binary.empty()) cache::store(entry, binary);
  return program;
}

}  // namespace gcdt::runtime

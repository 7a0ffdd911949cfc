// SPDX-License-Identifier: Apache-2.0
// An OpenCL layer for tests, which make the same objects again and again, below the layers that watch or change calls:
// a context that nobody holds any more serves whoever makes one for the same device, and a program that is built in a
// context where the same has been built stands for that one. Every call is made and answered, but compilers and caches
// of drivers do their work once in a process.
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "layer.hpp"

namespace {

/// A program that somebody holds.
struct Made {
  cl_context context;
  std::string text;  ///< its source or binary
  cl_program built;  ///< what it stands for: itself at first
  int references;
};

/// What is built of one text with the same options in one context. Who builds it holds `mutex`, so that others wait.
struct Built {
  std::mutex mutex;
  cl_program program = nullptr;  ///< held for good, or not built yet
};

/// All members are guarded by `mutex`, but for what is in a Built; those stay where they are.
struct Kept {
  std::mutex mutex;
  std::map<cl_context, std::pair<cl_device_id, int>> contexts;  ///< those held, with the number of references
  std::map<cl_device_id, std::vector<cl_context>> free;
  std::map<cl_program, Made> programs;
  std::map<std::tuple<cl_context, std::string, std::string>, Built> built;  ///< by text and options
};
Kept& kept() {
  static auto* const all = new Kept;  // for good: calls may come from destructors of statics
  return *all;
}

cl_context CL_API_CALL create_context(const cl_context_properties* properties, cl_uint devices,
                                      const cl_device_id* device,
                                      void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*), void* user,
                                      cl_int* code) {
  if (properties || notify || devices != 1)
    return next->clCreateContext(properties, devices, device, notify, user, code);
  const std::lock_guard<std::mutex> lock(kept().mutex);
  auto& free = kept().free[*device];
  cl_context context = nullptr;
  if (free.empty()) {
    context = next->clCreateContext(properties, devices, device, notify, user, code);
  } else {
    context = free.back();
    free.pop_back();
    if (code) *code = CL_SUCCESS;
  }
  if (context) kept().contexts[context] = {*device, 1};
  return context;
}

cl_int CL_API_CALL retain_context(cl_context context) {
  const std::lock_guard<std::mutex> lock(kept().mutex);
  const auto found = kept().contexts.find(context);
  if (found == kept().contexts.end()) return next->clRetainContext(context);
  ++found->second.second;
  return CL_SUCCESS;
}

cl_int CL_API_CALL release_context(cl_context context) {
  const std::lock_guard<std::mutex> lock(kept().mutex);
  const auto found = kept().contexts.find(context);
  if (found == kept().contexts.end()) return next->clReleaseContext(context);
  if (--found->second.second > 0) return CL_SUCCESS;
  kept().free[found->second.first].push_back(context);
  kept().contexts.erase(found);
  return CL_SUCCESS;
}

cl_program keep(cl_program program, cl_context context, std::string text) {
  if (!program) return program;
  const std::lock_guard<std::mutex> lock(kept().mutex);
  kept().programs[program] = {context, std::move(text), program, 1};
  return program;
}

cl_program CL_API_CALL create_program_with_source(cl_context context, cl_uint count, const char** texts,
                                                  const size_t* lengths, cl_int* code) {
  const cl_program program = next->clCreateProgramWithSource(context, count, texts, lengths, code);
  std::string all = "source ";
  for (cl_uint i = 0; program && i < count; ++i)
    all += lengths && lengths[i] > 0 ? std::string(texts[i], lengths[i]) : std::string(texts[i]);
  return keep(program, context, std::move(all));
}

cl_program CL_API_CALL create_program_with_binary(cl_context context, cl_uint devices, const cl_device_id* device,
                                                  const size_t* lengths, const unsigned char** binaries,
                                                  cl_int* statuses, cl_int* code) {
  const cl_program program =
      next->clCreateProgramWithBinary(context, devices, device, lengths, binaries, statuses, code);
  if (devices != 1) return program;
  return keep(program, context, "binary " + std::string(reinterpret_cast<const char*>(binaries[0]), lengths[0]));
}

cl_program behind(cl_program program) {
  const std::lock_guard<std::mutex> lock(kept().mutex);
  const auto found = kept().programs.find(program);
  return found == kept().programs.end() ? program : found->second.built;
}

cl_int CL_API_CALL build_program(cl_program program, cl_uint devices, const cl_device_id* device, const char* options,
                                 void(CL_CALLBACK* notify)(cl_program, void*), void* user) {
  std::unique_lock<std::mutex> lock(kept().mutex);
  const auto found = kept().programs.find(program);
  if (notify || devices != 1 || found == kept().programs.end()) {
    lock.unlock();
    return next->clBuildProgram(program, devices, device, options, notify, user);
  }
  Built& same = kept().built[{found->second.context, found->second.text, options ? options : ""}];
  lock.unlock();
  const std::lock_guard<std::mutex> building(same.mutex);
  if (!same.program) {
    const cl_int code = next->clBuildProgram(program, devices, device, options, notify, user);
    if (code != CL_SUCCESS) return code;
    next->clRetainProgram(program);
    same.program = program;
  }
  lock.lock();
  kept().programs.at(program).built = same.program;  // who builds a program holds it
  return CL_SUCCESS;
}

cl_int CL_API_CALL retain_program(cl_program program) {
  const std::lock_guard<std::mutex> lock(kept().mutex);
  const auto found = kept().programs.find(program);
  if (found != kept().programs.end()) ++found->second.references;
  return next->clRetainProgram(program);
}

cl_int CL_API_CALL release_program(cl_program program) {
  const std::lock_guard<std::mutex> lock(kept().mutex);
  const auto found = kept().programs.find(program);
  if (found != kept().programs.end() && --found->second.references == 0) kept().programs.erase(found);
  return next->clReleaseProgram(program);
}

cl_kernel CL_API_CALL create_kernel(cl_program program, const char* name, cl_int* code) {
  return next->clCreateKernel(behind(program), name, code);
}

cl_int CL_API_CALL get_program_info(cl_program program, cl_program_info what, size_t size, void* value,
                                    size_t* needed) {
  return next->clGetProgramInfo(behind(program), what, size, value, needed);
}

cl_int CL_API_CALL get_program_build_info(cl_program program, cl_device_id device, cl_program_build_info what,
                                          size_t size, void* value, size_t* needed) {
  return next->clGetProgramBuildInfo(behind(program), device, what, size, value, needed);
}

void replace(cl_icd_dispatch& functions) {
  functions.clCreateContext = create_context;
  functions.clRetainContext = retain_context;
  functions.clReleaseContext = release_context;
  functions.clCreateProgramWithSource = create_program_with_source;
  functions.clCreateProgramWithBinary = create_program_with_binary;
  functions.clBuildProgram = build_program;
  functions.clRetainProgram = retain_program;
  functions.clReleaseProgram = release_program;
  functions.clCreateKernel = create_kernel;
  functions.clGetProgramInfo = get_program_info;
  functions.clGetProgramBuildInfo = get_program_build_info;
}

}  // namespace

// SPDX-License-Identifier: Apache-2.0
// An OpenCL layer that makes a call fail with an error that the specification documents for it, without making it, and
// counts the objects that are held. Programs say which call by call_layer.hpp.
#include "call_layer.hpp"

#include "layer.hpp"

extern "C" gcdt::test::Calls* gcdt_test_calls() {
  static auto* const all = new gcdt::test::Calls;  // for good: calls may come from destructors of statics
  return all;
}

namespace {

using gcdt::test::Kind;

/// Of a function: its name and its errors.
template <auto Function>
struct Documented;
#define GCDT_OPENCL_CALL(function, ...)               \
  template <>                                         \
  struct Documented<&cl_icd_dispatch::function> {     \
    static constexpr const char* name = #function;    \
    static constexpr cl_int errors[] = {__VA_ARGS__}; \
  };
#define GCDT_OPENCL_RELEASE GCDT_OPENCL_CALL
#define GCDT_OPENCL_RETAIN(function)
#include "opencl_calls.def"
#undef GCDT_OPENCL_CALL
#undef GCDT_OPENCL_RELEASE
#undef GCDT_OPENCL_RETAIN

template <auto Function>
bool fails(cl_int& code) {
  using Of = Documented<Function>;
  return gcdt_test_calls()->fails(Of::name, Of::errors, sizeof Of::errors / sizeof *Of::errors, code);
}

template <class Handle>
constexpr Kind kind_of() {
  if (std::is_same_v<Handle, cl_context>) return Kind::context;
  if (std::is_same_v<Handle, cl_command_queue>) return Kind::queue;
  if (std::is_same_v<Handle, cl_mem>) return Kind::memory;
  if (std::is_same_v<Handle, cl_program>) return Kind::program;
  if (std::is_same_v<Handle, cl_kernel>) return Kind::kernel;
  return Kind::event;
}

// What a call tells by its arguments: an error goes to a cl_int*, which is the last; an event comes from a cl_event*.
template <class Argument>
void tell_error(Argument argument, cl_int code) {
  if constexpr (std::is_same_v<Argument, cl_int*>)
    if (argument) *argument = code;
}
template <class Argument>
void count_event(Argument argument) {
  if constexpr (std::is_same_v<Argument, cl_event*>)
    if (argument) gcdt_test_calls()->made(*argument, Kind::event, 0);
}

std::uint64_t bytes_of(cl_context, cl_mem_flags, size_t size, void*, cl_int*) { return size; }
template <class... Arguments>
std::uint64_t bytes_of(Arguments...) {
  return 0;
}

/// A device that is lost has ended what it was at. Here it still works, and is waited for though that fails.
template <auto Function>
constexpr bool finishes = false;
template <>
constexpr bool finishes<&cl_icd_dispatch::clFinish> = true;

template <auto Function, class Pointer = decltype(Function)>
struct Call;
template <auto Function, class Return, class... Arguments>
struct Call<Function, Return (*cl_icd_dispatch::*)(Arguments...)> {
  static Return CL_API_CALL make(Arguments... arguments) {
    cl_int code = CL_SUCCESS;
    const bool fail = fails<Function>(code);
    if constexpr (finishes<Function>)
      if (fail) (next->*Function)(arguments...);
    if constexpr (std::is_same_v<Return, cl_int>) {
      if (fail) return code;
      code = (next->*Function)(arguments...);
      if (code == CL_SUCCESS) (count_event(arguments), ...);
      return code;
    } else {
      if (fail) return (tell_error(arguments, code), ...), nullptr;
      const Return made = (next->*Function)(arguments...);
      if (made) (count_event(arguments), ...);
      if constexpr (!std::is_same_v<Return, void*>)  // of a map, which is no object
        if (made) gcdt_test_calls()->made(made, kind_of<Return>(), bytes_of(arguments...));
      return made;
    }
  }
};

template <auto Function, class Pointer = decltype(Function)>
struct Reference;
template <auto Function, class Handle>
struct Reference<Function, cl_int (*cl_icd_dispatch::*)(Handle)> {
  static cl_int CL_API_CALL retain(Handle handle) {
    const cl_int code = (next->*Function)(handle);
    if (code == CL_SUCCESS) gcdt_test_calls()->retained(handle, 1);
    return code;
  }
  static cl_int CL_API_CALL release(Handle handle) {
    cl_int code = CL_SUCCESS;
    const bool fail = fails<Function>(code);
    gcdt_test_calls()->retained(handle, -1);  // before another object can have its address
    const cl_int done = (next->*Function)(handle);
    return fail ? code : done;
  }
};

void replace(cl_icd_dispatch& functions) {
#define GCDT_OPENCL_CALL(function, ...) functions.function = Call<&cl_icd_dispatch::function>::make;
#define GCDT_OPENCL_RETAIN(function) functions.function = Reference<&cl_icd_dispatch::function>::retain;
#define GCDT_OPENCL_RELEASE(function, ...) functions.function = Reference<&cl_icd_dispatch::function>::release;
#include "opencl_calls.def"
}

}  // namespace

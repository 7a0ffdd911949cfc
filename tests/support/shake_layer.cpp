// SPDX-License-Identifier: Apache-2.0
// An OpenCL layer that shakes schedules. Programs get a beginning in which groups and work-items exchange their numbers
// and some groups wait, by the offset of the launch; and while GCDT_SHAKE is set, each launch gets an offset of its
// own, else 1, which exchanges nothing: so shaken and usual launches are of the same programs, and of one compilation,
// as PoCL compiles launches without an offset by themselves.
//
// Why that is valid: numbers of groups, and of work-items in a group, are exchanged by bijections, which are the same
// for the whole launch; so each number is some work-item's once, those of a group stay together and meet at its
// barriers, and what is the same for a group stays so. No kernel may know more of its place than these numbers.
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "layer.hpp"

namespace {

// Without branches, and with its loop in a function of its own: PoCL 3.1 gives up ("Could not find a dominating
// alternative variable") where they come between the barriers of a kernel.
constexpr const char* beginning = R"(
// i, one of n, elsewhere: turned, riffled, mirrored and turned again, each a bijection of 0 .. n - 1. By 0 it stays.
static inline size_t shaken(size_t i, size_t n, size_t seed) {
  const size_t turned = (i + seed) % n;
  const size_t riffled = (turned & 1) * ((n + 1) / 2) + turned / 2;
  const size_t odd = seed >> 3 & 1, mirrored = odd * (n - 1) + riffled - odd * 2 * riffled;
  const size_t all = (mirrored + seed / 16) % n, shakes = seed != 0;
  return shakes * all + (1 - shakes) * i;
}
__attribute__((noinline)) void shaken_wait(uint rounds) {
  for (volatile uint left = rounds; left > 0u; left = left - 1u) {
  }
}
// One group in eight waits.
static inline size_t shaken_group(uint d) {
  const uint seed = (uint)get_global_offset(0) - 1u, own = (uint)get_group_id(0) + 1u;
  const uint hash = (seed ^ own * 2654435761u) * 2246822519u;
  shaken_wait((uint)(seed != 0u) * (uint)(hash >> 29 == 0u) * (hash & 1023u));
  return shaken(get_group_id(d), get_num_groups(d), seed);
}
static inline size_t shaken_local(uint d) {
  const size_t seed = get_global_offset(0) - 1;
  return shaken(get_local_id(d), get_local_size(d), (seed != 0) * (1 + seed / 3));
}
#define get_group_id(d) shaken_group(d)
#define get_local_id(d) shaken_local(d)
#define get_global_id(d) (get_group_id(d) * get_local_size(d) + get_local_id(d))
#line 1
)";

cl_program CL_API_CALL create_program(cl_context context, cl_uint count, const char** strings, const size_t* lengths,
                                      cl_int* code) {
  std::vector<const char*> all = {beginning};
  std::vector<size_t> sizes = {std::strlen(beginning)};
  for (cl_uint i = 0; i < count; ++i) {
    all.push_back(strings[i]);
    sizes.push_back(lengths && lengths[i] > 0 ? lengths[i] : std::strlen(strings[i]));
  }
  return next->clCreateProgramWithSource(context, count + 1, all.data(), sizes.data(), code);
}

/// A shaken launch's offset: above 1, another one each time, from the number that GCDT_SHAKE says.
size_t offset_of_launch(const char* seed) {
  static std::atomic<cl_uint> launches{0};
  cl_uint h = (static_cast<cl_uint>(std::atoi(seed)) * 2654435761u) ^ (launches++ * 2246822519u);
  h = (h ^ h >> 15) * 3266489917u;
  return 2 + (h >> 12);
}

cl_int CL_API_CALL enqueue(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
                           const size_t* global, const size_t* local, cl_uint waits, const cl_event* events,
                           cl_event* event) {
  if (dimensions != 1 || offset)
    return next->clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local, waits, events, event);
  const char* const seed = std::getenv("GCDT_SHAKE");
  const size_t shaken = seed ? offset_of_launch(seed) : 1;
  return next->clEnqueueNDRangeKernel(queue, kernel, dimensions, &shaken, global, local, waits, events, event);
}

void replace(cl_icd_dispatch& functions) {
  functions.clCreateProgramWithSource = create_program;
  functions.clEnqueueNDRangeKernel = enqueue;
}

}  // namespace

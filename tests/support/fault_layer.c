/* SPDX-License-Identifier: Apache-2.0 */
/* A layer of the OpenCL loader (OPENCL_LAYERS) for tests: drivers with faults, which environment variables choose at
 * each call, so that the library, its command and everything between are what users have.
 *   GCDT_FAULT_BUFFERS=N    buffers of N bytes and more cannot be made
 *   GCDT_FAULT_MEMORY=N     devices say that they have N bytes of memory
 *   GCDT_FAULT_FROM, _TO    this text in the source of a program is replaced, wherever it occurs; each time that there
 *                           was one, a character is appended to the file GCDT_FAULT_MATCHED
 */
#define CL_TARGET_OPENCL_VERSION 300
#include <CL/cl_layer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cl_icd_dispatch layer;
static const cl_icd_dispatch* next;

static const char* chosen(const char* name) {
  const char* value = getenv(name);
  return value && *value ? value : NULL;
}

static cl_mem CL_API_CALL create_buffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* code) {
  const char* least = chosen("GCDT_FAULT_BUFFERS");
  if (!least || size < strtoull(least, NULL, 10)) return next->clCreateBuffer(context, flags, size, host, code);
  if (code) *code = CL_MEM_OBJECT_ALLOCATION_FAILURE;
  return NULL;
}

static cl_int CL_API_CALL get_device_info(cl_device_id device, cl_device_info what, size_t size, void* value,
                                          size_t* size_ret) {
  const char* bytes = chosen("GCDT_FAULT_MEMORY");
  const cl_int code = next->clGetDeviceInfo(device, what, size, value, size_ret);
  if (bytes && value && code == CL_SUCCESS &&
      (what == CL_DEVICE_GLOBAL_MEM_SIZE || what == CL_DEVICE_MAX_MEM_ALLOC_SIZE))
    *(cl_ulong*)value = strtoull(bytes, NULL, 10);
  return code;
}

/* A copy of the text, which the caller frees. */
static char* edited(const char* text, size_t length, const char* from, const char* to) {
  const size_t from_length = strlen(from), to_length = strlen(to);
  char* copy = malloc(length * (to_length / from_length + 1) + to_length + 1);
  char* end = copy;
  const char* const last = text + length;
  int found = 0;
  while (copy && text < last) {
    if ((size_t)(last - text) >= from_length && memcmp(text, from, from_length) == 0) {
      memcpy(end, to, to_length);
      end += to_length, text += from_length, found = 1;
    } else {
      *end++ = *text++;
    }
  }
  if (copy) *end = '\0';
  if (found && chosen("GCDT_FAULT_MATCHED")) {
    FILE* file = fopen(chosen("GCDT_FAULT_MATCHED"), "a");
    if (file) {
      fputc('x', file);
      fclose(file);
    }
  }
  return copy;
}

static cl_program CL_API_CALL create_program(cl_context context, cl_uint count, const char** texts,
                                             const size_t* lengths, cl_int* code) {
  const char *from = chosen("GCDT_FAULT_FROM"), *to = chosen("GCDT_FAULT_TO");
  if (!from || !to || count != 1) return next->clCreateProgramWithSource(context, count, texts, lengths, code);
  char* text = edited(texts[0], lengths && lengths[0] ? lengths[0] : strlen(texts[0]), from, to);
  const char* one = text;
  const cl_program made = next->clCreateProgramWithSource(context, 1, &one, NULL, code);
  free(text);
  return made;
}

CL_API_ENTRY cl_int CL_API_CALL clGetLayerInfo(cl_layer_info what, size_t size, void* value, size_t* size_ret) {
  const cl_layer_api_version version = CL_LAYER_API_VERSION_100;
  if (what != CL_LAYER_API_VERSION) return CL_INVALID_VALUE;
  if (value && size < sizeof version) return CL_INVALID_VALUE;
  if (value) memcpy(value, &version, sizeof version);
  if (size_ret) *size_ret = sizeof version;
  return CL_SUCCESS;
}

CL_API_ENTRY cl_int CL_API_CALL clInitLayer(cl_uint count, const cl_icd_dispatch* target, cl_uint* count_ret,
                                            const cl_icd_dispatch** layer_ret) {
  const size_t members = sizeof layer / sizeof(void*);
  if (!target || !layer_ret || !count_ret || count < members) return CL_INVALID_VALUE;
  next = target;
  memcpy(&layer, target, sizeof layer);
  layer.clCreateBuffer = create_buffer;
  layer.clGetDeviceInfo = get_device_info;
  layer.clCreateProgramWithSource = create_program;
  *count_ret = (cl_uint)members;
  *layer_ret = &layer;
  return CL_SUCCESS;
}

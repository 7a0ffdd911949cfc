// SPDX-License-Identifier: Apache-2.0
// What every OpenCL layer of the tests says to the loader. A layer defines replace(), and is one source file.
#pragma once

#include <CL/cl_icd.h>
#include <CL/cl_layer.h>

#include <cstring>

namespace {

const cl_icd_dispatch* next = nullptr;  ///< the layer below, or the driver
cl_icd_dispatch ours;

/// Puts the layer's own functions in place of those of `next`.
void replace(cl_icd_dispatch& functions);

}  // namespace

CL_API_ENTRY cl_int CL_API_CALL clGetLayerInfo(cl_layer_info name, size_t size, void* value, size_t* needed) {
  if (name != CL_LAYER_API_VERSION) return CL_INVALID_VALUE;
  const cl_layer_api_version version = CL_LAYER_API_VERSION_100;
  if (value && size < sizeof version) return CL_INVALID_VALUE;
  if (value) std::memcpy(value, &version, sizeof version);
  if (needed) *needed = sizeof version;
  return CL_SUCCESS;
}

CL_API_ENTRY cl_int CL_API_CALL clInitLayer(cl_uint entries, const cl_icd_dispatch* target, cl_uint* our_entries,
                                            const cl_icd_dispatch** dispatch) {
  if (!target || !our_entries || !dispatch || entries < sizeof ours / sizeof ours.clGetPlatformIDs)
    return CL_INVALID_VALUE;
  next = target;
  ours = *target;
  replace(ours);
  *our_entries = sizeof ours / sizeof ours.clGetPlatformIDs;
  *dispatch = &ours;
  return CL_SUCCESS;
}

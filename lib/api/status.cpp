// SPDX-License-Identifier: Apache-2.0
// The C interface: sentences for statuses.
#include <gcdt/gcdt.h>

#include <cstdint>

namespace {

struct Sentence {
  std::int32_t status;
  const char* text;
};

constexpr Sentence sentences[] = {
    {GCDT_OK, "done"},
    {GCDT_ERROR_INVALID_ARGUMENT, "an argument makes no sense"},
    {GCDT_ERROR_STRUCT_SIZE, "a structure has a size that this version of the library does not know"},
    {GCDT_ERROR_COORDINATE_NOT_FINITE, "a coordinate is not a finite number"},
    {GCDT_ERROR_COORDINATE_OUTSIDE_GRID, "a vertex is outside the grid"},
    {GCDT_ERROR_INDEX_OUT_OF_RANGE, "an end of a constraint is no vertex"},
    {GCDT_ERROR_TOO_MANY_VERTICES, "there are more vertices than can be numbered"},
    {GCDT_ERROR_CONSTRAINTS_CROSS, "constraints cross"},
    {GCDT_ERROR_NO_DEVICE, "no OpenCL device fits"},
    {GCDT_ERROR_DEVICE_FAILED, "the OpenCL device failed"},
    {GCDT_ERROR_OUT_OF_MEMORY, "the device's memory or largest buffer is too small"},
    {GCDT_ERROR_ROUND_LIMIT, "a limit of rounds was reached"},
    {GCDT_ERROR_CHECK_FAILED, "the result failed its check and is withheld"},
    {GCDT_ERROR_CANCELLED, "cancelled by the caller"},
    {GCDT_ERROR_WORKSPACE_TOO_SMALL, "the workspace is too small"},
    {GCDT_ERROR_BUFFER_TOO_SMALL, "a buffer is too small"},
    {GCDT_ERROR_WRONG_CONTEXT, "a buffer or queue is of another context"},
    {GCDT_ERROR_BUFFER_ACCESS, "a buffer cannot be accessed that way"},
    {GCDT_ERROR_BUFFERS_OVERLAP, "ranges of device memory overlap"},
    {GCDT_ERROR_IN_USE, "the solver is in use"},
    {GCDT_ERROR_NOT_VALID, "the mesh is not the constrained Delaunay triangulation"},
    {GCDT_ERROR_HOST_MEMORY, "the host is out of memory"},
    {GCDT_ERROR_INTERNAL, "internal error"},
    {GCDT_ERROR_VERTICES_COINCIDE, "vertices that differ are one on the grid"},
    {-1, "OpenCL: device not found"},
    {-4, "OpenCL: memory object allocation failure"},
    {-5, "OpenCL: out of resources"},
    {-6, "OpenCL: out of host memory"},
    {-11, "OpenCL: build program failure"},
    {-14, "OpenCL: an event of the wait list failed"},
    {-34, "OpenCL: invalid context"},
    {-36, "OpenCL: invalid command queue"},
    {-38, "OpenCL: invalid memory object"},
    {-57, "OpenCL: invalid event wait list"},
    {-58, "OpenCL: invalid event"},
    {-61, "OpenCL: invalid buffer size"},
};

}  // namespace

const char* gcdt_strerror(int32_t status) {
  for (const Sentence& sentence : sentences)
    if (sentence.status == status) return sentence.text;
  return status < 0 && status > -20000 ? "an OpenCL call failed; its code is the status" : "unknown status";
}

// SPDX-License-Identifier: Apache-2.0
// The statuses, one row each, from which C, C++ and the command take what they know of them. Not part of the interface.
// To add one: its code in gcdt.h, its name in Status, its row here.
#pragma once

#include <gcdt/types.hpp>

namespace gcdt::detail {

/// A status of C++, its code in C, what the command ends with, and the sentence of gcdt_strerror.
struct StatusRow {
  Status status;
  std::int32_t code;
  int exit;  ///< docs/command.md
  const char* sentence;
};

inline constexpr StatusRow statuses[] = {
    {Status::ok, GCDT_OK, 0, "done"},
    {Status::invalid_argument, GCDT_ERROR_INVALID_ARGUMENT, 2, "an argument makes no sense"},
    {Status::coordinate_not_finite, GCDT_ERROR_COORDINATE_NOT_FINITE, 3, "a coordinate is not a finite number"},
    {Status::coordinate_outside_grid, GCDT_ERROR_COORDINATE_OUTSIDE_GRID, 3, "a vertex is outside the grid"},
    {Status::index_out_of_range, GCDT_ERROR_INDEX_OUT_OF_RANGE, 3, "an end of a constraint is no vertex"},
    {Status::too_many_vertices, GCDT_ERROR_TOO_MANY_VERTICES, 3, "there are more vertices than can be numbered"},
    {Status::constraints_cross, GCDT_ERROR_CONSTRAINTS_CROSS, 3, "constraints cross"},
    {Status::no_device, GCDT_ERROR_NO_DEVICE, 4, "no OpenCL device fits"},
    {Status::device_failed, GCDT_ERROR_DEVICE_FAILED, 4, "the OpenCL device failed"},
    {Status::out_of_memory, GCDT_ERROR_OUT_OF_MEMORY, 4, "the device's memory or largest buffer is too small"},
    {Status::round_limit, GCDT_ERROR_ROUND_LIMIT, 4, "a limit of rounds was reached"},
    {Status::check_failed, GCDT_ERROR_CHECK_FAILED, 5, "the result failed its check and is withheld"},
    {Status::cancelled, GCDT_ERROR_CANCELLED, 130, "cancelled by the caller"},
    {Status::workspace_too_small, GCDT_ERROR_WORKSPACE_TOO_SMALL, 4, "the workspace is too small"},
    {Status::buffer_too_small, GCDT_ERROR_BUFFER_TOO_SMALL, 4, "a buffer is too small"},
    {Status::wrong_context, GCDT_ERROR_WRONG_CONTEXT, 4, "a buffer or queue is of another context"},
    {Status::buffer_access, GCDT_ERROR_BUFFER_ACCESS, 4, "a buffer cannot be accessed that way"},
    {Status::buffers_overlap, GCDT_ERROR_BUFFERS_OVERLAP, 4, "ranges of device memory overlap"},
    {Status::in_use, GCDT_ERROR_IN_USE, 4, "the solver is in use"},
    {Status::vertices_coincide, GCDT_ERROR_VERTICES_COINCIDE, 3, "vertices that differ are one on the grid"},
    {Status::spill_failed, GCDT_ERROR_SPILL_FAILED, 6, "a file for what devices have no room for failed"},
};

/// Codes without a status of their own: what C++ throws for them. Other codes of OpenCL are device_failed.
struct CodeRow {
  Status status;
  std::int32_t code;
  const char* sentence;
};

inline constexpr CodeRow other_codes[] = {
    {Status::invalid_argument, GCDT_ERROR_STRUCT_SIZE,
     "a structure has a size that this version of the library does not know"},
    {Status::device_failed, GCDT_ERROR_NOT_VALID, "the mesh is not the constrained Delaunay triangulation"},
    {Status::device_failed, GCDT_ERROR_HOST_MEMORY, "the host is out of memory"},  // std::bad_alloc
    {Status::device_failed, GCDT_ERROR_INTERNAL, "internal error"},
    {Status::device_failed, -1, "OpenCL: device not found"},
    {Status::out_of_memory, -4, "OpenCL: memory object allocation failure"},
    {Status::out_of_memory, -5, "OpenCL: out of resources"},
    {Status::out_of_memory, -6, "OpenCL: out of host memory"},
    {Status::device_failed, -11, "OpenCL: build program failure"},
    {Status::device_failed, -14, "OpenCL: an event of the wait list failed"},
    {Status::device_failed, -34, "OpenCL: invalid context"},
    {Status::device_failed, -36, "OpenCL: invalid command queue"},
    {Status::device_failed, -38, "OpenCL: invalid memory object"},
    {Status::device_failed, -57, "OpenCL: invalid event wait list"},
    {Status::device_failed, -58, "OpenCL: invalid event"},
    {Status::out_of_memory, -61, "OpenCL: invalid buffer size"},
};

/// Calls use(row) for the row of a code; whether there is one.
template <class Use>
constexpr bool row_of(std::int32_t code, Use&& use) {
  for (const StatusRow& row : statuses)
    if (row.code == code) return use(row), true;
  for (const CodeRow& row : other_codes)
    if (row.code == code) return use(row), true;
  return false;
}

inline Status status_of(std::int32_t code) {
  Status status = Status::device_failed;
  row_of(code, [&](const auto& row) { status = row.status; });
  return status;
}

/// Null for one that is not there.
constexpr const StatusRow* row_of(Status status) {
  for (const StatusRow& row : statuses)
    if (row.status == status) return &row;
  return nullptr;
}

}  // namespace gcdt::detail

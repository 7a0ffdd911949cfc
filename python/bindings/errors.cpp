// SPDX-License-Identifier: Apache-2.0
// Errors of the library become exceptions of Python: python/gcdt/_errors.py makes them.
#include "options.hpp"

namespace gcdt::python {

namespace {

const char* name_of(Status status) {
  switch (status) {
    case Status::ok: return "ok";
    case Status::invalid_argument: return "invalid_argument";
    case Status::coordinate_not_finite: return "coordinate_not_finite";
    case Status::coordinate_outside_grid: return "coordinate_outside_grid";
    case Status::index_out_of_range: return "index_out_of_range";
    case Status::too_many_vertices: return "too_many_vertices";
    case Status::constraints_cross: return "constraints_cross";
    case Status::no_device: return "no_device";
    case Status::device_failed: return "device_failed";
    case Status::out_of_memory: return "out_of_memory";
    case Status::round_limit: return "round_limit";
    case Status::check_failed: return "check_failed";
    case Status::cancelled: return "cancelled";
    case Status::workspace_too_small: return "workspace_too_small";
    case Status::buffer_too_small: return "buffer_too_small";
    case Status::wrong_context: return "wrong_context";
    case Status::buffer_access: return "buffer_access";
    case Status::buffers_overlap: return "buffers_overlap";
    case Status::in_use: return "in_use";
    case Status::vertices_coincide: return "vertices_coincide";
    case Status::spill_failed: return "spill_failed";
  }
  return "device_failed";
}

}  // namespace

nb::object error_object(const Error& error) {
  nb::list indices;
  for (const std::uint64_t index : error.indices()) indices.append(index);
  return nb::module_::import_("gcdt._errors")
      .attr("make")(name_of(error.status()), error.what(), indices, error.pair_count(), error.opencl_code());
}

void bind_errors() {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      try {
        const nb::object object = error_object(error);
        PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(object.ptr())), object.ptr());
      } catch (nb::python_error& raised) {
        // By a signal's handler, such as KeyboardInterrupt. It goes first: the signal may have been why a driver
        // failed.
        raised.restore();
      }
    }
  });
}

}  // namespace gcdt::python

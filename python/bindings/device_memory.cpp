// SPDX-License-Identifier: Apache-2.0
// OpenCL objects of Python programs, as the numbers that PyOpenCL gives (int_ptr): queues, buffers and events.
#include <vector>

#include <nanobind/stl/vector.h>

#include <gcdt/gcdt_cl.h>
#include <gcdt/gcdt_pool.hpp>

#include "results.hpp"

namespace gcdt::python {

namespace {

using Handle = std::uintptr_t;

/// A range of a buffer: elements from `offset` on. 0 is no buffer.
struct BufferRange {
  Handle memory = 0;
  std::uint64_t offset = 0, count = 0;
};

std::vector<cl_event> events(const std::vector<Handle>& handles) {
  std::vector<cl_event> all;
  for (const Handle handle : handles) all.push_back(reinterpret_cast<cl_event>(handle));
  return all;
}

std::unique_ptr<DeviceResult> triangulate_buffers(const std::shared_ptr<SharedSolver>& shared, int coordinate_type,
                                                  const BufferRange& vertices, const BufferRange& constraints,
                                                  const CallOptions& options, const std::vector<Handle>& wait_for) {
  gcdt_cl_input input = GCDT_CL_INPUT_INIT;
  input.coordinate_type = coordinate_type;
  input.vertices = reinterpret_cast<cl_mem>(vertices.memory);
  input.vertex_offset = vertices.offset, input.vertex_count = vertices.count;
  input.constraints = reinterpret_cast<cl_mem>(constraints.memory);
  input.constraint_offset = constraints.offset, input.constraint_count = constraints.count;
  const std::vector<cl_event> waits = events(wait_for);
  const Options wanted = options.for_call();
  nb::gil_scoped_release release;
  const SharedSolver::Turn turn(*shared);
  gcdt_solver* solver = turn.solver().handle();
  Result result(detail::made<gcdt_result>(wanted, solver, gcdt_result_release, [&](const gcdt_options& c, auto** made) {
    return gcdt_cl_triangulate(solver, &input, &c, static_cast<cl_uint>(waits.size()), waits.data(), made);
  }));
  return std::make_unique<DeviceResult>(shared, std::move(result));
}

/// Enqueues a copy, and gives the event, which is the caller's.
Handle enqueue_copy(DeviceResult& self, int array, Handle queue, const BufferRange& to,
                    const std::vector<Handle>& wait_for) {
  const std::vector<cl_event> waits = events(wait_for);
  cl_event event = nullptr;
  self.ask([&](const Result& result) {
    detail::check(gcdt_cl_enqueue_copy(result.handle(), array, reinterpret_cast<cl_command_queue>(queue),
                                       reinterpret_cast<cl_mem>(to.memory), to.offset, to.count,
                                       static_cast<cl_uint>(waits.size()), waits.data(), &event));
    return 0;
  });
  return reinterpret_cast<Handle>(event);
}

void locate_buffers(DeviceResult& self, int coordinate_type, const BufferRange& where, Handle triangles, Handle weights,
                    const std::vector<Handle>& wait_for) {
  const std::vector<cl_event> waits = events(wait_for);
  self.ask([&](const Result& result) {
    detail::check(gcdt_cl_locate(result.handle(), coordinate_type, reinterpret_cast<cl_mem>(where.memory), where.offset,
                                 where.count, reinterpret_cast<cl_mem>(triangles), reinterpret_cast<cl_mem>(weights),
                                 static_cast<cl_uint>(waits.size()), waits.data()));
    return 0;
  });
}

}  // namespace

void bind_device_memory(nb::module_& m) {
  nb::class_<BufferRange>(m, "BufferRange", "Elements of an OpenCL buffer.")
      .def(nb::init<Handle, std::uint64_t, std::uint64_t>(), nb::arg("memory"), nb::arg("offset"), nb::arg("count"));
  m.def(
      "solver_on_queue",
      [](Handle queue, nb::object log) {
        std::unique_ptr<Log> kept = detail::boxed(python_log(std::move(log)));
        nb::gil_scoped_release release;
        const gcdt_solver_options options = detail::solver_options(kept.get());
        gcdt_solver* solver = nullptr;
        detail::check(gcdt_cl_solver_create(reinterpret_cast<cl_command_queue>(queue), &options, &solver));
        return std::make_shared<SharedSolver>(Solver(solver, std::move(kept)));
      },
      nb::arg("queue"), nb::arg("log").none());
  m.def("triangulate_buffers", &triangulate_buffers, nb::arg("solver"), nb::arg("coordinate_type"), nb::arg("vertices"),
        nb::arg("constraints"), nb::arg("options"), nb::arg("wait_for"));
  m.def(
      "result_buffer",
      [](DeviceResult& self, int array) {
        cl_mem memory = nullptr;
        self.ask([&](const Result& result) {
          detail::check(gcdt_cl_result_buffer(result.handle(), array, &memory));
          return 0;
        });
        return reinterpret_cast<Handle>(memory);
      },
      nb::arg("result"), nb::arg("array"));
  m.def("enqueue_copy", &enqueue_copy, nb::arg("result"), nb::arg("array"), nb::arg("queue"), nb::arg("to"),
        nb::arg("wait_for"));
  m.def("locate_buffers", &locate_buffers, nb::arg("result"), nb::arg("coordinate_type"), nb::arg("points"),
        nb::arg("triangles"), nb::arg("weights"), nb::arg("wait_for"));
  m.def("result_statistics", [](DeviceResult& self) {
    return statistics_dict(self.ask([](const Result& result) { return result.statistics(); }));
  });
#define GCDT_ARRAY(number, name, type, width, ...) numbers[#name] = nb::make_tuple(int{number}, int{width}, #type);
#define GCDT_DERIVED_ARRAY GCDT_ARRAY
  nb::dict numbers;
#include <gcdt/arrays.def>
  m.attr("arrays") = numbers;
}

}  // namespace gcdt::python

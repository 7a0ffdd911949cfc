// SPDX-License-Identifier: Apache-2.0
// What can go wrong of a call, and how every interface is to say so.
#pragma once

#include <CL/cl.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solver_fixture.hpp"

namespace gcdt::test {

/// Variables of the environment, from which fault_layer.c takes the faults that drivers have.
using Variables = std::vector<std::pair<std::string, std::string>>;

/// The driver compiles another text.
inline Variables edit(const char* from, const char* to) { return {{"GCDT_FAULT_FROM", from}, {"GCDT_FAULT_TO", to}}; }

/// One thing that goes wrong.
struct Failure {
  std::string name;
  Variables faults;
  Workload work;
  Options options;
  Status status;
  std::int32_t code;
  int exit;
  std::string said;
  std::string arguments = {};  ///< of the command
  bool of_device = true;       ///< else of the problem, where there are others
};

/// Larger than what is refused of memory.
inline Workload large() {
  Workload work = uniform(12000);  // two tiles at most
  work.constraints = {{0, 1}};
  return work;
}

/// More than the calling thread triangulates by itself, which asks the device for nothing.
inline const Workload many = {uniform(50000).points, {{0, 1}}};
inline const Workload square = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.25}}, {{0, 2}}};

/// Those of devices and drivers.
inline std::vector<Failure> failures_of_devices() {
  return {
      {"a buffer is refused",
       {{"GCDT_FAULT_BUFFERS", "200000"}},
       large(),
       {},
       Status::out_of_memory,
       CL_MEM_OBJECT_ALLOCATION_FAILURE,
       4,
       "clCreateBuffer",
       "",
       false},
      {"the device is small",
       {{"GCDT_FAULT_MEMORY", "400000"}},
       large(),
       {},
       Status::out_of_memory,
       GCDT_ERROR_OUT_OF_MEMORY,
       4,
       "400000",
       "",
       false},
      {"a program does not build",
       edit("global const uint2* constraints,", "global const uint3_* constraints,"),
       many,
       {},
       Status::device_failed,
       GCDT_ERROR_DEVICE_FAILED,
       4,
       "clBuildProgram"},
      {"a kernel is not there",
       edit("kernel void mark_first(", "kernel void mark_farst("),
       many,
       {},
       Status::device_failed,
       CL_INVALID_KERNEL_NAME,
       4,
       "mark_first"},
      {"vertices are not found",
       edit("if (ref == GCDT_NONE || --left == 0u)", "if (true)"),
       many,
       {},
       Status::round_limit,
       GCDT_ERROR_ROUND_LIMIT,
       4,
       "point location left the mesh"},
      {"a star has no end",
       edit("if (yn == first) return;", ";"),
       many,
       {},
       Status::round_limit,
       GCDT_ERROR_ROUND_LIMIT,
       4,
       "point location left the mesh"},
      {"a link is wrong",
       edit("out_constrained[i] = (uchar)(marks.x | marks.y << 1 | marks.z << 2);",
            "out_constrained[i] = (uchar)(marks.x | marks.y << 1 | marks.z << 2);\n  out_neighbours[0] = 99;"),
       many,
       {},
       Status::check_failed,
       GCDT_ERROR_CHECK_FAILED,
       5,
       "check: "},
  };
}

/// And those of what is asked of them.
inline std::vector<Failure> failures() {
  std::vector<Failure> all = failures_of_devices();
  const auto add = [&](const char* name, Workload work, Status status, std::int32_t code, const char* said,
                       const char* arguments = "") {
    all.push_back({name, {}, std::move(work), {}, status, code, 3, said, arguments, false});
    return &all.back();
  };
  Workload nan = square, far = square, missing = square, cross = square;
  nan.points[3][1] = std::nan("");
  missing.constraints = {{0, 5}};
  cross.constraints = {{0, 2}, {1, 3}};
  add("not finite", nan, Status::coordinate_not_finite, GCDT_ERROR_COORDINATE_NOT_FINITE, "");
  add("off the grid", far, Status::coordinate_outside_grid, GCDT_ERROR_COORDINATE_OUTSIDE_GRID, "grid", "--grid 5,0,1")
      ->options.grid = FixedGrid{5, 0, "1"};
  add("no such vertex", missing, Status::index_out_of_range, GCDT_ERROR_INDEX_OUT_OF_RANGE, "");
  add("crossing", cross, Status::constraints_cross, GCDT_ERROR_CONSTRAINTS_CROSS, "cross");
  Failure* wrong = add("no grid", square, Status::invalid_argument, GCDT_ERROR_INVALID_ARGUMENT, "", "--grid 0,0,0");
  wrong->options.grid = FixedGrid{0, 0, "0"}, wrong->exit = 2, wrong->of_device = true;
  Failure* stopped = add("cancelled", large(), Status::cancelled, GCDT_ERROR_CANCELLED, "cancelled");
  stopped->options.progress = [](const char*, double) { return false; };
  stopped->exit = 0, stopped->of_device = true;  // the command: command_progress_test.cpp
  return all;
}

}  // namespace gcdt::test

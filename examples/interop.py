#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""PyOpenCL hands its queue and buffers to gcdt through ctypes; the triangles stay on the device.

Usage: interop.py LIBRARY, the path of libgcdt.so. Needs python3-pyopencl.
"""
import ctypes as c
import sys

import numpy as np
import pyopencl as cl

TRIANGLES, INT32 = 0, 2


class Input(c.Structure):  # gcdt_cl_input
    _fields_ = [("struct_size", c.c_size_t), ("coordinate_type", c.c_int32),
                ("vertices", c.c_void_p), ("vertex_offset", c.c_uint64), ("vertex_count", c.c_uint64),
                ("constraints", c.c_void_p), ("constraint_offset", c.c_uint64), ("constraint_count", c.c_uint64)]


class Error(c.Structure):  # gcdt_error
    _fields_ = [("struct_size", c.c_size_t), ("status", c.c_int32), ("message", c.c_char_p),
                ("indices", c.POINTER(c.c_uint64)), ("index_count", c.c_size_t), ("pair_count", c.c_uint64)]


gcdt = c.CDLL(sys.argv[1])
gcdt.gcdt_result_count.restype = c.c_uint64
for function in (gcdt.gcdt_result_release, gcdt.gcdt_solver_release, gcdt.gcdt_result_count):
    function.argtypes = [c.c_void_p] + [c.c_int32] * (function is gcdt.gcdt_result_count)


def check(status):
    if status != 0:
        error = Error(struct_size=c.sizeof(Error))
        gcdt.gcdt_last_error(None, c.byref(error))
        raise RuntimeError(f"{status}: {error.message.decode()}")


def main():
    device = next(d for p in cl.get_platforms() for d in p.get_devices() if d.compiler_available)
    context = cl.Context([device])
    queue = cl.CommandQueue(context)
    flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
    # A random walk of vertices above the diagonal, and a constraint from each tenth to the next.
    rng = np.random.default_rng(1)
    points = np.stack([np.arange(1000), rng.integers(0, 1000, 1000)], axis=1).astype(np.int32)
    ends = np.arange(0, 1000, 10, dtype=np.uint32)
    constraints = np.stack([ends[:-1], ends[1:]], axis=1)
    vertex_memory = cl.Buffer(context, flags, hostbuf=points)
    constraint_memory = cl.Buffer(context, flags, hostbuf=np.ascontiguousarray(constraints))

    solver, result, triangle_memory = c.c_void_p(), c.c_void_p(), c.c_void_p()
    check(gcdt.gcdt_cl_solver_create(c.c_void_p(queue.int_ptr), None, c.byref(solver)))
    given = Input(c.sizeof(Input), INT32, vertex_memory.int_ptr, 0, len(points),
                  constraint_memory.int_ptr, 0, len(constraints))
    check(gcdt.gcdt_cl_triangulate(solver, c.byref(given), None, 0, None, c.byref(result)))
    count = gcdt.gcdt_result_count(result, TRIANGLES)
    check(gcdt.gcdt_cl_result_buffer(result, TRIANGLES, c.byref(triangle_memory)))

    # The library's buffer as PyOpenCL's, used in place by a kernel.
    triangles = cl.MemoryObject.from_int_ptr(triangle_memory.value, retain=True)
    areas = cl.Buffer(context, cl.mem_flags.READ_WRITE, 8 * count)
    program = cl.Program(context, """
        kernel void areas(global const int2* points, global const uint* triangles, global long* twice) {
          uint t = get_global_id(0);
          uint3 v = vload3(t, triangles);
          long2 a = convert_long2(points[v.y] - points[v.x]), b = convert_long2(points[v.z] - points[v.x]);
          twice[t] = a.x * b.y - a.y * b.x;
        }""").build()
    program.areas(queue, (count,), None, vertex_memory, triangles, areas)
    twice = np.empty(count, np.int64)
    cl.enqueue_copy(queue, twice, areas)
    corners = np.empty((count, 3), np.uint32)
    cl.enqueue_copy(queue, corners, triangles)
    del triangles
    gcdt.gcdt_result_release(result)
    gcdt.gcdt_solver_release(solver)

    edges = {frozenset(e) for t in corners.tolist() for e in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
    assert (twice > 0).all(), "every triangle is counter-clockwise"
    assert len({v for t in corners.tolist() for v in t}) == len(points), "every vertex is a corner"
    kept = sum(frozenset(pair) in edges for pair in constraints.tolist())
    print(f"{len(points)} points, {count} triangles, {kept} of {len(constraints)} constraints are edges as they are")
    assert kept > 0


main()

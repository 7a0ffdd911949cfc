/* SPDX-License-Identifier: Apache-2.0 */
/* gcdt for applications that have an OpenCL context, queue and buffers of their own. See gcdt.h for the rules.
 *
 * Ownership. What the library keeps of the application's it retains, and releases with the solver; it owns nothing of
 * theirs. It never changes the properties of a queue or the arguments of a kernel of theirs.
 *
 * Order. The solver has a private in-order queue on the context and device of the application's queue, so that queue
 * may be in-order or out-of-order, with profiling or without. gcdt_cl_triangulate enqueues one marker there, with the
 * wait list, and waits for it on the host: as any command, it comes after what the queue's order, its barriers and
 * the wait list say; with an empty wait list on an out-of-order queue, after everything enqueued before. The functions
 * named enqueue put a single copy into the application's queue, under the same rules, and do not block.
 *
 * Blocking. gcdt_cl_solver_create (building programs), gcdt_cl_triangulate, gcdt_cl_locate and gcdt_result_copy block,
 * and whatever first asks for an array that is made on demand; nothing else does. When gcdt_cl_triangulate returns, the
 * mesh is complete: commands that use it need no event to wait for. If an event of a wait list fails, its status or
 * CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST is returned.
 */
#ifndef GCDT_GCDT_CL_H
#define GCDT_GCDT_CL_H

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#ifdef __APPLE__
#include <OpenCL/cl.h>
#else
#include <CL/cl.h>
#endif

#include <gcdt/gcdt.h>
#include <gcdt/gcdt_pool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A solver on the context and device of `queue`, which is retained. The context may have further devices: buffers may
 * come from any. options->device must be null; `options` may be null. Blocks. */
GCDT_API int32_t gcdt_cl_solver_create(cl_command_queue queue, const gcdt_solver_options* options,
                                       gcdt_solver** solver);

/* A pool of the devices of these queues, on their contexts, which are retained: of any platforms, sub-devices as well.
 * Each gets a private in-order queue. The queues themselves are not used. options->devices must be null; `options` may
 * be null. Blocks. */
GCDT_API int32_t gcdt_cl_pool_create(cl_uint count, const cl_command_queue* queues, const gcdt_pool_options* options,
                                     gcdt_pool** pool);

/* A batch in device memory: what gcdt_batch_input says, in buffers of one context, which are only read and not to be
 * written until the call returns. */
typedef struct gcdt_cl_batch_input {
  size_t struct_size;
  int32_t coordinate_type; /* GCDT_FLOAT64, GCDT_FLOAT32, GCDT_INT32 or GCDT_INT64 */
  uint64_t problem_count;  /* 0 to 2^30 */
  cl_mem vertices;         /* pairs x, y of all problems; null only if there are none */
  /* problem_count + 1 cl_ulong, ascending: problem p has the pairs [p] up to [p + 1]. Null only without problems. */
  cl_mem vertex_offsets;
  cl_mem constraints;        /* pairs of cl_uint that count from 0 in each problem; null only if there are none */
  cl_mem constraint_offsets; /* problem_count + 1 cl_ulong, ascending, of constraints; null only if there are none */
} gcdt_cl_batch_input;
#define GCDT_CL_BATCH_INPUT_INIT \
  { sizeof(gcdt_cl_batch_input), GCDT_FLOAT64, 0, NULL, NULL, NULL, NULL }

/* As gcdt_pool_triangulate, with the same grids and bytes. The devices of a pool may have no context in common, so the
 * buffers are read into host memory first: by commands in `queue`, a queue of the buffers' context and none of the
 * pool's business otherwise, after the events of the wait list (null if wait_count is 0). Blocks; a user event in the
 * wait list must be set by another thread. */
GCDT_API int32_t gcdt_cl_pool_triangulate(gcdt_pool* pool, cl_command_queue queue, const gcdt_cl_batch_input* input,
                                          const gcdt_options* options, cl_uint wait_count, const cl_event* wait_list,
                                          gcdt_batch** batch);

/* As gcdt_batch_copy, into buffers of the context of `queue`, by commands in it after the events of the wait list: the
 * elements to `destination` from element `offset` on, where `capacity` may be written, and where each problem's begin,
 * counted from there, to the first problem_count + 1 cl_ulong of `offsets`. Either may be null. Too small:
 * GCDT_ERROR_BUFFER_TOO_SMALL, and nothing is written. Blocks. */
GCDT_API int32_t gcdt_cl_batch_copy(const gcdt_batch* batch, int32_t array, cl_command_queue queue, cl_mem destination,
                                    uint64_t offset, uint64_t capacity, cl_mem offsets, cl_uint wait_count,
                                    const cl_event* wait_list);

/* Vertices and constraints in device memory: buffers of the solver's context, sub-buffers allowed, readable by
 * kernels, only read, and not to be written until the call returns. The two ranges must not overlap. */
typedef struct gcdt_cl_input {
  size_t struct_size;
  int32_t coordinate_type;    /* GCDT_FLOAT64, GCDT_FLOAT32, GCDT_INT64; GCDT_INT32: on the grid 0, 0, "1" as they are,
                                 none < 0 */
  cl_mem vertices;            /* pairs x, y; null only if there are none */
  uint64_t vertex_offset;     /* the first vertex's number of pairs from the start of the buffer */
  uint64_t vertex_count;      /* 0 to GCDT_MAX_VERTICES */
  cl_mem constraints;         /* pairs of uint32 vertex numbers, counted from vertex_offset; null only if none */
  uint64_t constraint_offset; /* in pairs */
  uint64_t constraint_count;  /* 0 to GCDT_MAX_CONSTRAINTS */
} gcdt_cl_input;
#define GCDT_CL_INPUT_INIT \
  { sizeof(gcdt_cl_input), GCDT_INT32, NULL, 0, 0, NULL, 0, 0 }

/* As gcdt_triangulate, after the events of the wait list (null if wait_count is 0). With an offset of 0 the input is
 * read where it is, else it is copied within the device. Blocks until the mesh is complete; a user event in the wait
 * list must be set by another thread. Only for solvers of gcdt_cl_solver_create. */
GCDT_API int32_t gcdt_cl_triangulate(gcdt_solver* solver, const gcdt_cl_input* input, const gcdt_options* options,
                                     cl_uint wait_count, const cl_event* wait_list, gcdt_result** result);

/* The device memory that holds an array (GCDT_TRIANGLES ...): gcdt_result_count elements from its start, then nothing
 * that is the caller's; null for an array that was not asked for. No copy; to be read only. It is the result's:
 * commands that read it must be complete before the result is released. */
GCDT_API int32_t gcdt_cl_result_buffer(const gcdt_result* result, int32_t array, cl_mem* buffer);

/* Enqueues, in `queue`, a copy of all elements of an array into `destination` from element `offset` on, where
 * `capacity` elements may be written. `queue` is any queue of the solver's context, `destination` a buffer of it that
 * kernels may write. *event (may be null) is set to the copy's event, which the caller releases. Too small:
 * GCDT_ERROR_BUFFER_TOO_SMALL, and nothing is enqueued. An empty array gives a marker. Does not block. The result may
 * be released at once: the solver waits for the copy before it writes there again. */
GCDT_API int32_t gcdt_cl_enqueue_copy(gcdt_result* result, int32_t array, cl_command_queue queue, cl_mem destination,
                                      uint64_t offset, uint64_t capacity, cl_uint wait_count, const cl_event* wait_list,
                                      cl_event* event);

/* As gcdt_locate, from device memory to device memory: `count` points from element `point_offset` of `points` on (pairs
 * of the type), `triangles` int32, and `weights` (may be null) three float32 a point, both from their starts. Buffers
 * of the solver's context. After the events of the wait list; blocks. */
GCDT_API int32_t gcdt_cl_locate(gcdt_result* result, int32_t coordinate_type, cl_mem points, uint64_t point_offset,
                                uint64_t count, cl_mem triangles, cl_mem weights, cl_uint wait_count,
                                const cl_event* wait_list);

/* Lets the solver work in the caller's memory alone: `count` buffers of its context, not sub-buffers, distinct,
 * readable and writable by kernels and host. They are retained until another workspace is set (count 0: memory of its
 * own again) or the solver and its results are released, and hold the results. Together they should have
 * gcdt_required_bytes, in one buffer if the device allows; where that turns out too little (the crossed pairs are only
 * known after the first walk), a call returns GCDT_ERROR_WORKSPACE_TOO_SMALL with the size needed. GCDT_ERROR_IN_USE
 * while a result lives. The solver cuts the buffers into sub-buffers; NVIDIA's driver copies such parts through the
 * host when their use changes, which costs several times the triangulation: memory of its own, or an allocator, is
 * faster. */
GCDT_API int32_t gcdt_cl_set_workspace(gcdt_solver* solver, cl_uint count, const cl_mem* buffers);

/* Where the solver takes device memory from, some forty buffers that it keeps, and where it gives them back. `allocate`
 * returns a buffer of `context`, or null and a code; `release` gets each buffer once, at trim, at the change of a hook
 * or workspace, or when solver and results are gone. The rules of gcdt_log_function hold. */
typedef struct gcdt_cl_allocator {
  size_t struct_size;
  cl_mem (*allocate)(void* user, cl_context context, cl_mem_flags flags, size_t bytes, cl_int* code);
  void (*release)(void* user, cl_mem buffer);
  void* user;
} gcdt_cl_allocator;

/* `allocator` null: clCreateBuffer and clReleaseMemObject again. GCDT_ERROR_IN_USE while a result lives. */
GCDT_API int32_t gcdt_cl_set_allocator(gcdt_solver* solver, const gcdt_cl_allocator* allocator);

#ifdef __cplusplus
}
#endif

#endif

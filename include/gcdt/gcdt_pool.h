/* SPDX-License-Identifier: Apache-2.0 */
/* gcdt, many problems on many devices: a batch of small (or large) triangulations in one call, shared out to any set
 * of OpenCL devices. What gcdt.h says of elements, errors, threads and structures holds here; details of a failed call
 * on a pool or batch are those of the calling thread (gcdt_last_error with null).
 *
 * Every problem's arrays have the bytes that the problem would have alone, whatever the devices are and whatever else
 * is in the batch. A problem that is invalid has an error of its own and spoils no other. */
#ifndef GCDT_GCDT_POOL_H
#define GCDT_GCDT_POOL_H

#include <gcdt/gcdt.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- The pool ---------------------------------------------------------------------------------------------- */

typedef struct gcdt_pool gcdt_pool;
typedef struct gcdt_batch gcdt_batch;

typedef struct gcdt_pool_options {
  size_t struct_size;
  /* The devices, separated by commas: `all`, `gpu` (all GPUs), `cpu` (all CPUs), `auto` (all GPUs if there are any,
   * else a CPU), numbers, parts of names (all that match, letter case aside); null or empty: the variable GCDT_DEVICE,
   * else `auto`. Must be null where the application gives its own queues. */
  const char* devices;
  /* Called by threads of the pool during calls, one at a time; else as for gcdt_solver_options. */
  gcdt_log_function log;
  void* log_user;
  gcdt_trace_function trace;
  void* trace_user;
  uint64_t memory_bytes; /* each device is used as if it had no more memory; 0: all that it has */
  /* A directory for files to which tiles go that no device has room for, 50 bytes a vertex; nothing is left in it,
   * however the process ends. Null or empty: to where the result is to be, in the host's memory. Errors of files:
   * GCDT_ERROR_SPILL_FAILED, of the problem. */
  const char* spill_directory;
  /* 1: results of problems in tiles lie in memory that a GPU's driver has pinned, to which GPUs write by themselves.
   * The pool keeps that memory when a batch is released, for the next results, until it is released itself: pinning
   * takes far longer than writing. Where there is no GPU nothing changes. */
  int32_t pinned_results;
} gcdt_pool_options;
#define GCDT_POOL_OPTIONS_INIT \
  { sizeof(gcdt_pool_options), NULL, NULL, NULL, NULL, NULL, 0, NULL, 0 }

/* A pool of the devices that `options` (may be null) choose. *pool is the caller's, for gcdt_pool_release. Blocks while
 * programs are built. As a solver, a pool belongs to one thread at a time, distinct pools to distinct threads; it
 * starts threads of its own during calls. It keeps the programs, the device memory and the pinned host memory that
 * calls have needed for the next ones.
 *
 * Errors: GCDT_ERROR_NO_DEVICE if nothing fits the choice. A device that fails is left out, and
 * gcdt_pool_device_get says why; if all do the call fails with every device's reason, as gcdt_pool_triangulate does.
 *
 * What a pool decides itself: a CPU beside GPUs leaves cores to the threads that feed them, where it can be divided,
 * and sits calls out to which it would add little. Its driver may compile kernels for seconds when they are first
 * launched, so that the first call with other rules for crossings, domains or regions may take that much longer.
 *
 * Traces: a device may work on several runs at once, its workers. Worker k of device d has the device_number
 * d + k * gcdt_pool_device_count. */
GCDT_API int32_t gcdt_pool_create(const gcdt_pool_options* options, gcdt_pool** pool);

/* Null is allowed. Batches may be released before or after. */
GCDT_API void gcdt_pool_release(gcdt_pool* pool);

/* How many devices the pool was made with; 0 for null. */
GCDT_API size_t gcdt_pool_device_count(const gcdt_pool* pool);

typedef struct gcdt_pool_device {
  size_t struct_size;
  int32_t status;      /* GCDT_OK, or why it was taken out of the pool, for good */
  const char* message; /* the reason; "" if there is none; the pool's, until its next call */
  /* In the last batch: problems, their vertices and runs whose results counted, and milliseconds in such runs. */
  uint64_t problems, vertices, runs;
  double ms_busy;
  gcdt_device_info info; /* its struct_size is set by the library */
} gcdt_pool_device;

GCDT_API int32_t gcdt_pool_device_get(const gcdt_pool* pool, size_t number, gcdt_pool_device* device);

/* ---- Batches ----------------------------------------------------------------------------------------------- */

/* Problems one after the other in host memory: the caller's, read only during the call. */
typedef struct gcdt_batch_input {
  size_t struct_size;
  int32_t coordinate_type; /* GCDT_FLOAT64, GCDT_FLOAT32, GCDT_INT32 or GCDT_INT64 */
  uint64_t problem_count;  /* 0 to 2^30 */
  const void* vertices;    /* pairs x, y of all problems; may be null if there are none */
  /* problem_count + 1, ascending: problem p has the vertices [p] up to [p + 1]. May be null without problems. */
  const uint64_t* vertex_offsets;
  const uint32_t* constraints; /* pairs of vertex numbers that count from 0 in each problem; or null */
  /* problem_count + 1, ascending, of constraints; may be null if there are no constraints. */
  const uint64_t* constraint_offsets;
} gcdt_batch_input;
#define GCDT_BATCH_INPUT_INIT \
  { sizeof(gcdt_batch_input), GCDT_FLOAT64, 0, NULL, NULL, NULL, NULL }

/* Triangulates every problem, each on its own grid (or all on the one in `options`), in canonical order whatever
 * `options` say, and brings the results to host memory. `options` may be null; progress is told by the calling thread,
 * with the phase "batch". A device that fails is taken out and its work goes to others, nothing is lost or done twice;
 * if none is left the call fails with every device's reason: the status that all failed with, else
 * GCDT_ERROR_DEVICE_FAILED. Problems that are invalid, or too large for every device, fail alone
 * (gcdt_batch_problem). Under GCDT_CROSSING_SPLIT problems that cross are run one by one, after the others of their
 * run: they take as long as they would take a solver, and so do all problems with gcdt_options.refine, of which
 * most_added counts for each problem, and sizes has one length for each of the batch's vertices, the last offset of
 * them. Domains and regions are each problem's own; hole and region seeds, which are of one problem, are taken
 * with a batch of one, and are GCDT_ERROR_INVALID_ARGUMENT with more.
 *
 * A problem that is too large for every device is cut into tiles, and gcdt_options.tiles cuts all of them: each tile is
 * a problem of a batch that all devices share, and what is between them one more (docs/scale.md). The bytes stay the
 * same. The host then needs about 90 bytes a vertex beside input and result. A problem whose rest between the tiles
 * is too large for every device as well is GCDT_ERROR_OUT_OF_MEMORY, and so is a problem to be refined that is too
 * large, since tiles are not refined. Blocks. */
GCDT_API int32_t gcdt_pool_triangulate(gcdt_pool* pool, const gcdt_batch_input* input, const gcdt_options* options,
                                       gcdt_batch** batch);

/* How one problem went. The pointers are the batch's. */
typedef struct gcdt_problem {
  size_t struct_size;
  int32_t status;          /* GCDT_OK, or as gcdt_triangulate would return */
  const char* message;     /* "" without an error */
  const uint64_t* indices; /* in the problem's own numbers; see the statuses */
  size_t index_count;
  uint64_t pair_count;
  uint64_t triangles; /* 0 with an error */
  gcdt_grid grid;     /* its struct_size is set by the library */
  /* Under GCDT_CROSSING_SPLIT, as in gcdt_statistics; else 0. vertices_added: those of refinement, too. */
  uint64_t crossings, vertices_added, constraints_split;
  double constraint_move;
  uint64_t vertices_rounded_together; /* as in gcdt_statistics */
  uint32_t rounded_pair[2];
  uint32_t tiles;         /* that the problem was cut into; 0: it was not */
  uint64_t seam_vertices; /* of the problem between the tiles; 0 without tiles */
  /* Of gcdt_options.refine, as in gcdt_statistics; complete: 0 with an error. left: all that are not as wanted. */
  uint64_t refine_complete, refine_rounds, refine_added, refine_left;
} gcdt_problem;

GCDT_API int32_t gcdt_batch_problem(const gcdt_batch* batch, uint64_t problem, gcdt_problem* info);

/* One of the arrays (GCDT_TRIANGLES ...) of a problem, those made on demand excepted: where it lies, the batch's
 * memory, and its elements. Empty if the problem has an error. */
GCDT_API int32_t gcdt_batch_array(const gcdt_batch* batch, uint64_t problem, int32_t array, const void** data,
                                  uint64_t* count);

/* One of the arrays of all problems, one after the other: to `destination`, with room for `capacity` elements, and
 * where each problem's begins to `offsets`, problem_count + 1 elements. Either may be null. Too small:
 * GCDT_ERROR_BUFFER_TOO_SMALL, and nothing is written. */
GCDT_API int32_t gcdt_batch_copy(const gcdt_batch* batch, int32_t array, void* destination, uint64_t capacity,
                                 uint64_t* offsets);

typedef struct gcdt_batch_statistics {
  size_t struct_size;
  uint64_t problems, failed; /* failed: with errors of their own */
  uint64_t vertices, constraints, triangles;
  double ms_call; /* the whole call on the caller's clock, programs built included */
} gcdt_batch_statistics;
GCDT_API int32_t gcdt_batch_get_statistics(const gcdt_batch* batch, gcdt_batch_statistics* statistics);

/* Null is allowed. */
GCDT_API void gcdt_batch_release(gcdt_batch* batch);

#ifdef __cplusplus
}
#endif

#endif

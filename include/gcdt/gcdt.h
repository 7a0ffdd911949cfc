/* SPDX-License-Identifier: Apache-2.0 */
/* gcdt, the C interface: the exact constrained Delaunay triangulation (CDT) of vertices and constraints on one
 * OpenCL device. No OpenCL header is needed; gcdt_cl.h adds what applications with an OpenCL context of their own
 * want, gcdt.hpp and gcdt_cl.hpp are C++17 over both. Only the functions declared here and in gcdt_cl.h are exported.
 *
 * Elements. Counts, offsets and capacities are in elements: one vertex (2 numbers), one constraint (2 vertex
 * numbers), one triangle (3 corners), and so on; never in bytes, except where the name says bytes. Arrays are packed.
 *
 * Errors. Every function that can fail returns a status: GCDT_OK, one of GCDT_ERROR_..., or the code of an OpenCL
 * call that failed (negative, above -20000), as it is. gcdt_last_error has the details. A function that fails has no
 * effect: nothing of the caller's is written, and the solver can be used again.
 *
 * Threads. Distinct solvers may be used by distinct threads at once. One solver, together with its results, belongs
 * to one thread at a time; a call made while another call on the same solver runs, from a callback as well, is
 * refused with GCDT_ERROR_IN_USE. Functions without a solver or result may be called by any thread at any time.
 * There is no global state but the calling thread's last error.
 *
 * Structures begin with struct_size, which the caller sets to sizeof, as the _INIT macros do. Later versions only
 * append members, and take every size that an earlier version had; a size unknown to the library is an error.
 */
#ifndef GCDT_GCDT_H
#define GCDT_GCDT_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(GCDT_BUILDING)
#define GCDT_API __declspec(dllexport)
#elif defined(_WIN32) && defined(GCDT_SHARED)
#define GCDT_API __declspec(dllimport)
#elif defined(__GNUC__)
#define GCDT_API __attribute__((visibility("default")))
#else
#define GCDT_API
#endif

#define GCDT_VERSION_MAJOR 0
#define GCDT_VERSION_MINOR 1
#define GCDT_VERSION_PATCH 0

#ifdef __cplusplus
extern "C" {
#endif

/* "major.minor.patch" of the library that is linked or loaded. */
GCDT_API const char* gcdt_version(void);

/* ---- Status ------------------------------------------------------------------------------------------------ */

enum {
  GCDT_OK = 0,
  GCDT_ERROR_INVALID_ARGUMENT = -20001,        /* a null pointer, or a value that makes no sense */
  GCDT_ERROR_STRUCT_SIZE = -20002,             /* struct_size is of no version that this library knows */
  GCDT_ERROR_COORDINATE_NOT_FINITE = -20003,   /* indices: vertex, axis (0: x, 1: y) */
  GCDT_ERROR_COORDINATE_OUTSIDE_GRID = -20004, /* indices: vertex, axis; of a fixed grid, or an int64 beyond 2^53 */
  GCDT_ERROR_INDEX_OUT_OF_RANGE = -20005,      /* indices: constraint, end (0 or 1) */
  GCDT_ERROR_TOO_MANY_VERTICES = -20006,       /* more than GCDT_MAX_VERTICES */
  GCDT_ERROR_CONSTRAINTS_CROSS = -20007,       /* indices: all pairs c, d, c, d, ... (see gcdt_error) */
  GCDT_ERROR_NO_DEVICE = -20008,               /* no OpenCL device fits the choice */
  GCDT_ERROR_DEVICE_FAILED = -20009,           /* the device computes wrongly, or a program does not build */
  GCDT_ERROR_OUT_OF_MEMORY = -20010,           /* the device's memory or largest buffer is too small */
  GCDT_ERROR_ROUND_LIMIT = -20011,             /* a loop did not end where theory says it must */
  GCDT_ERROR_CHECK_FAILED = -20012,            /* the result failed its check and is withheld */
  GCDT_ERROR_CANCELLED = -20013,               /* the progress callback asked to stop */
  GCDT_ERROR_WORKSPACE_TOO_SMALL = -20014,     /* indices: bytes needed, as far as is known by now */
  GCDT_ERROR_BUFFER_TOO_SMALL = -20015,        /* indices: elements needed, elements there are */
  GCDT_ERROR_WRONG_CONTEXT = -20016,           /* a buffer or queue is not of the solver's context and device */
  GCDT_ERROR_BUFFER_ACCESS = -20017,           /* an output that is read-only, or an input that is write-only */
  GCDT_ERROR_BUFFERS_OVERLAP = -20018,         /* two ranges of device memory that must be apart are not */
  GCDT_ERROR_IN_USE = -20019,                  /* the solver is in a call, or its results still hold memory */
  GCDT_ERROR_NOT_VALID = -20020,               /* gcdt_verify: the mesh is not the CDT; the message says why */
  GCDT_ERROR_HOST_MEMORY = -20021,             /* the host is out of memory */
  GCDT_ERROR_INTERNAL = -20022,                /* a defect of this library */
  GCDT_ERROR_VERTICES_COINCIDE = -20023,       /* gcdt_options.distinct: rounding made vertices one; indices: the first
                                                  two of them */
  GCDT_ERROR_SPILL_FAILED = -20024             /* a file in gcdt_pool_options.spill_directory: the disk is full, or the
                                                  like */
};

/* A sentence for the status, OpenCL's codes included; never null. */
GCDT_API const char* gcdt_strerror(int32_t status);

typedef struct gcdt_solver gcdt_solver;
typedef struct gcdt_result gcdt_result;
typedef struct gcdt_mesh gcdt_mesh;

/* What a failed call has to say. The pointers are the library's, and hold until the next failed call on the same
 * solver (or, without a solver, by the same thread). Indices are input numbers, from 0; see the statuses. */
typedef struct gcdt_error {
  size_t struct_size;
  int32_t status;
  const char* message; /* never null; one or more lines of UTF-8 without a final newline */
  const uint64_t* indices;
  size_t index_count;
  uint64_t pair_count; /* constraints_cross: pairs of constraints that cross in all; a thread's own error has ten */
} gcdt_error;
#define GCDT_ERROR_INIT \
  { sizeof(gcdt_error), 0, "", NULL, 0, 0 }

/* The details of the last failed call on `solver` and its results; with null, of the last failed call by this
 * thread on any object or none (its message is cut at 4000 bytes). Status GCDT_OK if there was none. */
GCDT_API int32_t gcdt_last_error(const gcdt_solver* solver, gcdt_error* error);

/* ---- Devices ----------------------------------------------------------------------------------------------- */

typedef struct gcdt_device_info {
  size_t struct_size;
  char name[256], vendor[128], platform[128], driver[128], version[128]; /* cut if longer; end with a zero */
  int32_t is_gpu, is_cpu, atomics64, fp64, subgroups;                    /* 0 or 1 */
  uint32_t compute_units, largest_work_group;
  uint64_t memory_bytes, largest_buffer_bytes, local_bytes;
} gcdt_device_info;

/* How many OpenCL devices all platforms have that the library can use (OpenCL 1.2 and a compiler); 0 is no error. */
GCDT_API int32_t gcdt_device_count(size_t* count);

/* The device of that number. */
GCDT_API int32_t gcdt_device_get(size_t number, gcdt_device_info* info);

/* The number of the device that `spec` selects: `auto` (a GPU if there is one, else a CPU), `cpu`, `gpu`, a number, or
 * a part of a name, letter case aside; null or empty: the variable GCDT_DEVICE, else `auto`. If several names match,
 * the first is taken and *ambiguous (may be null) is 1. GCDT_ERROR_NO_DEVICE says what to install. */
GCDT_API int32_t gcdt_device_select(const char* spec, size_t* number, int32_t* ambiguous);

/* ---- The solver -------------------------------------------------------------------------------------------- */

/* Called by the thread that is in a call. Must not call back into the same solver, nor throw, nor jump out. */
typedef void (*gcdt_log_function)(void* user, int32_t level, const char* message);
enum { GCDT_LOG_WARNING = 1, GCDT_LOG_INFORMATION = 2 };

/* Something that took time: a phase of a call, as the host saw it, or one launch on the device. Launches lie within
 * the phase and one after the other; inner phases lie within outer ones. */
typedef struct gcdt_trace_span {
  size_t struct_size;
  const char* device;        /* its name; this and the other strings hold during the call only */
  uint32_t device_number;    /* its place among the devices of a pool; 0 for a solver. See gcdt_pool.h for workers */
  const char* phase;         /* the outermost phase: order, insert, constrain, flip, check, domain, refine or
                                output; in a pool also copy, of results to host memory */
  const char* name;          /* the phase's or the kernel's */
  int32_t on_device;         /* 1: a launch; drivers without profiling have none */
  uint64_t begin_ns, end_ns; /* nanoseconds on the host's steady clock */
} gcdt_trace_span;

/* Called by the thread that is in the call, for phases when they end. The rules of gcdt_log_function hold. */
typedef void (*gcdt_trace_function)(void* user, const gcdt_trace_span* span);

typedef struct gcdt_solver_options {
  size_t struct_size;
  const char* device;    /* as for gcdt_device_select; must be null where the application gives its own queue */
  gcdt_log_function log; /* programs built, memory taken, device oddities; null: silence */
  void* log_user;
  gcdt_trace_function trace; /* where the time goes, launch by launch, which costs some; null: not asked */
  void* trace_user;
} gcdt_solver_options;
#define GCDT_SOLVER_OPTIONS_INIT \
  { sizeof(gcdt_solver_options), NULL, NULL, NULL, NULL, NULL }

/* A solver on one device, with an OpenCL context of its own. It keeps its programs, device memory and, on GPUs, 32 MiB
 * of pinned host memory for transfers; repeated calls of one size allocate none. `options` may be null. Blocks. */
GCDT_API int32_t gcdt_solver_create(const gcdt_solver_options* options, gcdt_solver** solver);

/* Null is allowed. Results may be released before or after. */
GCDT_API void gcdt_solver_release(gcdt_solver* solver);

/* The device that the solver runs on. */
GCDT_API int32_t gcdt_solver_device(const gcdt_solver* solver, gcdt_device_info* info);

/* Gives the device memory back that the solver keeps and no result holds, and the host memory that it keeps for
 * transfers, whose threads it ends. */
GCDT_API int32_t gcdt_solver_trim(gcdt_solver* solver);

/* ---- Input ------------------------------------------------------------------------------------------------- */

/* Triangle numbers are 30 bits wide. */
#define GCDT_MAX_VERTICES 536870910u /* 2^29 - 2 */
#define GCDT_MAX_TILES 65534u        /* see gcdt_options.tiles */
#define GCDT_MAX_CONSTRAINTS 2147483647u

enum { GCDT_FLOAT64 = 0, GCDT_FLOAT32 = 1, GCDT_INT32 = 2, GCDT_INT64 = 3 };

/* Vertices and constraints in host memory: the caller's, read only during the call. Coordinates must be finite; -0
 * counts as 0. Any attributes of vertices stay with the caller, to be found by vertex number. */
typedef struct gcdt_input {
  size_t struct_size;
  int32_t coordinate_type;     /* GCDT_FLOAT64, GCDT_FLOAT32, GCDT_INT32 or GCDT_INT64 (up to 2^53 in magnitude) */
  const void* vertices;        /* vertex_count pairs x, y; may be null if there are none */
  uint64_t vertex_count;       /* 0 to GCDT_MAX_VERTICES */
  const uint32_t* constraints; /* constraint_count pairs of vertex numbers from 0, in either order; or null */
  uint64_t constraint_count;   /* 0 to GCDT_MAX_CONSTRAINTS */
} gcdt_input;
#define GCDT_INPUT_INIT \
  { sizeof(gcdt_input), GCDT_FLOAT64, NULL, 0, NULL, 0 }

/* Polygons in the vertices of an input, as ragged arrays of the caller's. */
typedef struct gcdt_rings {
  size_t struct_size;
  const uint64_t*
      ring_offsets; /* ring_count + 1, ascending from 0 to the vertex count: ring r is vertices [r] to [r + 1] */
  uint64_t ring_count;
  const uint64_t* polygon_offsets; /* polygon_count + 1, ascending from 0 to ring_count: rings of each; null: none */
  uint64_t polygon_count;
} gcdt_rings;
#define GCDT_RINGS_INIT \
  { sizeof(gcdt_rings), NULL, 0, NULL, 0 }

/* The constraints of rings, one for each vertex of `input` (whose own constraints are not read): constraint v joins
 * vertex v and the next one of its ring, so that constraints have the numbers of vertices. Rings may end with
 * their first vertex once more or not (the constraint between the two has no length, and is dropped later), may be
 * empty, single points or pairs, touch or cross themselves and each other, and overlap. They are directed as they are
 * given; or, with polygons, the first ring of each counter-clockwise and the others, its holes, clockwise, by the exact
 * sign of their area (0: as given), so that regions with a nonzero winding number are the union. `capacity` in
 * constraints, at least the vertex count. Errors: GCDT_ERROR_INVALID_ARGUMENT (offsets; indices: the first wrong one),
 * GCDT_ERROR_BUFFER_TOO_SMALL; with polygons also GCDT_ERROR_COORDINATE_NOT_FINITE, or of
 * an int64 beyond 2^53 GCDT_ERROR_COORDINATE_OUTSIDE_GRID. */
GCDT_API int32_t gcdt_ring_constraints(const gcdt_input* input, const gcdt_rings* rings, uint32_t* constraints,
                                       uint64_t capacity);

/* ---- Options ----------------------------------------------------------------------------------------------- */

/* What happens to constraints whose interiors cross, after they were split at all vertices on them. */
enum {
  GCDT_CROSSING_REJECT = 0, /* GCDT_ERROR_CONSTRAINTS_CROSS */
  GCDT_CROSSING_DROP = 1,   /* in input order, drop a constraint that crosses an earlier one that was kept */
  /* Crossings become vertices, rounded to the grid. A constraint that crosses another is routed through every vertex
   * within half a cell of it (of whose pixel it meets), and so is one that would cross a routed one. No constraint
   * moves by more than half a cell on each axis, nor across a vertex. Definition and proofs: docs/splitting.md. */
  GCDT_CROSSING_SPLIT = 2
};

/* Which triangles a result has. The mesh is made and checked whole; then those outside the domain are removed, and
 * neighbours across them become -1. A region is a set of triangles joined by edges that are not constrained; its
 * winding number says how often the constraints, taken from their first end to their second, wind around it
 * counter-clockwise. Every source of an edge counts, so borders that coincide do not cancel by chance. Borders that are
 * not closed: windings are counted from outside inwards along a shortest way (by constrained edges crossed; of several,
 * into each region across the least half edge), and open_parity and open_winding of the statistics say how many edges
 * that does not suit. An edge with one region on both sides changes nothing. */
enum {
  GCDT_DOMAIN_HULL = 0,       /* all */
  GCDT_DOMAIN_EVEN_ODD = 1,   /* regions with an odd winding number; directions do not matter */
  GCDT_DOMAIN_NONZERO = 2,    /* regions with a winding number that is not 0 */
  GCDT_DOMAIN_HOLES = 3,      /* all regions but those with a hole seed */
  GCDT_DOMAIN_OUTER = 4,      /* all regions but those that an unconstrained edge of the hull opens */
  GCDT_DOMAIN_OUTER_HOLES = 5 /* neither of the two, as with Triangle's switch -p */
};

/* Quality refinement: vertices are added until the triangles of the result have no small angles and are no larger than
 * wanted, as far as the input and the grid let them (docs/refinement.md: what is promised, and what is not). The
 * input's vertices stay; a constraint becomes a chain of edges that is within half a cell of it on one axis (a cell,
 * outside of the domain's border), and moves across no vertex. The same input gives the same bytes on every device. Up
 * to some 26 degrees it ends by itself, above that most inputs do: set a limit. A limit that is reached is no error:
 * the mesh is valid, refine_complete of the statistics is 0, and a note says so. */
enum {
  GCDT_SPLITS_ALL = 0,   /* every constraint may be split, and so may the border of the domain */
  GCDT_SPLITS_INNER = 1, /* only constraints with triangles of the domain on both sides */
  GCDT_SPLITS_NONE = 2   /* none: vertices are added inside triangles only */
};
typedef struct gcdt_refinement {
  size_t struct_size;
  double least_angle;  /* degrees, from 1 to 34, to a millionth; 0: angles do not matter */
  double most_area;    /* of a triangle, in units of the input squared; above 0; HUGE_VAL: no limit */
  double least_length; /* triangles with a shorter side are left as they are; 0: 8 cells, which is the least there is */
  uint64_t most_added; /* vertices; UINT64_MAX: no limit. Added ones of GCDT_CROSSING_SPLIT do not count */
  int32_t splits;      /* GCDT_SPLITS_... */
  int32_t conforming;  /* 1: edges beside constraints are Delaunay, too, which takes more vertices */
  const double* sizes; /* size_count lengths wanted, one a vertex of the input, above 0: the longest side of a triangle
                          is at most sqrt(2) times their mean at its corners, and they are linear between vertices.
                          Null: none. The caller's, read only during the call. Not with GCDT_CROSSING_SPLIT */
  uint64_t size_count;
  const double* region_areas; /* one for each of gcdt_options.region_seeds: most_area for the triangles of its region,
                                 HUGE_VAL: no limit. Null: none. The caller's, read only during the call; the result
                                 has regions then (gcdt_options.regions) */
  uint64_t region_area_count;
} gcdt_refinement;
/* HUGE_VAL is math.h's. */
#define GCDT_REFINEMENT_INIT \
  { sizeof(gcdt_refinement), 20.0, HUGE_VAL, 0.0, UINT64_MAX, GCDT_SPLITS_ALL, 0, NULL, 0, NULL, 0 }

/* Called between rounds by the thread that is in the call, with the phase's name and the share done in [0, 1]. Return
 * 0 to stop: the call then returns GCDT_ERROR_CANCELLED. The rules of gcdt_log_function hold. */
typedef int32_t (*gcdt_progress_function)(void* user, const char* phase, double done);

/* Host memory of the caller's. */
typedef struct gcdt_host_memory {
  void* memory; /* may be null if there are no bytes */
  uint64_t bytes;
} gcdt_host_memory;

typedef struct gcdt_options {
  size_t struct_size;
  int32_t crossing;      /* GCDT_CROSSING_... */
  int32_t check;         /* 1: prove the mesh on the device before it is returned; 0: do not */
  int32_t canonical;     /* 1: triangles in canonical order, see GCDT_TRIANGLES; 0: in any order, which costs less */
  int32_t fixed_grid;    /* 1: the grid below; 0: chosen from the input (int32 in device memory: 0, 0, "1") */
  double grid_x, grid_y; /* its origin */
  const char* grid_cell; /* the cell's edge, a decimal number such as "0.001"; null: "1" */
  gcdt_progress_function progress; /* null: none */
  void* progress_user;
  int32_t domain;  /* GCDT_DOMAIN_... */
  int32_t regions; /* 1: the arrays GCDT_REGIONS ... for GCDT_DOMAIN_HULL too; other domains have them anyway */
  /* Points x, y in the input's coordinates; the caller's, read only during the call; null if there are none. They are
   * rounded to the grid; outside the hull they do nothing; on an edge or vertex they are in the least triangle there.
   */
  const double* hole_seeds; /* used by GCDT_DOMAIN_HOLES and _OUTER_HOLES */
  uint64_t hole_seed_count; /* at most GCDT_MAX_VERTICES */
  const double* region_seeds;
  uint64_t region_seed_count;
  int32_t distinct; /* 1: vertices that differ as given must differ on the grid: else GCDT_ERROR_VERTICES_COINCIDE */
  /* New memory to which the caller will copy the result, such as 2n triangles: the system clears each page of it when
   * it is first written, which takes longer than the copy. While a GPU works, threads of gcdt_triangulate, which have
   * ended when it returns, do that by writing a byte to each page. So its contents are undefined from the call on, and
   * nobody else may use it meanwhile. The caller's; only time depends on it. Other functions and devices leave it
   * alone. */
  const gcdt_host_memory* host_room; /* null if there is none */
  uint64_t host_room_count;
  /* Of gcdt_pool_triangulate, which says more: how many tiles each problem is cut into, at most GCDT_MAX_TILES; 0: as
   * many as memory asks for, mostly 1. All other functions want 0 or 1. */
  uint32_t tiles;
  /* What the triangles of the domain are refined to; null: nothing. The caller's, read only during the call. For
   * gcdt_triangulate, gcdt_pool_triangulate and theirs of gcdt_cl.h, and to verify what they made
   * (gcdt_verify_refined); others refuse it. Of a result that is there: gcdt_result_refine. */
  const gcdt_refinement* refine;
  /* 1: the arrays of gcdt_input or gcdt_batch_input lie in memory that the devices' drivers have pinned (a mapped
   * buffer of CL_MEM_ALLOC_HOST_PTR, or what cudaHostAlloc returns): gcdt_triangulate and gcdt_pool_triangulate have
   * GPUs read it there, where other memory is copied first. Only time depends on it. */
  int32_t pinned;
} gcdt_options;
#define GCDT_OPTIONS_INIT                                                                                          \
  {                                                                                                                \
    sizeof(gcdt_options), GCDT_CROSSING_REJECT, 1, 1, 0, 0.0, 0.0, NULL, NULL, NULL, GCDT_DOMAIN_HULL, 0, NULL, 0, \
        NULL, 0, 0, NULL, 0, 0, NULL, 0                                                                            \
  }

/* ---- Triangulation ----------------------------------------------------------------------------------------- */

/* The CDT of `input` (paper: Fan et al., gCDT, 2026, sections 4 to 8). `options` may be null. Fewer than three
 * distinct vertices, or all on one line: no triangles and a note, no error. The result stays in device memory until it
 * is released. Blocks until the mesh is complete: the host reads counters after each few rounds. */
GCDT_API int32_t gcdt_triangulate(gcdt_solver* solver, const gcdt_input* input, const gcdt_options* options,
                                  gcdt_result** result);

/* ---- The result -------------------------------------------------------------------------------------------- */

/* T triangles; all vertex numbers are input numbers from 0, all constraint numbers too. */
enum {
  /* T x 3 uint32: corners, counter-clockwise. Canonical order: each triangle starts with its first vertex in Z-order
   * of the grid; triangles are sorted by the Z-order of their first, then second vertex. */
  GCDT_TRIANGLES = 0,
  /* T x 3 int32: [t][k] is the triangle across the edge opposite corner k of triangle t, -1 where there is none. */
  GCDT_NEIGHBOURS = 1,
  /* T uint8: bit k tells that the edge opposite corner k is (part of) a constraint. */
  GCDT_CONSTRAINED = 2,
  /* One uint32 per vertex, input vertices first, then added ones: the least vertex number on its grid point. */
  GCDT_REPRESENTATIVES = 3,
  /* P x 2 uint32: the constraints after cleaning, as edges of the mesh, in Z-order of their ends. */
  GCDT_PIECES = 4,
  /* P + 1 uint32: the sources of piece i are elements [i] up to [i + 1] of GCDT_SOURCES. */
  GCDT_SOURCE_OFFSETS = 5,
  /* uint32: the input constraints that run along each piece, ascending within a piece. */
  GCDT_SOURCES = 6,
  /* uint32: the input constraints dropped under GCDT_CROSSING_DROP, ascending. */
  GCDT_DROPPED = 7,
  /* One element per added vertex, which are numbered on from the input's: those of GCDT_CROSSING_SPLIT in order of
   * (x, y), then those of gcdt_options.refine in such an order, then those of each gcdt_result_refine.
   * A x 2 int32: where they are on the grid; gcdt_grid_coordinates makes numbers of that. */
  GCDT_ADDED = 8,
  /* A x 2 uint32: the least pair of input constraints that cross in the vertex's pixel, the lesser one first; of
   * refinement UINT32_MAX twice. */
  GCDT_ADDED_CROSSINGS = 9,
  /* A x 4 uint32, only with gcdt_options.refine: what refinement put the vertex on. The corners of a triangle; or the
   * two ends of an edge and UINT32_MAX. They may be added vertices themselves, and were there before it. Then, if that
   * edge was part of a constraint, the least one along it, else UINT32_MAX. Of crossings UINT32_MAX four times. */
  GCDT_ADDED_ORIGINS = 10,
  /* Of the domain, T elements, none unless asked for (gcdt_options.domain, regions). Regions are those of the hull,
   * numbered from 0 in the order of their least triangles there: numbers of removed ones are missing. */
  GCDT_REGIONS = 16,      /* uint32 */
  GCDT_DEPTHS = 17,       /* uint32: the least number of constrained edges between the region and outside */
  GCDT_WINDINGS = 18,     /* int32 */
  GCDT_REGION_SEEDS = 19, /* int32: the least of gcdt_options.region_seeds in the region, -1 without one */
  /* T uint8, only with gcdt_options.refine: GCDT_EXCUSE_... of each triangle, why it is worse than wanted. */
  GCDT_EXCUSES = 20,
  /* Made on the device when first asked for, which blocks and takes device memory; not in gcdt_required_bytes. */
  GCDT_VERTEX_TRIANGLES = 24, /* int32 per input vertex: the least triangle at its grid point, -1 without one */
  GCDT_HULL = 25, /* uint32: vertices on the convex hull, counter-clockwise from the first in Z-order; those inside its
                     edges too; none without triangles. Domains do not change it. */
  GCDT_EDGE_PIECES = 26 /* T x 3 int32: [t][k] is the element of GCDT_PIECES along the edge opposite corner k, or -1 */
};

/* Elements of an array, and bytes of one element; 0 for null or an unknown array. */
GCDT_API uint64_t gcdt_result_count(const gcdt_result* result, int32_t array);
GCDT_API size_t gcdt_element_bytes(int32_t array);

/* Copies an array to host memory with room for `capacity` elements. Too small: GCDT_ERROR_BUFFER_TOO_SMALL, and
 * nothing is written. Blocks. Its time is added to ms_output, ms_full and ms_call of the result's statistics. */
GCDT_API int32_t gcdt_result_copy(gcdt_result* result, int32_t array, void* destination, uint64_t capacity);

/* The same for `count` arrays with one wait for all of them, which is faster: arrays[i] to destinations[i] with room
 * for capacities[i] elements. An error, of the first array that is wrong, leaves all destinations as they were, but for
 * one of the device, after which what they hold is undefined. */
GCDT_API int32_t gcdt_result_copy_arrays(gcdt_result* result, const int32_t* arrays, void* const* destinations,
                                         const uint64_t* capacities, size_t count);

/* Hands the result's device memory back to its solver, for the next call. Null is allowed. */
GCDT_API void gcdt_result_release(gcdt_result* result);

/* ---- The grid ---------------------------------------------------------------------------------------------- */

/* The integer grid on which everything is exact: vertex (x, y) stands at (round((x - origin[0]) / cell),
 * round((y - origin[1]) / cell)), half to even, in [0, 2^31 - 1]^2. */
typedef struct gcdt_grid {
  size_t struct_size;
  int32_t kind; /* GCDT_GRID_... */
  double origin[2];
  uint64_t cell_units; /* the cell's edge is cell_units / 10^cell_decimals if this is not 0, else 2^cell_exponent */
  int32_t cell_decimals, cell_exponent;
  double largest_move; /* how far a coordinate was moved at most */
} gcdt_grid;
enum {
  GCDT_GRID_BINARY = 0,  /* every coordinate is a multiple of one power of two: nothing moved */
  GCDT_GRID_DECIMAL = 1, /* every coordinate is the double nearest to a decimal: exact for the numbers as written */
  GCDT_GRID_ROUNDED = 2, /* otherwise */
  GCDT_GRID_FIXED = 3    /* given by the caller */
};

/* The coordinates of grid points: for each of `count` pairs x, y of `points`, the doubles nearest to
 * origin + x cell, origin + y cell, written as a pair. Where cells are smaller than the gaps between doubles, several
 * grid points have the same. GCDT_ERROR_INVALID_ARGUMENT for a grid that is none or a point outside of it (indices: the
 * number of the pair, axis). */
GCDT_API int32_t gcdt_grid_coordinates(const gcdt_grid* grid, const int32_t* points, uint64_t count,
                                       double* coordinates);

/* The grid points to which coordinates are rounded: `count` pairs of each. GCDT_ERROR_COORDINATE_OUTSIDE_GRID, or
 * GCDT_ERROR_COORDINATE_NOT_FINITE, with the number of the pair and the axis. */
GCDT_API int32_t gcdt_grid_points(const gcdt_grid* grid, const double* coordinates, uint64_t count, int32_t* points);

/* The double nearest to the edge of a cell. */
GCDT_API double gcdt_grid_cell(uint64_t cell_units, int32_t cell_decimals, int32_t cell_exponent);

/* The grid that gcdt_triangulate chooses for the vertices of `input`, by host arithmetic; with `fixed` not null, that
 * of its fixed_grid and grid_... members if fixed_grid is 1. Sets grid->struct_size. */
GCDT_API int32_t gcdt_choose_grid(const gcdt_input* input, const gcdt_options* fixed, gcdt_grid* grid);

/* ---- Statistics, quality and notes of a result ------------------------------------------------------------- */

typedef struct gcdt_statistics {
  size_t struct_size;
  uint64_t n, m; /* input vertices and constraints */
  uint64_t vertices_merged, constraints_zero, constraints_pieces, constraints_overlapping;
  uint64_t crossings, constraints_dropped, vertices_added, triangles;
  gcdt_grid grid; /* its struct_size is set by the library */
  /* Milliseconds on the host's clock (docs/statistics.md). The phases: order .. output, and domain; full: their sum,
   * copies of results to the host included; build: building programs, which is in none of these. core: from distinct
   * vertices on the grid and clean constraints in device memory to triangles and neighbours there, in any order,
   * unchecked: sorting the vertices, insert, constrain without clean but with walk, flip, and gather. */
  double ms_core, ms_full, ms_build, ms_order, ms_insert, ms_constrain, ms_flip, ms_check, ms_output;
  uint64_t rounds_insert, rounds_flip, flips, history_depth, location_steps, launches, read_backs;
  uint64_t crossed_pairs;     /* (triangle, constraint) pairs crossed by the first walk */
  uint64_t peak_device_bytes; /* in buffers at once during the call; results of other calls are not counted */
  uint64_t held_device_bytes; /* what the solver held at most during the call, in use or kept */
  uint64_t edge_splits, constraint_hits, existing_edges, pieces_walked, chain_vertices, holes;
  uint64_t symbolic_chain_vertices;
  const char *device, *driver, *platform, *version; /* the result's, until it is released */
  double ms_domain;
  uint64_t regions, triangles_removed, deepest; /* regions of the hull, 0 unless labelled; the largest depth */
  uint64_t open_parity, open_winding;           /* see GCDT_DOMAIN_...: 0 where borders are closed */
  uint64_t constraints_split;                   /* constraints that may have been moved by GCDT_CROSSING_SPLIT */
  double constraint_move; /* the largest distance of one from its edges, in the units of the input */
  double ms_clean;        /* part of constrain: cleaning the constraints */
  double ms_call;   /* gcdt_triangulate or its like, and copies of the result, on the caller's clock; with build */
  double ms_walk;   /* part of clean: parts of constraints and the walk along them, as enforcing needs, too */
  double ms_gather; /* part of output: finding the finite triangles, and writing them and their neighbours */
  /* How two constraints lie in a triangle that they cross (paper, figure 6): both cut off one corner, both come from
   * one, each cuts off another, one cuts off a corner and one comes from another. Once for each edge of the triangle
   * on which the one nearest to an end is not the nearest to the other. */
  uint64_t pairs_cut_one_corner, pairs_from_one_corner, pairs_cut_two_corners, pairs_cut_and_from;
  /* Of vertices_merged those that differ, as given, from the vertex that stands for them: rounding made them one. The
   * pair: the first of them behind the vertex that stands for it; 0, 0 if there is none. */
  uint64_t vertices_rounded_together;
  uint32_t rounded_pair[2];
  /* Of gcdt_options.refine, in whose time ms_refine new vertices were ordered and checked, too; vertices_added has
   * these as well. complete: 0 if most_added ended it. bent: not exactly on their constraint or edge of the hull; far:
   * more than half a cell off on one axis; move: the largest distance, in units of the input. encroached: sides of
   * triangles that are constraints, or border, and have the third corner in the lens (docs/refinement.md). Then
   * triangles that are not as wanted, each by the first reason that holds: the angle is between two constraints; the
   * shortest side is beside such an angle; a side is shorter than least_length, or the grid has no place; what must not
   * be split is in the way; what could not be split is; nothing but most_added. GCDT_EXCUSES says it of each. */
  double ms_refine;
  uint64_t refine_complete, refine_rounds, refine_added, refine_on_subsegments, refine_bent, refine_far;
  double refine_move;
  uint64_t refine_encroached, refine_left_input_angle, refine_left_beside_angle, refine_left_grid, refine_left_fixed,
      refine_left_refused, refine_left_limit;
  uint64_t refine_left_target; /* of refine_left_grid: GCDT_EXCUSE_TARGET */
} gcdt_statistics;

GCDT_API int32_t gcdt_result_statistics(const gcdt_result* result, gcdt_statistics* statistics);

/* Areas and angles of the result's triangles, measured exactly on the device when asked, in integers; the last step, to
 * degrees and units of the input, is in double on the host. Nothing but zeros and -1 without triangles. */
typedef struct gcdt_quality {
  size_t struct_size;
  uint64_t triangles;
  double least_angle, largest_angle;                    /* degrees */
  int32_t least_angle_triangle, largest_angle_triangle; /* the least triangle with such an angle, or -1 */
  double least_area, largest_area, area;                /* of a triangle, and of all; in units of the input squared */
  uint64_t least_doubled, largest_doubled, doubled;     /* twice the same, in cells squared, exactly */
} gcdt_quality;

GCDT_API int32_t gcdt_result_quality(gcdt_result* result, gcdt_quality* quality);

/* Remarks such as that all vertices lie on one line; null from the last on. The result's, until it is released. */
GCDT_API const char* gcdt_result_note(const gcdt_result* result, size_t number);

/* ---- Refinement of a result -------------------------------------------------------------------------------- */

/* Refines `result`, without its input: *refined is, to the byte, the result of the call that made `result` with
 * `refine` among its options. One that is refined already is refined further: its vertices stay, those that are added
 * now have the last numbers, and nothing is added to what is as wanted. Of one of gcdt_adopt the domain is what its
 * triangles cover; edges that are neither constraints nor around it are made Delaunay. Of `options` (may be null)
 * check, canonical and progress are read; the result has the rest, which must be 0. `result` stays as it is, whatever
 * happens, and may be refined again, to other bounds; the two share nothing, and may be released in any order. The
 * statistics are those of `result` with the refinement's added; refine_added and the counts beside it, times, launches
 * and bytes are of this call, which takes as much device memory beside `result` as that other call
 * (gcdt_required_bytes_refined; vertices that were added before are of its n). GCDT_ERROR_INVALID_ARGUMENT: what a call
 * refuses; region_areas, if `result` has no regions. Blocks. */
GCDT_API int32_t gcdt_result_refine(gcdt_result* result, const gcdt_refinement* refine, const gcdt_options* options,
                                    gcdt_result** refined);

/* ---- Meshes that are there already ------------------------------------------------------------------------- */

/* A result of a mesh made earlier, by this library or another: to be asked all that a result is asked. `input` has its
 * vertices, and the constraints to be flagged, which run along its edges or outside of it; of `mesh` only `triangles`
 * are read, counter-clockwise, which keep their numbers and first corners. They need not be Delaunay, nor cover the
 * convex hull, nor be connected. Of `options` (may be null) grid, progress and check are read; crossing, domain and
 * regions must be 0. Proved on the way, on the grid, which is chosen as by gcdt_triangulate: triangles do not overlap,
 * and no vertex of `input` is inside one or inside an edge; else GCDT_ERROR_CHECK_FAILED, with indices: the triangle,
 * or the constraint that crosses an edge. A corner that does not exist: GCDT_ERROR_INVALID_ARGUMENT, indices: triangle,
 * corner. What lies between mesh and convex hull is triangulated, too, but not in the result: triangles_removed of the
 * statistics. Costs about as much as gcdt_triangulate with all edges as constraints. Blocks. */
GCDT_API int32_t gcdt_adopt(gcdt_solver* solver, const gcdt_input* input, const gcdt_mesh* mesh,
                            const gcdt_options* options, gcdt_result** result);

/* ---- Points in the mesh ------------------------------------------------------------------------------------ */

/* For `count` points in host memory (coordinate_type as for gcdt_input), on the device: triangles[i] is the least
 * triangle that holds point i, its border included, or -1; weights (may be null) its barycentric weights, three a point
 * in the order of the corners, 0 outside. Points are rounded to the grid as vertices are, and the answer is exact
 * there; what is not on the grid is outside. GCDT_ERROR_COORDINATE_NOT_FINITE: indices: point, axis. Takes about 100
 * bytes of device memory a point, for 2^20 points at a time, and 8 bytes a vertex until the result is released. Blocks.
 */
GCDT_API int32_t gcdt_locate(gcdt_result* result, int32_t coordinate_type, const void* points, uint64_t count,
                             int32_t* triangles, double* weights);

/* The same for the values there, linear in each triangle: vertex_values has one number a vertex, those of the input
 * first, then those of added ones (gcdt_added_values), of which those of corners (representatives) are read; values[i]
 * is `outside` where no triangle is. Summed on the host. */
GCDT_API int32_t gcdt_interpolate(gcdt_result* result, int32_t coordinate_type, const void* points, uint64_t count,
                                  const double* vertex_values, double outside, double* values);

/* Values for the `count` vertices that GCDT_CROSSING_SPLIT has added to `input`: at each the mean of what the two
 * constraints of its pair have, linear between their ends, at their points nearest to it. added: count x 2 coordinates
 * (gcdt_grid_coordinates); crossings: GCDT_ADDED_CROSSINGS; vertex_values: one a vertex of the input; values: `count`,
 * the caller's. In double precision on the host. GCDT_ERROR_INVALID_ARGUMENT: a constraint that does not exist. */
GCDT_API int32_t gcdt_added_values(const gcdt_input* input, const double* added, const uint32_t* crossings,
                                   uint64_t count, const double* vertex_values, double* values);

/* The same with vertices that gcdt_options.refine has added: at each what is linear on what it was put on, between
 * the two ends or three corners that `origins` has (GCDT_ADDED_ORIGINS, count x 4), each of which may be added
 * itself. GCDT_ERROR_INVALID_ARGUMENT, too: origins that do not exist, or that need each other. */
GCDT_API int32_t gcdt_refined_values(const gcdt_input* input, const double* added, const uint32_t* crossings,
                                     const uint32_t* origins, uint64_t count, const double* vertex_values,
                                     double* values);

/* ---- Memory ------------------------------------------------------------------------------------------------ */

/* The device memory that triangulating n vertices and m constraints needs at most, in bytes, and so the size of a
 * workspace (gcdt_cl_set_workspace); the caller's own buffers are not in it. `crossed`: the (triangle, constraint)
 * pairs that the constraints cross (crossed_pairs of the statistics), known after the first walk; UINT64_MAX stands
 * for the worst case, all triangles. Count a constraint that runs through k vertices as k + 1. Listing and
 * splitting constraints that cross are not in it; what is split needs as much as its result would as an input. A solver
 * with memory of its own keeps what it has used for its next calls, up to half as much again, and does with less where
 * the device is short of memory. */
GCDT_API uint64_t gcdt_required_bytes(uint64_t n, uint64_t m, uint64_t crossed);

/* The same for a call with gcdt_options.refine that adds at most `added` vertices (gcdt_refinement.most_added):
 * UINT64_MAX if that is no limit. Memory is taken as vertices are added, by half of them at a time, so that most calls
 * need much less. */
GCDT_API uint64_t gcdt_required_bytes_refined(uint64_t n, uint64_t m, uint64_t crossed, uint64_t added);

/* ---- Verification, on the host and on the device ----------------------------------------------------------- */

/* A mesh to be verified; triangle order and first corners are free. The caller's, read only. */
struct gcdt_mesh {
  size_t struct_size;
  const uint32_t* triangles; /* triangle_count x 3 */
  uint64_t triangle_count;
  const int32_t* neighbours;  /* triangle_count x 3, or null: not verified */
  const uint8_t* constrained; /* triangle_count, or null: not verified */
  const int32_t* added; /* GCDT_CROSSING_SPLIT, refine: added_count x 2, the added vertices on the grid; or null */
  uint64_t added_count; /* their numbers follow those of the input */
  const uint32_t* added_origins; /* refine: added_count x 4, as GCDT_ADDED_ORIGINS; null: not known */
};
#define GCDT_MESH_INIT \
  { sizeof(gcdt_mesh), NULL, 0, NULL, NULL, NULL, 0, NULL }

/* Proves that `mesh` is the CDT of `input` on `grid`, by exact arithmetic on the host that shares no code with the
 * solver: GCDT_OK, or GCDT_ERROR_NOT_VALID and gcdt_last_error(NULL) with the first failure. Never another error for
 * a bad mesh: an index that does not exist is a failure. `crossing`: how the mesh was made; under GCDT_CROSSING_DROP
 * it is also proved that exactly the right constraints are missing, under GCDT_CROSSING_SPLIT that every added vertex
 * is in the pixel of a crossing, that all crossings are vertices, and that each constraint is either as under
 * GCDT_CROSSING_REJECT or runs through exactly the vertices whose pixels it meets. O((n + m) log n) expected. */
GCDT_API int32_t gcdt_verify(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_grid* grid, int32_t crossing);

/* What is said of each triangle of a gcdt_mesh; null: not verified. The caller's, read only. */
typedef struct gcdt_regions {
  size_t struct_size;
  const uint32_t* regions; /* as GCDT_REGIONS, of a mesh in canonical order */
  const uint32_t* depths;
  const int32_t* windings;
} gcdt_regions;

/* As gcdt_verify, of a mesh made with `options`, of which crossing, domain and hole seeds are read: exactly the
 * triangles of the domain are there, neighbours across removed ones are -1, and `regions` (may be null) are right. The
 * whole triangulation is made once more for that, by another algorithm on the host, and proved. */
GCDT_API int32_t gcdt_verify_domain(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_regions* regions,
                                    const gcdt_grid* grid, const gcdt_options* options);

/* Why a triangle of a refined mesh may be worse than wanted. */
enum {
  GCDT_EXCUSE_NONE = 0,         /* it is as wanted */
  GCDT_EXCUSE_INPUT_ANGLE = 1,  /* its least angle is between two constraints, or edges of the hull */
  GCDT_EXCUSE_BESIDE_ANGLE = 2, /* its shortest side joins two of them beside their common end, about as far from it */
  GCDT_EXCUSE_SHORT_SIDE = 3,   /* a side is shorter than 8 cells, or than least_length */
  GCDT_EXCUSE_LIMIT = 4,        /* a vertex would mend it, but the call had a limit of vertices, which it has reached */
  GCDT_EXCUSE_TARGET = 5,       /* the place of that vertex, on the grid, is too near another one */
  GCDT_EXCUSE_FIXED = 6,        /* a constraint, or edge of the hull, is in its way that may not be split */
  GCDT_EXCUSE_REFUSED = 7 /* such are in its way, and none has a place on the grid to be split at, or is too short */
};
typedef struct gcdt_refined_report {
  size_t struct_size;
  uint64_t input_angle, beside_angle, short_side, limit; /* triangles that are not as wanted, by their excuse */
  uint64_t on_constraints, far;    /* added vertices on constraints and edges of the hull; more than half a cell off */
  double move;                     /* the largest distance of one from there, in units of the input */
  uint64_t encroached;             /* if conforming: sides on those with the corner across in the circle over them */
  uint64_t target, fixed, refused; /* more triangles, by their excuse */
  uint64_t refinements; /* one after the other (gcdt_result_refine): rows of added vertices, each in order of (x, y) */
} gcdt_refined_report;

/* Proves that `mesh` is the domain of `input` refined as `options` say, of which refine, crossing (not
 * GCDT_CROSSING_SPLIT), domain, hole and region seeds are read; from these alone, as gcdt_verify does. The triangles
 * are exactly those of the domain in the CDT (with the tie rule) of all vertices under chains of edges, into which the
 * constraints, cut where vertices of the input are on them, and the edges of the hull have gone: each chain in order,
 * within half a cell on one axis, or a cell beside what is not of the domain; no vertex of the input is on another side
 * of it. No chain that refine.splits fixes is split. Angles and areas are at least and at most what least_angle,
 * most_area and region_areas say, and sides as short as sizes, which need mesh->added_origins, or the triangle is
 * excused: excuses[t] (null, or one for each triangle) is GCDT_EXCUSE_..., and `report`, which may be null, has their
 * sums. If conforming, no corner is in the circle over a constraint that could be split. Without mesh->constrained
 * chains are sought among all edges. Costs about as much as gcdt_verify_domain twice. */
GCDT_API int32_t gcdt_verify_refined(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_grid* grid,
                                     const gcdt_options* options, gcdt_refined_report* report, uint8_t* excuses);

/* The check that gcdt_triangulate makes of its own meshes, on the device, of any mesh in host memory that covers the
 * convex hull: neighbours and constrained must be there, triangles may stand in any order and begin with any corner.
 * `input` has the vertices, and as constraints those after cleaning (GCDT_PIECES), each once: those that must be
 * flagged edges. The grid is that of `options` (may be null) if fixed, else the one of the vertices.
 * GCDT_ERROR_CHECK_FAILED names the first fault. For less trust in the device see gcdt_verify. Blocks. */
GCDT_API int32_t gcdt_check(gcdt_solver* solver, const gcdt_input* input, const gcdt_mesh* mesh,
                            const gcdt_options* options);

/* What a mesh that is valid on the grid is worth at the coordinates that were given, which may have been rounded. */
typedef struct gcdt_assessment {
  size_t struct_size;
  int32_t valid;               /* 1: all of the following are right, and edges do not cross */
  int32_t outline_simple;      /* 1: the outline of the mesh does not meet itself (it need not be convex) */
  uint64_t triangles_inverted; /* clockwise at the given coordinates */
  uint64_t triangles_flat;     /* all corners on one line */
  uint64_t vertices_lost;      /* vertices that were merged with one that was given elsewhere */
  uint64_t
      edges_not_delaunay; /* unconstrained inner edges with a vertex strictly inside a circle; no fault of `valid` */
} gcdt_assessment;

/* Assesses `mesh`, the triangulation of `input` on `grid`, in exact arithmetic on the doubles (every coordinate type
 * converts to those), on the host. mesh->neighbours are needed; without mesh->constrained every inner edge counts as
 * unconstrained. Added vertices are where gcdt_grid_coordinates has them. Triangles must cover a convex outline on
 * the grid: no domain but the hull. Sets all but assessment->struct_size, which the caller sets. O(n log n). */
GCDT_API int32_t gcdt_assess(const gcdt_input* input, const gcdt_mesh* mesh, const gcdt_grid* grid,
                             gcdt_assessment* assessment);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* The C interface from C: arguments that make no sense, versions of structures, errors, the whole way of a mesh. */
#include <gcdt/gcdt_cl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;
#define CHECK(holds) \
  ((holds) ? (void)0 : (void)(++failures, fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #holds)))

static gcdt_error last(const gcdt_solver* solver) {
  gcdt_error error = GCDT_ERROR_INIT;
  CHECK(gcdt_last_error(solver, &error) == GCDT_OK);
  return error;
}

static const double corners[8] = {0, 0, 8, 0, 8, 6, 0, 6};
static const uint32_t diagonals[4] = {0, 2, 1, 3};

static gcdt_input square(void) {
  gcdt_input input = GCDT_INPUT_INIT;
  input.vertices = corners;
  input.vertex_count = 4;
  return input;
}

/* Copies of several arrays are what copies of each are, with as many waits as one of them has: one, or none where the
 * device's memory is the host's; or nothing is written. */
static void check_copies(gcdt_solver* solver, gcdt_result* result, const uint32_t* triangles,
                         const int32_t* neighbours, const uint8_t* constrained) {
  uint32_t some_triangles[7] = {7, 7, 7, 7, 7, 7, 7}, dropped[1] = {7};
  int32_t some_neighbours[6];
  uint8_t flags[2];
  const int32_t arrays[4] = {GCDT_TRIANGLES, GCDT_DROPPED, GCDT_CONSTRAINED, GCDT_NEIGHBOURS};
  void* destinations[4];
  uint64_t capacities[4] = {2, 1, 2, 1};
  gcdt_statistics before, after;
  uint64_t waits;
  destinations[0] = some_triangles, destinations[1] = dropped, destinations[2] = flags;
  destinations[3] = some_neighbours;
  CHECK(gcdt_result_copy_arrays(result, arrays, destinations, capacities, 4) == GCDT_ERROR_BUFFER_TOO_SMALL);
  CHECK(last(solver).indices[0] == 2 && last(solver).indices[1] == 1);
  CHECK(some_triangles[0] == 7);
  capacities[3] = 2;
  destinations[2] = NULL;
  CHECK(gcdt_result_copy_arrays(result, arrays, destinations, capacities, 4) == GCDT_ERROR_INVALID_ARGUMENT);
  destinations[2] = flags;
  CHECK(gcdt_result_copy_arrays(result, arrays, destinations, NULL, 4) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_result_copy_arrays(NULL, arrays, destinations, capacities, 4) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_result_copy_arrays(result, NULL, NULL, NULL, 0) == GCDT_OK);
  CHECK(some_triangles[0] == 7);
  before.struct_size = after.struct_size = sizeof before;
  CHECK(gcdt_result_statistics(result, &before) == GCDT_OK);
  CHECK(gcdt_result_copy(result, GCDT_CONSTRAINED, flags, 2) == GCDT_OK);
  CHECK(gcdt_result_statistics(result, &after) == GCDT_OK);
  waits = after.read_backs - before.read_backs;
  CHECK(waits <= 1);
  memset(flags, 7, 2);
  before = after;
  CHECK(gcdt_result_copy_arrays(result, arrays, destinations, capacities, 4) == GCDT_OK);
  CHECK(gcdt_result_statistics(result, &after) == GCDT_OK);
  CHECK(after.read_backs == before.read_backs + waits);
  CHECK(memcmp(some_triangles, triangles, 24) == 0 && some_triangles[6] == 7 && dropped[0] == 7);
  CHECK(memcmp(some_neighbours, neighbours, 24) == 0 && memcmp(flags, constrained, 2) == 0);
}

static void check_mesh(gcdt_solver* solver, int canonical) {
  gcdt_input input = square();
  gcdt_options options = GCDT_OPTIONS_INIT;
  options.canonical = canonical;
  gcdt_result* result = NULL;
  input.constraints = diagonals;
  input.constraint_count = 1;
  CHECK(gcdt_triangulate(solver, &input, canonical ? NULL : &options, &result) == GCDT_OK);
  CHECK(gcdt_result_count(result, GCDT_TRIANGLES) == 2);
  CHECK(gcdt_result_count(result, GCDT_REPRESENTATIVES) == 4);
  CHECK(gcdt_result_count(result, GCDT_SOURCE_OFFSETS) == 2);
  CHECK(gcdt_result_count(result, 99) == 0 && gcdt_result_count(NULL, 0) == 0 && gcdt_element_bytes(-1) == 0);

  uint32_t triangles[9] = {7, 7, 7, 7, 7, 7, 7, 7, 7};
  int32_t neighbours[6];
  uint8_t constrained[2];
  CHECK(gcdt_result_copy(result, GCDT_TRIANGLES, triangles, 1) == GCDT_ERROR_BUFFER_TOO_SMALL);
  CHECK(triangles[0] == 7);
  gcdt_error error = last(solver);
  CHECK(error.status == GCDT_ERROR_BUFFER_TOO_SMALL && error.index_count == 2);
  CHECK(error.indices[0] == 2 && error.indices[1] == 1);
  CHECK(gcdt_result_copy(result, GCDT_TRIANGLES, NULL, 2) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_result_copy(result, 1000, triangles, 3) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_result_copy(result, GCDT_TRIANGLES, triangles, 3) == GCDT_OK);
  CHECK(triangles[5] != 7 && triangles[6] == 7);
  CHECK(gcdt_result_copy(result, GCDT_NEIGHBOURS, neighbours, 2) == GCDT_OK);
  CHECK(gcdt_result_copy(result, GCDT_CONSTRAINED, constrained, 2) == GCDT_OK);
  check_copies(solver, result, triangles, neighbours, constrained);

  gcdt_statistics statistics;
  statistics.struct_size = sizeof statistics;
  CHECK(gcdt_result_statistics(result, &statistics) == GCDT_OK);
  CHECK(statistics.struct_size == sizeof statistics && statistics.triangles == 2 && statistics.n == 4);
  CHECK(strcmp(statistics.version, gcdt_version()) == 0 && gcdt_result_note(result, 0) == NULL);
  CHECK(statistics.peak_device_bytes <= gcdt_required_bytes(4, 1, UINT64_MAX));
  gcdt_mesh mesh = GCDT_MESH_INIT;
  mesh.triangles = triangles;
  mesh.triangle_count = 2;
  mesh.neighbours = neighbours;
  mesh.constrained = constrained;
  CHECK(gcdt_verify(&input, &mesh, &statistics.grid, GCDT_CROSSING_REJECT) == GCDT_OK);
  triangles[1] = 1000000;
  CHECK(gcdt_verify(&input, &mesh, &statistics.grid, GCDT_CROSSING_REJECT) == GCDT_ERROR_NOT_VALID);
  CHECK(strlen(last(NULL).message) > 0);
  gcdt_grid grid;
  CHECK(gcdt_choose_grid(&input, NULL, &grid) == GCDT_OK);
  CHECK(grid.kind == GCDT_GRID_BINARY && grid.origin[0] == 0 && grid.cell_exponent == statistics.grid.cell_exponent);
  gcdt_result_release(result);
}

static void check_errors(gcdt_solver* solver) {
  gcdt_input input = square();
  gcdt_options options = GCDT_OPTIONS_INIT;
  gcdt_result* result = NULL;
  CHECK(gcdt_triangulate(NULL, &input, NULL, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_triangulate(solver, NULL, NULL, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_triangulate(solver, &input, NULL, NULL) == GCDT_ERROR_INVALID_ARGUMENT);
  input.struct_size = 3;
  CHECK(gcdt_triangulate(solver, &input, NULL, &result) == GCDT_ERROR_STRUCT_SIZE);
  input = square();
  options.struct_size = sizeof options + 8;
  CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_ERROR_STRUCT_SIZE);
  options.struct_size = sizeof options;
  options.crossing = 5;
  CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  options.crossing = GCDT_CROSSING_REJECT;
  options.fixed_grid = 1;
  options.grid_cell = "no number";
  CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  options.fixed_grid = 0;
  options.grid_cell = NULL;
  options.host_room_count = 1;
  CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  gcdt_host_memory room = {NULL, 1};
  options.host_room = &room;
  CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  options.struct_size = offsetof(gcdt_options, host_room); /* as it was before */
  CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_OK);
  gcdt_result_release(result);
  result = NULL;
  options.struct_size = sizeof options;
  room.bytes = 0;
  CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_OK);
  gcdt_result_release(result);
  result = NULL;
  options.fixed_grid = 1;
  options.grid_x = 1;
  CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_ERROR_COORDINATE_OUTSIDE_GRID);
  CHECK(last(solver).index_count == 2 && last(solver).indices[0] == 0 && last(solver).indices[1] == 0);
  CHECK(result == NULL);
}

static void check_input_errors(gcdt_solver* solver) {
  gcdt_input input = square();
  gcdt_result* result = NULL;
  input.vertices = NULL;
  CHECK(gcdt_triangulate(solver, &input, NULL, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  input = square();
  input.coordinate_type = 1000;
  CHECK(gcdt_triangulate(solver, &input, NULL, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  input = square();
  input.vertex_count = (uint64_t)GCDT_MAX_VERTICES + 1;
  CHECK(gcdt_triangulate(solver, &input, NULL, &result) == GCDT_ERROR_TOO_MANY_VERTICES);
  input = square();
  input.constraint_count = 1;
  CHECK(gcdt_triangulate(solver, &input, NULL, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  input.constraints = diagonals;
  input.constraint_count = (uint64_t)GCDT_MAX_CONSTRAINTS + 1;
  CHECK(gcdt_triangulate(solver, &input, NULL, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  const uint32_t wrong[4] = {0, 1, 4, 0};
  input.constraints = wrong;
  input.constraint_count = 2;
  CHECK(gcdt_triangulate(solver, &input, NULL, &result) == GCDT_ERROR_INDEX_OUT_OF_RANGE);
  CHECK(last(NULL).indices[0] == 1 && last(NULL).indices[1] == 0);
  input.constraints = diagonals;
  CHECK(gcdt_triangulate(solver, &input, NULL, &result) == GCDT_ERROR_CONSTRAINTS_CROSS);
  CHECK(last(solver).pair_count == 1 && last(solver).index_count == 2 && strlen(last(solver).message) > 0);
  CHECK(result == NULL);
}

/* What has no device between it and the arrays: a count that cannot be is refused before anything is read. */
static void check_counts_on_the_host(void) {
  const double at[2] = {0.5, 0.5}, values[4] = {0, 0, 0, 0};
  const uint32_t crossing[2] = {0, 1};
  double value = 0;
  gcdt_input input = square();
  input.constraints = diagonals;
  input.constraint_count = 2;
  CHECK(gcdt_added_values(&input, at, crossing, 1, values, &value) == GCDT_OK);
  input.vertex_count = UINT64_MAX;
  CHECK(gcdt_added_values(&input, at, crossing, 1, values, &value) == GCDT_ERROR_TOO_MANY_VERTICES);
  gcdt_grid grid;
  memset(&grid, 0, sizeof grid);
  grid.struct_size = sizeof grid;
  CHECK(gcdt_choose_grid(&input, NULL, &grid) == GCDT_ERROR_TOO_MANY_VERTICES);
  input = square();
  input.constraints = diagonals;
  input.constraint_count = UINT64_MAX;
  CHECK(gcdt_added_values(&input, at, crossing, 1, values, &value) == GCDT_ERROR_INVALID_ARGUMENT);
}

/* Constraints without vertices have no ends. */
static void check_constraints_alone(gcdt_solver* solver) {
  gcdt_input input = GCDT_INPUT_INIT;
  gcdt_options options = GCDT_OPTIONS_INIT;
  gcdt_result* result = NULL;
  input.constraints = diagonals;
  input.constraint_count = 2;
  for (options.crossing = 0; options.crossing < 3; ++options.crossing) {
    CHECK(gcdt_triangulate(solver, &input, &options, &result) == GCDT_ERROR_INDEX_OUT_OF_RANGE);
    CHECK(last(solver).index_count == 2 && last(solver).indices[0] == 0 && last(solver).indices[1] == 0);
  }
  CHECK(result == NULL);
}

static int32_t reenter(void* user, const char* phase, double done) {
  gcdt_solver* solver = *(gcdt_solver**)user;
  (void)phase, (void)done;
  CHECK(gcdt_solver_trim(solver) == GCDT_ERROR_IN_USE);
  return 0;
}

static void count_line(void* user, int32_t level, const char* message) {
  CHECK((level == GCDT_LOG_WARNING || level == GCDT_LOG_INFORMATION) && message != NULL);
  ++*(int*)user;
}

/* A square, nothing, a square whose diagonals cross, and a square with an end that is no vertex. */
static void check_batch(const char* device) {
  const double vertices[] = {0, 0, 8, 0, 8, 6, 0, 6, 0, 0, 8, 0, 8, 6, 0, 6, 0, 0, 8, 0, 8, 6, 0, 6};
  const uint64_t vertex_offsets[] = {0, 4, 4, 8, 12}, constraint_offsets[] = {0, 1, 1, 3, 5};
  const uint32_t constraints[] = {0, 2, 0, 2, 1, 3, 0, 1, 1, 4};
  gcdt_pool_options options = GCDT_POOL_OPTIONS_INIT;
  gcdt_pool* pool = NULL;
  options.devices = device;
  CHECK(gcdt_pool_create(&options, NULL) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_pool_create(&options, &pool) == GCDT_OK);
  if (!pool) return;
  gcdt_batch_input input = GCDT_BATCH_INPUT_INIT;
  input.problem_count = 4;
  input.vertices = vertices, input.vertex_offsets = vertex_offsets;
  input.constraints = constraints, input.constraint_offsets = constraint_offsets;
  gcdt_batch* batch = NULL;
  CHECK(gcdt_pool_triangulate(pool, &input, NULL, &batch) == GCDT_OK);
  gcdt_problem problem;
  problem.struct_size = sizeof problem;
  CHECK(gcdt_batch_problem(batch, 0, &problem) == GCDT_OK && problem.status == GCDT_OK && problem.triangles == 2);
  CHECK(problem.grid.kind == GCDT_GRID_BINARY && problem.message[0] == '\0');
  CHECK(gcdt_batch_problem(batch, 1, &problem) == GCDT_OK && problem.status == GCDT_OK && problem.triangles == 0);
  CHECK(gcdt_batch_problem(batch, 2, &problem) == GCDT_OK && problem.status == GCDT_ERROR_CONSTRAINTS_CROSS);
  CHECK(problem.pair_count == 1 && problem.index_count == 2 && problem.indices[0] == 0 && problem.indices[1] == 1);
  CHECK(gcdt_batch_problem(batch, 3, &problem) == GCDT_OK && problem.status == GCDT_ERROR_INDEX_OUT_OF_RANGE);
  CHECK(problem.index_count == 2 && problem.indices[0] == 1 && problem.indices[1] == 1);
  CHECK(gcdt_batch_problem(batch, 4, &problem) == GCDT_ERROR_INVALID_ARGUMENT);
  uint32_t triangles[6];
  uint64_t offsets[5];
  CHECK(gcdt_batch_copy(batch, GCDT_TRIANGLES, triangles, 1, offsets) == GCDT_ERROR_BUFFER_TOO_SMALL);
  CHECK(last(NULL).index_count == 2 && last(NULL).indices[0] == 2);
  CHECK(gcdt_batch_copy(batch, GCDT_TRIANGLES, triangles, 2, offsets) == GCDT_OK);
  CHECK(offsets[1] == 2 && offsets[4] == 2 && triangles[0] == 0 && triangles[5] == 3);
  gcdt_batch_statistics statistics;
  statistics.struct_size = sizeof statistics;
  CHECK(gcdt_batch_get_statistics(batch, &statistics) == GCDT_OK && statistics.failed == 2);
  gcdt_pool_device used;
  used.struct_size = sizeof used;
  CHECK(gcdt_pool_device_count(pool) >= 1 && gcdt_pool_device_count(NULL) == 0);
  CHECK(gcdt_pool_device_get(pool, 0, &used) == GCDT_OK && used.status == GCDT_OK && used.info.name[0] != '\0');
  CHECK(gcdt_pool_device_get(pool, 99, &used) == GCDT_ERROR_INVALID_ARGUMENT);
  input.struct_size = 3;
  CHECK(gcdt_pool_triangulate(pool, &input, NULL, &batch) == GCDT_ERROR_STRUCT_SIZE);
  CHECK(gcdt_cl_pool_create(1, NULL, NULL, &pool) == GCDT_ERROR_INVALID_ARGUMENT);
  gcdt_cl_batch_input buffers = GCDT_CL_BATCH_INPUT_INIT;
  CHECK(gcdt_cl_pool_triangulate(pool, NULL, &buffers, NULL, 0, NULL, &batch) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(strstr(last(NULL).message, "queue") != NULL);
  CHECK(gcdt_cl_batch_copy(batch, GCDT_TRIANGLES, NULL, NULL, 0, 0, NULL, 0, NULL) == GCDT_ERROR_INVALID_ARGUMENT);
  gcdt_pool_release(pool);
  gcdt_batch_release(batch);
  gcdt_pool_release(NULL);
  gcdt_batch_release(NULL);
}

int main(void) {
  const char* device = getenv("GCDT_TEST_DEVICE") ? getenv("GCDT_TEST_DEVICE") : "Portable Computing Language";
  size_t count = 0, number = 0;
  CHECK(gcdt_device_count(&count) == GCDT_OK && count > 0);
  CHECK(gcdt_device_count(NULL) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_device_select(device, &number, NULL) == GCDT_OK && number < count);
  CHECK(gcdt_device_select("no such thing", &number, NULL) == GCDT_ERROR_NO_DEVICE);
  CHECK(strstr(last(NULL).message, "no such thing") != NULL);
  gcdt_device_info info;
  info.struct_size = sizeof info;
  CHECK(gcdt_device_get(number, &info) == GCDT_OK && info.name[0] != '\0');
  CHECK(gcdt_device_get(count, &info) == GCDT_ERROR_NO_DEVICE);
  CHECK(strcmp(gcdt_strerror(GCDT_OK), "done") == 0);
  for (int32_t status = GCDT_ERROR_INTERNAL; status <= GCDT_ERROR_INVALID_ARGUMENT; ++status)
    CHECK(strcmp(gcdt_strerror(status), gcdt_strerror(1)) != 0);
  CHECK(strstr(gcdt_strerror(CL_OUT_OF_RESOURCES), "OpenCL") != NULL && strstr(gcdt_strerror(-999), "OpenCL") != NULL);

  int lines = 0;
  gcdt_solver_options options = GCDT_SOLVER_OPTIONS_INIT;
  options.device = device;
  options.log = count_line;
  options.log_user = &lines;
  gcdt_solver* solver = NULL;
  CHECK(gcdt_solver_create(&options, NULL) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_solver_create(&options, &solver) == GCDT_OK);
  if (!solver) return 1;
  CHECK(last(solver).status == GCDT_OK);
  check_errors(solver);
  check_input_errors(solver);
  check_counts_on_the_host();
  check_constraints_alone(solver);
  CHECK(lines > 0);
  check_mesh(solver, 1);
  check_mesh(solver, 0);

  gcdt_input input = square();
  gcdt_result* result = NULL;
  gcdt_options cancel = GCDT_OPTIONS_INIT;
  cancel.progress = reenter;
  cancel.progress_user = &solver;
  CHECK(gcdt_triangulate(solver, &input, &cancel, &result) == GCDT_ERROR_CANCELLED);
  gcdt_cl_input in_device_memory = GCDT_CL_INPUT_INIT;
  CHECK(gcdt_cl_triangulate(solver, &in_device_memory, NULL, 0, NULL, &result) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_cl_solver_create(NULL, NULL, &solver) == GCDT_ERROR_INVALID_ARGUMENT);
  CHECK(gcdt_cl_set_workspace(solver, 1, NULL) == GCDT_ERROR_INVALID_ARGUMENT);
  check_mesh(solver, 1);
  check_batch(device);
  gcdt_solver_release(solver);
  gcdt_solver_release(NULL);
  gcdt_result_release(NULL);
  if (failures == 0) puts("all checks hold");
  return failures != 0;
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The example in C of README and docs/using.md: a square with a slit in it. */
#include <gcdt/gcdt.h>
#include <stdio.h>

int main(void) {
  const double points[][2] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}, {3, 2}};
  const uint32_t constraints[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}};
  gcdt_input input = {sizeof input, GCDT_FLOAT64, points, 6, constraints[0], 5};
  gcdt_solver* solver = NULL;
  gcdt_result* mesh = NULL;
  gcdt_error error = GCDT_ERROR_INIT;
  uint32_t triangles[10][3]; /* 2 n - 2 at most */
  if (gcdt_solver_create(NULL, &solver) || gcdt_triangulate(solver, &input, NULL, &mesh) ||
      gcdt_result_copy(mesh, GCDT_TRIANGLES, triangles, 10))
    return gcdt_last_error(NULL, &error), fprintf(stderr, "%s\n", error.message), 1;
  for (uint64_t t = 0; t < gcdt_result_count(mesh, GCDT_TRIANGLES); ++t)
    printf("%u %u %u\n", triangles[t][0], triangles[t][1], triangles[t][2]);
  gcdt_result_release(mesh);
  gcdt_solver_release(solver);
  return 0;
}

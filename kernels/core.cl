// SPDX-License-Identifier: Apache-2.0
// What every triangulation runs where loops are contiguous, as one program: a driver that compiles kernels as they are
// launched takes longer for each program than for a kernel (bench/NOTES.md).
#include "check.cl"
#include "few.cl"
#include "grow.cl"
#include "mesh.cl"
#include "order.cl"
#include "output.cl"
#include "primitives.cl"
#include "selftest.cl"
#include "sort64_serial.cl"
#include "sort_finish.cl"

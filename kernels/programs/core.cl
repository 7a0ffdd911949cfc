// SPDX-License-Identifier: Apache-2.0
// What every triangulation runs where loops are contiguous, as one program: a driver that compiles kernels as they are
// launched takes longer for each program than for a kernel (bench/NOTES.md).
#include "check/check.cl"
#include "common/mesh.cl"
#include "common/selftest.cl"
#include "insert/grow.cl"
#include "order/decimals.cl"
#include "order/order.cl"
#include "output/output.cl"
#include "programs/by_one_item.cl"
#include "sort/buckets.cl"
#include "sort/primitives.cl"
#include "sort/sort64_serial.cl"

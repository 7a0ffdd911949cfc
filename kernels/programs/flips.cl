// SPDX-License-Identifier: Apache-2.0
// All kernels of flips as one program, where loops are contiguous (core.cl).
#include "flip/flip.cl"
#include "flip/flip_few.cl"
#include "flip/sweeps.cl"

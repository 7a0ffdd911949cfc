// SPDX-License-Identifier: Apache-2.0
// What calls with constraints run besides where loops are contiguous, as one program (core.cl).
#include "constrain/clean.cl"
#include "constrain/constrain.cl"
#include "constrain/first.cl"
#include "constrain/parts.cl"
#include "constrain/retriangulate.cl"
#include "constrain/stitch.cl"
#include "insert/freeze.cl"

// SPDX-License-Identifier: Apache-2.0
// What calls with constraints run besides where loops are contiguous, as one program (core.cl); but for
// retriangulate.cl, which has names in common with these.
#include "constrain/clean.cl"
#include "constrain/constrain.cl"
#include "constrain/first.cl"
#include "constrain/parts.cl"
#include "constrain/stitch.cl"

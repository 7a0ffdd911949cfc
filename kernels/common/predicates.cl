// SPDX-License-Identifier: Apache-2.0
// Evaluates the predicates on a device; tests compare them bit for bit with the host's.
#include "common/selftest.h"

// One work-item per tuple.
// Reads: tuples. Writes: values.
// Word i belongs to tuple i.
// After: values[i] holds every predicate of tuples[i].
kernel void evaluate_predicates(u32 count, global const PredicateTuple* tuples, global PredicateValues* values) {
  FOR_EACH(i, count) values[i] = gcdt_evaluate_predicates(tuples[i]);
}

// SPDX-License-Identifier: Apache-2.0
// Appending to a list in global memory from many work-items. A work-group gathers in local memory and
// takes room in the list once for all: one global atomic for up to APPEND_CAPACITY items, where one each
// would queue up at a single address. The list's order is free. OpenCL C only.
#ifndef GCDT_APPEND_H
#define GCDT_APPEND_H

#include "common/shared.h"

#define APPEND_CAPACITY 1024u

typedef struct Appender {
  local uint* items;              // APPEND_CAPACITY
  volatile local uint* gathered;  // [0]: items gathered, may exceed the capacity; [1]: place in the list
  global uint* list;
  volatile global uint* length;
} Appender;

// Local memory of one appender; declared in the kernel itself, as OpenCL C 1.2 asks.
#define DECLARE_APPENDER(name)              \
  local uint name##_items[APPEND_CAPACITY]; \
  local uint name##_gathered[2]

// Called by the whole group, as is append_flush. `length` counts the list, and is not changed by others
// but through appenders in the same launch.
GCDT_GIVEN_LOCAL Appender make_appender(local uint* items, local uint* gathered, global uint* list,
                                        volatile global uint* length) {
  const Appender a = {.items = items, .gathered = gathered, .list = list, .length = length};
  if (get_local_id(0) == 0) gathered[0] = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  return a;
}

// Each item gets its own place, in local memory or, if that is full, in the list: no race.
GCDT_GIVEN_LOCAL void append(Appender a, uint item) {
  const uint at = atomic_inc(a.gathered);
  if (at < APPEND_CAPACITY)
    a.items[at] = item;
  else
    a.list[atomic_inc(a.length)] = item;
}

// Moves what was gathered to the list if it is more than `keep` items. All work-items of the group pass,
// between two appends of different tiles.
GCDT_GIVEN_LOCAL void append_flush(Appender a, uint keep) {
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint gathered = min(a.gathered[0], APPEND_CAPACITY);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (gathered > keep) {
    if (get_local_id(0) == 0) {
      a.gathered[1] = atomic_add(a.length, gathered);
      a.gathered[0] = 0u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint place = a.gathered[1];
    for (uint i = get_local_id(0); i < gathered; i += get_local_size(0)) a.list[place + i] = a.items[i];
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// Distinct numbers, counted on by `counter`: `mine` for each work-item, the first is returned. One global atomic for
// the group, all of which calls it; `taken` is two words of local memory.
GCDT_GIVEN_LOCAL uint take_numbers(volatile local uint* taken, volatile global uint* counter, uint mine) {
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0) taken[0] = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint place = mine > 0u ? atomic_add(taken, mine) : 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0) taken[1] = taken[0] > 0u ? atomic_add(counter, taken[0]) : 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  return taken[1] + place;
}

#endif

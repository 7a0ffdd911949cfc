// SPDX-License-Identifier: Apache-2.0
// Edges that are to be tested. OpenCL C only.
#ifndef GCDT_QUEUE_H
#define GCDT_QUEUE_H

#include "common/append.h"
#include "common/mesh.h"

// Where edges go that are to be tested in the next round: their marks and, if `listed`, a list.
typedef struct Queue {
  volatile global uint* marks;
  bool listed;
  Appender list;
} Queue;

GCDT_GIVEN_LOCAL Queue make_list_queue(volatile global uint* marks, Appender list) {
  const Queue q = {.marks = marks, .listed = true, .list = list};
  return q;
}

static inline Queue make_mark_queue(volatile global uint* marks) {
  const Queue q = {.marks = marks, .listed = false};
  return q;
}

// Into the list at most once: the mark bit decides by atomic_or.
static inline void queue_edge(Queue q, uint e) {
  const uint old = atomic_or(q.marks + e, GCDT_MARK_QUEUED);
  if (q.listed && !(old & GCDT_MARK_QUEUED)) append(q.list, e);
}

// The four edges around one that was flipped. All marks are asked for before the first answer is waited for.
static inline void queue_around(Queue q, const private uint* around) {
  const uint e0 = GCDT_SIDE_EDGE(around[0]), e1 = GCDT_SIDE_EDGE(around[1]), e2 = GCDT_SIDE_EDGE(around[2]),
             e3 = GCDT_SIDE_EDGE(around[3]);
  const uint old0 = atomic_or(q.marks + e0, GCDT_MARK_QUEUED), old1 = atomic_or(q.marks + e1, GCDT_MARK_QUEUED),
             old2 = atomic_or(q.marks + e2, GCDT_MARK_QUEUED), old3 = atomic_or(q.marks + e3, GCDT_MARK_QUEUED);
  if (!q.listed) return;
  if (!(old0 & GCDT_MARK_QUEUED)) append(q.list, e0);
  if (!(old1 & GCDT_MARK_QUEUED)) append(q.list, e1);
  if (!(old2 & GCDT_MARK_QUEUED)) append(q.list, e2);
  if (!(old3 & GCDT_MARK_QUEUED)) append(q.list, e3);
}

#endif

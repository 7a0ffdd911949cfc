// SPDX-License-Identifier: Apache-2.0
// The vertices that parts of pieces own, while it is not known how many these are. OpenCL C and C++17 the length of a
// chunk, OpenCL C all else.
//
// How long each part's share is, is known after its walk. So the walk writes what it owns to chunks: the part's own
// first one, then others from a pool, taken by an atomic counter (most parts need none). Each knows its place within
// the part.
#ifndef GCDT_CHUNKS_H
#define GCDT_CHUNKS_H

// Owned vertices of a chunk: most parts own fewer. (Not measured.)
#define GCDT_CHUNK_LENGTH 8u
#define GCDT_CHUNK_LENGTH_BITS 4u

#ifdef __OPENCL_VERSION__
#include "common/shared.h"

// A chunk: its part, the vertices that the part owns left and right before it; its length, and above that a bit for
// each of its vertices, which says right.
typedef uint4 ChunkHead;

typedef struct Chunks {
  global ChunkHead* heads;
  global uint2* entries;  // a vertex; the side along the chain before it, or GCDT_NONE
  uint pool, capacity;    // the pool begins behind the parts' own
} Chunks;

// One part's stream of owned vertices.
typedef struct Owned {
  ChunkHead head;    // of the current chunk
  uint chunk;        // or GCDT_NONE
  uint left, right;  // so far
} Owned;

static Owned own_nothing(uint part) {
  Owned o;
  o.chunk = part;
  o.left = 0u, o.right = 0u;
  o.head = (ChunkHead)(part, 0u, 0u, 0u);
  return o;
}

static void end_chunk(Chunks chunks, const private Owned* o) {
  if (o->chunk != GCDT_NONE) chunks.heads[o->chunk] = o->head;
}

// No race: chunks taken are distinct. There are enough for as many vertices as faces are crossed, and more are owned
// only if pieces cross.
static void own_vertex(Chunks chunks, private Owned* o, uint v, uint right, uint before,
                       volatile global Counters* counters) {
  uint length = o->head.w & ((1u << GCDT_CHUNK_LENGTH_BITS) - 1u);
  if (o->chunk == GCDT_NONE || length == GCDT_CHUNK_LENGTH) {
    end_chunk(chunks, o);
    o->chunk = chunks.pool + atomic_inc(&counters->chunks);
    if (o->chunk >= chunks.capacity) {
      atomic_or(&counters->failed, GCDT_FAILED_COUNT);
      o->chunk = GCDT_NONE;
      return;
    }
    o->head = (ChunkHead)(o->head.x, o->left, o->right, 0u);
    length = 0u;
  }
  chunks.entries[GCDT_CHUNK_LENGTH * o->chunk + length] = (uint2)(v, before);
  o->head.w += 1u + (right << (GCDT_CHUNK_LENGTH_BITS + length));
  if (right)
    ++o->right;
  else
    ++o->left;
}

#endif

#endif

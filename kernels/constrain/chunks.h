// SPDX-License-Identifier: Apache-2.0
// The vertices that parts of pieces own, while it is not known how many these are. OpenCL C and C++17 the length of a
// chunk, OpenCL C all else.
//
// How long each part's share is, is known after its walk. So the walk writes what it owns to chunks: the part's own
// first one, then others from a pool, taken by an atomic counter (most parts need none). Each knows its place within
// the part.
#ifndef GCDT_CHUNKS_H
#define GCDT_CHUNKS_H

// Owned vertices of a chunk: most parts own fewer, and with four a tenth more time goes by (NOTES, "Many crossings").
#define GCDT_CHUNK_LENGTH 8u
#define GCDT_CHUNK_LENGTH_BITS 4u

#ifdef __OPENCL_VERSION__
#include "common/shared.h"

// A chunk: its part, the vertices that the part owns left and right before it; its length, and above that two bits for
// each of its vertices: which are right, and above all of these which are next to the end that the piece is walked
// from.
typedef uint4 ChunkHead;

typedef struct Chunks {
  global ChunkHead* heads;
  global uint* entries;  // side codes of the edges at which a vertex is owned, as the walk leaves by them
  uint pool, capacity;   // the pool begins behind the parts' own
} Chunks;

static inline uint chunk_length(ChunkHead head) { return head.w & ((1u << GCDT_CHUNK_LENGTH_BITS) - 1u); }
static inline bool chunk_right(ChunkHead head, uint j) { return (head.w >> (GCDT_CHUNK_LENGTH_BITS + j)) & 1u; }
static inline uint chunk_rights_before(ChunkHead head, uint j) {
  return popcount((head.w >> GCDT_CHUNK_LENGTH_BITS) & ((1u << j) - 1u));
}
static inline bool chunk_from_end(ChunkHead head, uint j) {
  return (head.w >> (GCDT_CHUNK_LENGTH_BITS + GCDT_CHUNK_LENGTH + j)) & 1u;
}

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
static void own_vertex(Chunks chunks, private Owned* o, uint exit, uint right, uint from_end,
                       volatile global Counters* counters) {
  uint length = chunk_length(o->head);
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
  chunks.entries[GCDT_CHUNK_LENGTH * o->chunk + length] = exit;
  o->head.w += 1u + ((right | (from_end << GCDT_CHUNK_LENGTH)) << (GCDT_CHUNK_LENGTH_BITS + length));
  if (right)
    ++o->right;
  else
    ++o->left;
}

#endif

#endif

// SPDX-License-Identifier: Apache-2.0
// Cache lines on their way before they are needed. OpenCL C only.
//
// A work-item that is a thread (GCDT_CONTIGUOUS) goes through its share one item after the other, and each is a chain
// of loads, which waits for a cache that others use, or for memory. What the items after it will ask for first is known
// before. GCDT_PREFETCH has the line of an address on its way: it reads nothing, so that it takes part in no race and
// changes no result, and any address will do. OpenCL's own prefetch is empty in PoCL 3.1, so it is the compiler's,
// where that makes a processor's code; what is read only to know an address stands under GCDT_PREFETCHES.
#ifndef GCDT_PREFETCH_H
#define GCDT_PREFETCH_H

#if defined(GCDT_CONTIGUOUS) && defined(__has_builtin) && !defined(__SPIR__) && !defined(__SPIR64__)
#if __has_builtin(__builtin_prefetch)
#define GCDT_PREFETCHES
#endif
#endif

#ifdef GCDT_PREFETCHES
#define GCDT_PREFETCH(address) __builtin_prefetch((private const void*)(size_t)(address))
#else
#define GCDT_PREFETCH(address) ((void)0)
#endif

// A mesh of fewer triangles fits into a core's own cache.
#define GCDT_LEAST_PREFETCHED 16384u

// How many items ahead lines are asked for, and those that the first ones lead to (bench/NOTES.md, "Prefetches").
#define GCDT_FAR_AHEAD 8u
#define GCDT_AHEAD 4u

#endif

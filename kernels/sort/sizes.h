// SPDX-License-Identifier: Apache-2.0
// Sizes of the sorts, which the host launches by. OpenCL C and C++17.
#ifndef GCDT_SIZES_H
#define GCDT_SIZES_H

// Bits of a digit. Of work-items that each walk through a part: its 256 counters stay in the first-level cache. Of a
// group: a tile holds 32 keys of each digit on average, so writes stay coalesced. Of one work-item that sorts all of
// `count` keys by itself: fewer passes, once there are about as many keys as counters to be cleared and added up
// (bench/NOTES.md, "Few vertices on CPUs").
#define GCDT_SERIAL_DIGIT_BITS 8u
#define GCDT_GROUP_DIGIT_BITS 5u
#define GCDT_MOST_ONE_ITEM_DIGIT_BITS 11u
#define GCDT_ONE_ITEM_DIGIT_BITS(count) ((count) < 4096u ? 8u : GCDT_MOST_ONE_ITEM_DIGIT_BITS)

// Pairs of a run that such a work-item sorts by insertion: as long as counters of five or six digits take to be cleared
// and added up.
#define GCDT_RUN_BY_INSERTION 64u

// Bits up to which groups sort by digits however few keys there are, but for a block's: three digits take less time
// than blocks and their merging (bench/NOTES.md, "Scans and folds").
#define GCDT_MOST_BITS_BY_DIGIT 12u

// Work-items of a group that take part, and the keys of each in a tile.
#define GCDT_SORT_LANES 128u
#define GCDT_SORT_WIDTH 8u

// Keys of a run that are put in order by a work-item each, which compares its own with all others (bench/NOTES.md,
// "Sorting few keys").
#define GCDT_SORT_RANKED 64u

// Pairs of a bucket that one work-item sorts by itself, which compares each with all (buckets.cl).
#define GCDT_SORT_IN_BUCKET 32u

// Keys that one work-group sorts in local memory: 24 KiB of the 32 that every device has.
#define GCDT_SORT_SMALL 2048u

#endif

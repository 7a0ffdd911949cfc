// SPDX-License-Identifier: Apache-2.0
// How a loop over many items is shared out among the work-items of a launch. OpenCL C only.
//
// GCDT_CONTIGUOUS is set for devices whose work-items are loops of a thread (device/programs.cpp): every work-item
// takes consecutive items, so that it reads whole cache lines and pages, and its neighbours others. Elsewhere
// neighbours take neighbouring items, so that a group's loads are joined. Either way each item below `count` has
// exactly one owner, for any launch geometry.
#ifndef GCDT_LOOPS_H
#define GCDT_LOOPS_H

// The first item of the part `share` of `shares` in contiguous shares of 0 .. count - 1.
static inline uint share_begin(uint count, uint share, uint shares) {
  return (uint)((ulong)count * (ulong)share / (ulong)shares);
}

#ifdef GCDT_CONTIGUOUS

// Items of the part `share` of `shares`, ascending.
#define FOR_SHARE(i, count, share, shares)                                                                       \
  for (uint i = share_begin((count), (share), (shares)), i##_end = share_begin((count), (share) + 1u, (shares)); \
       i < i##_end; ++i)

// The first items of tiles, each as large as a work-group; every work-item of a group runs every tile of it, so that
// they meet at barriers in the body.
#define FOR_EACH_TILE_OF(tile, size, count)                                                                           \
  for (uint tile = (size)*share_begin(((count) + (size)-1u) / (size), get_group_id(0), get_num_groups(0)),            \
            tile##_end = (size)*share_begin(((count) + (size)-1u) / (size), get_group_id(0) + 1u, get_num_groups(0)); \
       tile < tile##_end; tile += (size))

#else

#define FOR_SHARE(i, count, share, shares) for (uint i = (share); i < (count); i += (shares))

#define FOR_EACH_TILE_OF(tile, size, count) \
  for (uint tile = get_group_id(0) * (size); tile < (count); tile += get_num_groups(0) * (size))

#endif

// Where the share begins of items that have weights: item i weighs firsts[i + 1] - firsts[i] words, and what it takes
// to begin with it, as much as GCDT_ITEM_WEIGHT of them. The weights before an item ascend strictly, so share 0 begins
// with the first item, share `shares` behind the last. Ends: the range halves.
#define GCDT_ITEM_WEIGHT 4u
static inline uint share_by_weight(global const uint* firsts, uint count, uint share, uint shares) {
  const uint begin = firsts[0];
  const ulong all = (ulong)(firsts[count] - begin) + (ulong)GCDT_ITEM_WEIGHT * count;
  const ulong before = all * share / shares;
  uint low = 0, high = count;
  while (low < high) {
    const uint middle = low + (high - low) / 2u;
    if ((ulong)(firsts[middle] - begin) + (ulong)GCDT_ITEM_WEIGHT * middle < before)
      low = middle + 1u;
    else
      high = middle;
  }
  return low;
}

// Items x, x + z and so on, below y.
typedef uint3 Items;
#define FOR_ITEMS(i, items) for (uint i = (items).x; i < (items).y; i += (items).z)

// Those of FOR_SHARE.
static inline Items items_of_share(uint count, uint share, uint shares) {
#ifdef GCDT_CONTIGUOUS
  return (Items)(share_begin(count, share, shares), share_begin(count, share + 1u, shares), 1u);
#else
  return (Items)(share, count, shares);
#endif
}

// Those of this work-item.
static inline Items items_of_this(uint count) {
  return items_of_share(count, (uint)get_global_id(0), (uint)get_global_size(0));
}

// The problems of this work-item, of a batch whose problems each have words of their own that stand one problem after
// the other, from firsts[p] on: shares are contiguous, so that what a work-item reads next comes next in memory, and
// weigh about the same.
static inline Items problems_of_this(uint problems, global const uint* firsts) {
  const uint share = (uint)get_global_id(0), shares = (uint)get_global_size(0);
  return (Items)(share_by_weight(firsts, problems, share, shares),
                 share_by_weight(firsts, problems, share + 1u, shares), 1u);
}

// The items of this work-item.
#define FOR_EACH(i, count) FOR_SHARE(i, count, (uint)get_global_id(0), (uint)get_global_size(0))

#define FOR_EACH_TILE(tile, count) FOR_EACH_TILE_OF(tile, (uint)get_local_size(0), count)

// Items begin .. end - 1 of work-groups. Mesa 25's llvmpipe goes through the body once more when no item is left, and
// does not mask loads of what is the same for all work-items (docs/devices.md). So i is bounded: it is the last item
// then.
#define FOR_EACH_OF_GROUPS(i, begin, end)                                                              \
  for (uint i##_next = (begin) + (uint)get_group_id(0), i = min(i##_next, (end)-1u); i##_next < (end); \
       i##_next += (uint)get_num_groups(0), i = min(i##_next, (end)-1u))

// All tiles: of what one work-group does by itself.
#define FOR_ALL_TILES(tile, count) for (uint tile = 0; tile < (count); tile += (uint)get_local_size(0))

#endif

// SPDX-License-Identifier: Apache-2.0
// Depth and winding number of each region, from outside inwards, and the removal of triangles.
//
// The frontiers of even and odd rounds are the halves of one buffer, of one word a node each.
//
// Nodes: 0 is outside, r + 1 is region r. Arcs: the constrained half edges between two nodes, in the direction
// in which they are crossed. depth is the least number of constrained edges between a node and outside (an
// unconstrained edge of the hull is no border: the region beside it is outside, depth 0). The winding number is
// counted along one shortest way: a region of depth d takes it from the one of depth d - 1 across its entry, the
// least half edge that leads in from there. If all borders are closed every way gives the same; where they
// are not, the least half edge makes the choice the same in every run.
//
// Every source of an edge counts +1 or -1 by its direction, so the winding number is odd exactly where an odd
// number of sources was crossed: even-odd with multiplicities needs no count of its own.
#include "common/corners.h"
#include "common/pieces.h"
#include "common/search.h"
#include "domain/domain.h"

// One work-item per source of a piece.
// Reads the pieces, the constraints and the points. Writes turns[piece] by atomic_add, in any order the same.
// After this kernel turns[i] is the number of sources that run along piece i from its first end to its second,
// less those that run back. A source's chain never turns back, so its direction is the piece's up to a
// quarter turn: the products' sum is below 2^63 and not zero.
kernel void count_turns(const uint sources, const uint pieces, global const uint* source_offsets,
                        global const uint* source_list, global const uint2* ends, global const uint2* constraints,
                        global const uint* input_vertex, global const int2* points, volatile global int* turns) {
  uint piece = 0, end = 0;  // of the last source
  FOR_EACH(i, sources) {
    if (i >= end) {
      // Sources ascend: the next one is often the next piece's.
      piece = i == end && i != 0u ? piece + 1u : last_begin(source_offsets, pieces, i);
      end = source_offsets[piece + 1u];
    }
    const uint2 c = constraints[source_list[i]], e = ends[piece];
    const int2 a = points[input_vertex[c.x]], b = points[input_vertex[c.y]], p = points[e.x], q = points[e.y];
    const i64 along = ((i64)b.x - a.x) * ((i64)q.x - p.x) + ((i64)b.y - a.y) * ((i64)q.y - p.y);
    atomic_add(&turns[piece], along > 0 ? 1 : -1);
  }
}

// Whether half edge h = 3 t + k is an arc into t from outside (1), an arc out of t (2), or none (0).
GCDT_INLINE uint arc_kind(uint h, global const int* neighbours, global const uchar* constrained,
                          global const uint* region) {
  const uint t = h / 3u;
  if (!((constrained[t] >> (h % 3u)) & 1u)) return 0u;
  const int u = neighbours[h];
  if (u < 0) return 1u;
  return region[t] != region[u] ? 2u : 0u;
}

// One work-item per half edge.
// Reads the mesh and region. Writes arcs[h]. Word h has one writer.
// After this kernel the scan of `arcs` gives every arc a place.
kernel void count_arcs(const uint count, global const int* neighbours, global const uchar* constrained,
                       global const uint* region, global uint* arcs) {
  FOR_EACH(h, count)
  arcs[h] = arc_kind(h, neighbours, constrained, region) != 0u ? 1u : 0u;
}

// One work-item per half edge.
// Reads the mesh, region and places, the scan of count_arcs. Writes nodes and arcs at the arc's own place.
// After this kernel the arcs, sorted by `nodes`, are listed by the node that they leave.
kernel void list_arcs(const uint count, global const int* neighbours, global const uchar* constrained,
                      global const uint* region, global const uint* places, global uint* nodes, global uint* arcs) {
  FOR_EACH(h, count) {
    const uint kind = arc_kind(h, neighbours, constrained, region);
    if (kind == 0u) continue;
    nodes[places[h]] = kind == 1u ? 0u : region[h / 3u] + 1u;
    arcs[places[h]] = h;
  }
}

// One work-item per node and one more.
// Reads nodes, sorted. Writes begins[i]. Word i has one writer.
// After this kernel the arcs of node i are begins[i] up to begins[i + 1]. Ends: high - low shrinks.
kernel void find_begins(const uint count, const uint arcs, global const uint* nodes, global uint* begins) {
  FOR_EACH(i, count + 1u) {
    uint low = 0, high = arcs;
    while (low < high) {
      const uint middle = low + (high - low) / 2u;
      if (nodes[middle] < i)
        low = middle + 1u;
      else
        high = middle;
    }
    begins[i] = low;
  }
}

// One work-item per node.
// Writes depth, winding and entry; work-item 0 also the first frontier: outside.
// Word i has one writer.
// After this kernel only outside has a depth.
kernel void depth_start(const uint count, global uint* depth, global int* winding, global uint* entry,
                        global uint* frontiers, global DomainReport* report) {
  FOR_EACH(i, count) {
    depth[i] = i == 0u ? 0u : GCDT_NONE;
    winding[i] = 0;
    entry[i] = GCDT_NONE;
    if (i == 0u) {
      frontiers[0] = 0u;
      report->frontier[0] = 1u;
      report->settled = 1u;
    }
  }
}

// One work-item per half edge.
// Reads the mesh. Writes depth[node] = 0 and appends the node, for regions with an unconstrained edge in the hull.
// atomic_cmpxchg lets one work-item have the node; the frontier's order is free.
// After this kernel the frontier holds all nodes of depth 0.
kernel void depth_hull(const uint count, global const int* neighbours, global const uchar* constrained,
                       global const uint* region, volatile global uint* depth, global uint* frontiers,
                       volatile global DomainReport* report) {
  FOR_EACH(h, count) {
    if (neighbours[h] >= 0 || ((constrained[h / 3u] >> (h % 3u)) & 1u)) continue;
    const uint node = region[h / 3u] + 1u;
    if (atomic_cmpxchg(&depth[node], GCDT_NONE, 0u) != GCDT_NONE) continue;
    frontiers[atomic_inc(&report->frontier[0])] = node;
    atomic_inc(&report->settled);
  }
}

// The mesh with its regions, and the pieces along its edges with their turns.
#define BORDER_PARAMETERS                                                                                           \
  global const Levels *levels, global const uint *corners, global const int *neighbours, global const uint *region, \
      const uint pieces, global const uint2 *ends, global const int *turns
#define BORDERS levels, corners, neighbours, region, pieces, ends, turns

// These, and all of the search from outside.
#define SEARCH_PARAMETERS                                                                                  \
  BORDER_PARAMETERS, global const uint *begins, global const uint *arcs, volatile global uint *depth,      \
      volatile global int *winding, volatile global uint *entry, const uint nodes, global uint *frontiers, \
      volatile global DomainReport *report
#define SEARCH BORDERS, begins, arcs, depth, winding, entry, nodes, frontiers, report

// The node that arc h leads to.
GCDT_INLINE uint target_of(uint h, global const int* neighbours, global const uint* region) {
  const int u = neighbours[h];
  return region[u < 0 ? h / 3u : (uint)u] + 1u;
}

// The frontiers of even and odd rounds.
GCDT_INLINE global uint* frontier_of(uint d, global uint* frontiers, uint nodes) {
  return frontiers + (d & 1u) * nodes;
}

// In round d, every `step`-th arc of the node from its `first` on.
GCDT_INLINE void expand(uint d, uint node, uint first, uint step, SEARCH_PARAMETERS) {
  global uint* next = frontier_of(d + 1u, frontiers, nodes);
  for (uint i = begins[node] + first; i < begins[node + 1u]; i += step) {
    const uint h = arcs[i], target = target_of(h, neighbours, region);
    if (depth[target] != GCDT_NONE) continue;
    if (atomic_min(&entry[target], h) == GCDT_NONE) next[atomic_inc(&report->frontier[(d + 1u) % 3u])] = target;
  }
}

// Whether one work-item deals with the node's arcs; else a work-group does.
GCDT_INLINE uint has_few_arcs(uint node, global const uint* begins) {
  return begins[node + 1u] - begins[node] <= GCDT_FEW_ARCS;
}

// The winding number beyond arc h less that on this side. On the left of a piece from its first end to its
// second it is larger by `turn` than on the right; a triangle lies on the left of its half edges.
GCDT_INLINE int turn_across(uint h, BORDER_PARAMETERS) {
  const uint t = h / 3u, k = h % 3u;
  const uint a = corners[3u * t + next_corner(k)], b = corners[3u * t + previous_corner(k)];
  const uint piece = find_piece(levels, pieces, ends, a, b);
  if (piece == GCDT_NONE) return 0;  // the mesh was not checked, and its flags are wrong
  const int left_over_right = ends[piece].x == a ? turns[piece] : -turns[piece];
  return neighbours[h] < 0 ? left_over_right : -left_over_right;
}

// In round d, node i of the next frontier.
GCDT_INLINE void settle(uint d, uint i, SEARCH_PARAMETERS) {
  const uint node = frontier_of(d + 1u, frontiers, nodes)[i];
  const uint h = entry[node], source = neighbours[h] < 0 ? 0u : region[h / 3u] + 1u;
  winding[node] = winding[source] + turn_across(h, BORDERS);
  depth[node] = d + 1u;
  atomic_add(&report->arcs[(d + 1u) % 3u], begins[node + 1u] - begins[node]);
}

// After round d has settled `count` nodes: one work-item.
GCDT_INLINE void count_settled(uint d, uint count, volatile global DomainReport* report) {
  if (count == 0u) return;
  report->settled += count;
  report->deepest = d + 1u;
}

// Node i of a frontier. Mesa 25's llvmpipe goes through a loop's body once more after its end, and does not mask what
// all work-items load from one place (docs/devices.md). So here neither i nor the word, which nobody may have written,
// leads out of a buffer.
GCDT_INLINE uint frontier_node(global const uint* frontier, uint i, uint nodes) {
  return min(frontier[min(i, nodes - 1u)], nodes - 1u);
}

// One work-item per node of the frontier, or one work-group if the node has many arcs, or all if there are few nodes.
// Reads the arcs of the node and depth. Writes entry by atomic_min, and the next frontier, in which a node is put
// by the one arc that found no entry there; its order is free. Work-item 0 empties the one after the next.
// After this kernel the next frontier holds the nodes of depth d + 1, with their least entries from depth d.
kernel void depth_expand(const uint d, SEARCH_PARAMETERS) {
  const uint count = report->frontier[d % 3u];
  global const uint* frontier = frontier_of(d, frontiers, nodes);
  if (get_global_id(0) == 0) report->frontier[(d + 2u) % 3u] = report->arcs[(d + 2u) % 3u] = 0u;
  const uint few = count <= GCDT_FEW_NODES ? count : 0u, many = count - few;
  for (uint i = 0; i < few; ++i)
    expand(d, frontier_node(frontier, i, nodes), get_global_id(0), get_global_size(0), SEARCH);
  FOR_EACH(i, many)
  if (has_few_arcs(frontier[i], begins)) expand(d, frontier[i], 0u, 1u, SEARCH);
  FOR_EACH_OF_GROUPS(i, 0u, many) {
    const uint node = frontier_node(frontier, i, nodes);
    if (!has_few_arcs(node, begins)) expand(d, node, get_local_id(0), get_local_size(0), SEARCH);
  }
}

// One work-item per node of the next frontier.
// Reads entries, and the winding numbers of depth d. Writes depth and winding of its node: one writer a word; counts
// the arcs by atomic_add, in any order the same.
// After this kernel the nodes of depth d + 1 are settled.
kernel void depth_settle(const uint d, SEARCH_PARAMETERS) {
  const uint count = report->frontier[(d + 1u) % 3u];
  FOR_EACH(i, count) settle(d, i, SEARCH);
  if (get_global_id(0) == 0) count_settled(d, count, report);
}

// One work-group. Does up to GCDT_DEPTH_ROUNDS rounds from d on; barriers order what two kernels do otherwise,
// and the same arguments hold for each part. Ends when a frontier is empty or too large for one work-group, or after
// those rounds.
// After this kernel report->rounds is the number of rounds done.
kernel void depth_rounds(const uint d, SEARCH_PARAMETERS) {
  uint done = 0;
  for (;;) {
    const uint now = d + done, count = report->frontier[now % 3u], arc_count = report->arcs[now % 3u];
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (count == 0u || count > GCDT_DEPTH_NODES || arc_count > GCDT_DEPTH_ARCS || done == GCDT_DEPTH_ROUNDS) break;
    if (get_local_id(0) == 0) report->frontier[(now + 2u) % 3u] = report->arcs[(now + 2u) % 3u] = 0u;
    global const uint* frontier = frontier_of(now, frontiers, nodes);
    for (uint i = get_local_id(0); i < count; i += get_local_size(0))
      if (has_few_arcs(frontier[i], begins)) expand(now, frontier[i], 0u, 1u, SEARCH);
    for (uint i = 0; i < count; ++i) {
      const uint node = frontier_node(frontier, i, nodes);
      if (!has_few_arcs(node, begins)) expand(now, node, get_local_id(0), get_local_size(0), SEARCH);
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    const uint found = report->frontier[(now + 1u) % 3u];
    for (uint i = get_local_id(0); i < found; i += get_local_size(0)) settle(now, i, SEARCH);
    if (get_local_id(0) == 0) count_settled(now, found, report);
    barrier(CLK_GLOBAL_MEM_FENCE);
    ++done;
  }
  if (get_local_id(0) == 0) report->rounds = done;
}

// One work-item per arc.
// Reads everything about the nodes. Writes counts in report by atomic_add, in any order the same.
// After this kernel report has the edges whose two sides do not differ as the edge says, each counted once:
// an arc into the mesh has no twin, of two twins the one with the lesser half edge counts.
kernel void count_open(const uint count, BORDER_PARAMETERS, global const uint* nodes, global const uint* arcs,
                       global const int* winding, volatile global DomainReport* report) {
  FOR_EACH(i, count) {
    const uint h = arcs[i], target = target_of(h, neighbours, region);
    if (neighbours[h] >= 0 && (uint)neighbours[h] < h / 3u) continue;
    const int wrong = winding[target] - winding[nodes[i]] - turn_across(h, BORDERS);
    if (wrong != 0) atomic_inc(&report->open_winding);
    if (wrong & 1) atomic_inc(&report->open_parity);
  }
}

// One work-item per half edge.
// Reads the mesh, region and turns. Writes open counts in report by atomic_add, in any order the same.
// After this kernel edges with the same region on both sides are counted too: there any turn but 0 is wrong.
kernel void count_dangling(const uint count, BORDER_PARAMETERS, global const uchar* constrained,
                           volatile global DomainReport* report) {
  FOR_EACH(h, count) {
    const int u = neighbours[h];
    const uint t = h / 3u;
    if (!((constrained[t] >> (h % 3u)) & 1u) || u < (int)t || region[t] != region[u]) continue;
    const int turn = turn_across(h, BORDERS);
    if (turn != 0) atomic_inc(&report->open_winding);
    if (turn & 1) atomic_inc(&report->open_parity);
  }
}

// One work-item per seed point.
// Reads the triangle that holds the seed, or -1. Writes seeds[region] by atomic_min, in any order the same.
// After this kernel seeds[r] is the least seed in region r, GCDT_NONE (as before) without one.
kernel void mark_seeds(const uint count, global const int* triangles, global const uint* region,
                       volatile global uint* seeds) {
  FOR_EACH(i, count)
  if (triangles[i] >= 0) atomic_min(&seeds[region[triangles[i]]], i);
}

// One work-item per triangle.
// Reads the nodes and the regions' least hole seeds. Writes keep[t]. Word t has one writer.
// After this kernel the scan of `keep` numbers the kept triangles in their order.
kernel void choose_triangles(const uint count, const uint rule, global const uint* region, global const uint* depth,
                             global const int* winding, global const uint* holes, global uint* keep) {
  FOR_EACH(t, count) {
    const uint r = region[t];
    keep[t] = domain_keeps(rule, depth[r + 1u], winding[r + 1u], holes[r] != GCDT_NONE ? 1u : 0u);
  }
}

// One work-item per triangle.
// Reads before, the scan of choose_triangles (count + 1 elements). Writes kept[t]. Word t has one writer.
// After this kernel kept[t] is the triangle's place among the kept ones, -1 if it is removed.
kernel void place_kept(const uint count, global const uint* before, global int* kept) {
  FOR_EACH(t, count)
  kept[t] = before[t + 1u] != before[t] ? (int)before[t] : -1;
}

// One work-item per triangle.
// Reads the mesh and kept. Writes the new mesh at the triangle's place, of which it is the one writer.
// After this kernel the kept triangles stand in their order, and neighbours across removed ones are -1.
kernel void gather_kept(const uint count, global const int* kept, global const uint* corners,
                        global const int* neighbours, global const uchar* constrained, global uint* out_corners,
                        global int* out_neighbours, global uchar* out_constrained) {
  FOR_EACH(t, count) {
    if (kept[t] < 0) continue;
    const uint place = (uint)kept[t];
    for (uint k = 0; k < 3; ++k) {
      const int u = neighbours[3u * t + k];
      out_corners[3u * place + k] = corners[3u * t + k];
      out_neighbours[3u * place + k] = u < 0 ? -1 : kept[u];
    }
    out_constrained[place] = constrained[t];
  }
}

// One work-item per triangle.
// Reads the nodes, kept and the regions' least region seeds. Writes the kept triangle's four words, of which it is
// the one writer.
// After this kernel each kept triangle has its region, depth, winding number and seed (-1 without one).
kernel void gather_regions(const uint count, global const int* kept, global const uint* region,
                           global const uint* depth, global const int* winding, global const uint* seeds,
                           global uint* out_region, global uint* out_depth, global int* out_winding,
                           global int* out_seed) {
  FOR_EACH(t, count) {
    if (kept[t] < 0) continue;
    const uint place = (uint)kept[t], r = region[t];
    out_region[place] = r;
    out_depth[place] = depth[r + 1u];
    out_winding[place] = winding[r + 1u];
    out_seed[place] = (int)seeds[r];
  }
}

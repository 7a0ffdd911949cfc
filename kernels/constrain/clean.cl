// SPDX-License-Identifier: Apache-2.0
// Cleaning constraints (docs/contract.md, 3): end points to vertices, zero-length ones out, each split
// at every vertex on it (found by walking), equal pieces merged with the list of their sources.
#include "constrain/clean.h"
#include "constrain/length.h"
#include "constrain/walk.h"
#include "sort/mark_first.h"

// One work-item per input constraint. Reads the map input -> vertex; writes its ends, in the order in which it is
// walked, and whether it has a length. An index out of range is reported by atomic_max: the least one wins. No other
// race: each its own words, and sums by atomics (add_lengths). After: kept[c] is 0 or 1; behind the flags, where 0 was:
// kept[count + 1] is the complement of the least 2 c + end out of range, or 0; kept[count + 2] and kept[count + 3] are
// the total length of those that are kept, and lengths[c] that of each.
kernel void clean_map(uint count, uint inputs, global const uint2* constraints, global const uint* input_vertex,
                      global const int2* points, global const uint* wanted, uint all_wanted, global uint2* ends,
                      global uint* lengths, volatile global uint* kept) {
  local uint sum;
  u64 mine = 0;
  FOR_EACH(c, count) {
    const uint2 in = constraints[c];
    kept[c] = 0u;
    ends[c] = (uint2)(0u, 0u);
    if (in.x >= inputs || in.y >= inputs) {
      atomic_max(kept + count + 1u, ~(2u * c + (in.x >= inputs ? 0u : 1u)));
      continue;
    }
    ends[c] = walk_ends((uint2)(input_vertex[in.x], input_vertex[in.y]));
    if (ends[c].x == ends[c].y || !(all_wanted || wanted[c])) continue;
    kept[c] = 1u;
    const uint length = (uint)piece_length(points, ends[c]);
    lengths[c] = length;
    mine += length;
  }
  add_lengths(&sum, kept + count + 2u, mine);
}

// One work-item per kept constraint. Gathers its ends and its length. No race: each its own words.
kernel void clean_gather(uint count, global const uint* list, global const uint2* from, global const uint* from_lengths,
                         global uint2* to, global uint* to_lengths) {
  FOR_EACH(i, count) {
    to[i] = from[list[i]];
    to_lengths[i] = from_lengths[list[i]];
  }
}

// One work-item per kept constraint. The same for their numbers. No race: each its own word.
kernel void clean_gather_list(uint count, global const uint* list, global const uint* from, global uint* to) {
  FOR_EACH(i, count) to[i] = from[list[i]];
}

// One work-item per chosen constraint, which is every `step`-th of those that are kept. Copies its number, its ends and
// its length. No race: its own words.
kernel void clean_choose(uint count, uint step, global const uint* list, global const uint2* ends,
                         global const uint* lengths, global uint* to_list, global uint2* to_ends,
                         global uint* to_lengths) {
  FOR_EACH(i, count) {
    to_list[i] = list[i * step];
    to_ends[i] = ends[i * step];
    to_lengths[i] = lengths[i * step];
  }
}

// One work-item per kept constraint. Writes the place along the curve of the vertex where its walk begins, and its own
// number, to be sorted. No race: its own words.
kernel void clean_ranks(uint count, GCDT_LEVELS_POINTER levels, global const uint2* ends, global ulong* keys,
                        global uint* places) {
  FOR_EACH(i, count) {
    keys[i] = gcdt_rank_of_vertex(levels, ends[i].x);
    places[i] = i;
  }
}

// On GPUs constraints that are not taken in turn are put into cells of the curve instead of being sorted along it:
// those whose walks begin in the same cell stand side by side, in any order, since nothing that cleaning finds depends
// on it. One pass is enough, where a sort has one for each digit.

// The place along the curve of the vertex where a constraint's walk begins, without its `low` bits.
static inline uint cell_of(GCDT_LEVELS_POINTER levels, uint2 ends, uint low) {
  return gcdt_rank_of_vertex(levels, ends.x) >> low;
}

// One work-group per part, of `span` constraints, the last one of fewer. `cells`, at most GCDT_CLEAN_CELLS, is more
// than any cell's number.
// Reads: ends. Writes: table, all cells of the part, which has one owner. A count has one writer between barriers, but
// for the loop over constraints, where they are added to by atomics.
// After: table[c * parts + p] counts the constraints of part p that begin in cell c.
kernel void clean_count_cells(uint count, uint span, uint parts, uint cells, uint low, GCDT_LEVELS_POINTER levels,
                              global const uint2* ends, global uint* table) {
  local uint counts[GCDT_CLEAN_CELLS];
  const uint lane = get_local_id(0), lanes = get_local_size(0);
  for (uint part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const uint begin = part * span, end = min(begin + span, count);
    for (uint c = lane; c < cells; c += lanes) counts[c] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = begin + lane; i < end; i += lanes) atomic_inc(counts + cell_of(levels, ends[i], low));
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint c = lane; c < cells; c += lanes) table[c * parts + part] = counts[c];
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// One work-group per part, as before. Moves each constraint's number, vertices and length to where its cell's are.
// Reads: table, scanned; from, from_ends, from_lengths. Writes: places, the place where each was; to, to_ends,
// to_lengths. The scanned table gives each cell of each part its own range, in which atomic_inc gives out each place
// once. After: cells stand one behind the other, and places are a permutation.
kernel void clean_to_cells(uint count, uint span, uint parts, uint cells, uint low, GCDT_LEVELS_POINTER levels,
                           global const uint* table, global const uint* from, global const uint2* from_ends,
                           global const uint* from_lengths, global uint* places, global uint* to, global uint2* to_ends,
                           global uint* to_lengths) {
  local uint next[GCDT_CLEAN_CELLS];
  const uint lane = get_local_id(0), lanes = get_local_size(0);
  for (uint part = get_group_id(0); part < parts; part += get_num_groups(0)) {
    const uint begin = part * span, end = min(begin + span, count);
    for (uint c = lane; c < cells; c += lanes) next[c] = table[c * parts + part];
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = begin + lane; i < end; i += lanes) {
      const uint2 of = from_ends[i];
      const uint place = atomic_inc(next + cell_of(levels, of, low));
      places[place] = i;
      to[place] = from[i];
      to_ends[place] = of;
      to_lengths[place] = from_lengths[i];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// One work-item per kept constraint, in any order. Writes how many pieces it becomes at places[c]. No race: places is a
// permutation. After the scan: where the pieces of the constraint at each place begin.
kernel void clean_count(uint count, global const uint* begins, global const uint* offsets, global const uint* places,
                        global uint* pieces) {
  FOR_EACH(c, count) pieces[places[c]] = offsets[begins[c + 1u]] - offsets[begins[c]] + 1u;
}

// What walks of parts have come to: steps of turns, vertices, constraints that are edges already, edges passed. (Parts
// are shared out by the sum of these, which is no less than that of all constraints.)
typedef struct Cleaned {
  u32 steps, hits, edges_already;
  u64 pairs;
} Cleaned;

// What clean_walk does for `items`, of the parts.
GCDT_APART Cleaned walk_parts(Items items, uint task, uint parts, Walked walked, Gates gates, global const uint2* ends,
                              global const uint* list, global const uint* begins, global const int4* lines,
                              global const uint* part_piece, global uint* part_face, global uint* passed,
                              global const uint* searched, global const uint* offsets, global uint* counts,
                              global uint* first_hits, global uint* hits, volatile global uint* crossed,
                              volatile global Counters* counters) {
  const Mesh mesh = walked.mesh;
  Cleaned done = {0u, 0u, 0u, 0u};
  FOR_ITEMS(part, items) {
    uint found = 0, edges = 0;
    const uint before = task == GCDT_CLEAN_ALL ? 0u : offsets[part + 1u] - offsets[part];
    if (task == GCDT_CLEAN_WRITE && before == 1u) hits[offsets[part]] = first_hits[part];
    if (part < parts &&
        (task == GCDT_CLEAN_ALL || (task == GCDT_CLEAN_REST ? searched[part] == GCDT_NONE : before > 1u))) {
      const uint c = part_piece[part];
      Walk w;
      uint event =
          walk_begin(&w, mesh, part_face[part], ends[c], lines[c], part - begins[c], begins[c + 1u] - begins[c]);
      // Ends: every event lies further along the piece.
      while (event == WALK_CROSS || event == WALK_HIT) {
        event = end_of_part(&w, mesh, event);
        if (event == WALK_HIT) {
          if (task == GCDT_CLEAN_WRITE)
            hits[offsets[part] + found] = w.hit;
          else if (found == 0u)
            first_hits[part] = w.hit;
          ++found;
          event = walk_turn(&w, walked, w.hit, &done.steps);
        } else if (event == WALK_CROSS) {
          event = walk_cross(&w, mesh, look_behind(&w, mesh, gates));
          ++edges;
        }
      }
      if (task != GCDT_CLEAN_WRITE) passed[part] = edges;
      if (event == WALK_END) {
        if (task != GCDT_CLEAN_WRITE && edges > 0u) {
          atomic_add(crossed + list[c], edges);
          done.pairs += edges;
        }
        done.edges_already += edges == 0u && found == 0u && begins[c + 1u] - begins[c] == 1u ? 1u : 0u;
      } else if (task == GCDT_CLEAN_ALL) {
        part_face[part] = GCDT_NONE;
        lose_patience(&walked);
        found = 0u;
        atomic_inc(&counters->unfinished);
      } else {
        atomic_or(&counters->failed, GCDT_FAILED_WALK);
      }
      done.hits += found;
    } else {
      found = before;
    }
    if (task != GCDT_CLEAN_WRITE) counts[part] = found;
  }
  return done;
}

// One work-item per part. Walks it in the mesh, which nobody changes, and counts the vertices on it, or writes them in
// order to hits[offsets[part] ...]: the first of a part is known from counting, so that only parts with more walk
// again. No race: each part has its own words, or its own range; faces crossed are added to their constraint's count,
// and to that of all. After counting: counts[part] for every part, 0 beyond the last; first_hits[part] if that is not
// 0; part_face[part], where it begins, is GCDT_NONE if it failed; passed[part] counts the edges that it passes.
kernel void clean_walk(uint task, uint pieces, uint capacity, GCDT_MESH_PARAMETERS, GCDT_FAN_PARAMETERS,
                       GCDT_GATE_PARAMETERS, global const uint2* ends, global const uint* list,
                       global const uint* begins, global const int4* lines, global const uint* part_piece,
                       global uint* part_face, global uint* passed, global const uint* searched,
                       global const uint* offsets, global uint* counts, global uint* first_hits, global uint* hits,
                       volatile global uint* crossed, volatile global Counters* counters) {
  local uint sum;
  const Walked walked =
      make_walked(make_mesh(n, points, face_data, edge_faces), make_fans(fans_made, fan_begins, fan_faces), 1u);
  const Cleaned done = walk_parts(items_of_this(capacity), task, begins[pieces], walked,
                                  make_gates(gates_made, gates_at), ends, list, begins, lines, part_piece, part_face,
                                  passed, searched, offsets, counts, first_hits, hits, crossed, counters);
  const bool counting = task != GCDT_CLEAN_WRITE;
  add_for_group(&sum, &counters->steps_low, &counters->steps_high, counting ? done.steps : 0u);
  add_lengths(&sum, &counters->pairs_low, done.pairs);
  const uint hit = sum_of_group(&sum, done.hits);
  if (get_local_id(0) == 0 && counting && hit > 0u) atomic_add(&counters->hits, hit);
  const uint edges_already = sum_of_group(&sum, done.edges_already);
  if (get_local_id(0) == 0 && counting && edges_already > 0u) atomic_add(&counters->existing_edges, edges_already);
}

// One work-item per part. A constraint with hits h1 .. hk becomes the pieces a-h1, h1-h2, .. hk-b. Each
// part writes the pieces that end in its hits, the last part also the final one: piece number = hits
// before it + constraints before it, among all that are ascending (firsts, at places, where the list is along the
// curve), so no two write the same word. After: keys = (rank, rank) of the ends, lower first, and the source of every
// piece, in order of the sources; of a constraint's crossed faces what comes to each of its pieces; and for a source
// that stays whole its parts.
kernel void clean_pieces(uint pieces, uint along_curve, uint bits, GCDT_LEVELS_POINTER levels, global const uint2* ends,
                         global const uint* begins, global const uint* part_piece, global const uint* offsets,
                         global const uint* hits, global const uint* list, global const uint* places,
                         global const uint* firsts, global ulong* keys, global uint* sources, global uint* crossed,
                         global uint2* whole) {
  const uint parts = begins[pieces];
  FOR_EACH(part, parts) {
    const uint c = part_piece[part];
    const uint first = offsets[begins[c]], last = offsets[part + 1u];
    const uint at = along_curve ? firsts[places[c]] : first + c;
    const bool ends_here = part + 1u == begins[c + 1u];
    uint before = gcdt_rank_of_vertex(levels, offsets[part] == first ? ends[c].x : hits[offsets[part] - 1u]);
    for (uint i = offsets[part]; i < last + (ends_here ? 1u : 0u); ++i) {
      const uint rank = gcdt_rank_of_vertex(levels, i < last ? hits[i] : ends[c].y);
      keys[at + (i - first)] = ((ulong)min(before, rank) << bits) | max(before, rank);
      sources[at + (i - first)] = list[c];
      before = rank;
    }
    if (!ends_here) continue;
    crossed[list[c]] = crossed[list[c]] / (last - first + 1u);
    whole[list[c]] = last == first ? (uint2)(begins[c], begins[c + 1u] - begins[c]) : (uint2)(0u, 0u);
  }
}

// One work-item per distinct piece. Writes its ends, lower rank first, its weight, and its source's parts if it is all
// of that. No race: its own words.
kernel void clean_ends(uint count, uint bits, GCDT_LEVELS_POINTER levels, global const ulong* keys,
                       global const uint* firsts, global const uint* sources, global const uint* crossed,
                       global const uint2* whole, global uint2* ends, global uint* weights, global uint2* parts) {
  const uint last = levels->count - 1u;
  FOR_EACH(i, count) {
    const ulong key = keys[firsts[i]];
    ends[i] = (uint2)(gcdt_vertex_of_rank(levels, last, (uint)(key >> bits)),
                      gcdt_vertex_of_rank(levels, last, (uint)(key & (((ulong)1 << bits) - 1u))));
    weights[i] = crossed[sources[firsts[i]]];
    parts[i] = whole[sources[firsts[i]]];
  }
}

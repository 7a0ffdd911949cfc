// SPDX-License-Identifier: Apache-2.0
// Flips within patches, of large meshes alone: a program of its own, which others need not wait for.
#include "flip/patches.h"

// One work-group per patch (patches.h) of `units` of the evenly spread vertices up to `level`; isolated ones come
// besides. `memory` has GCDT_PATCH_WORDS(room) words. Takes all edges of the patch's numbers out of the queue, and does
// up to `most` rounds among the patch's faces: an illegal edge between two of them claims both in local memory, and is
// flipped if it has both.
// Writes words of the patch's faces alone, which no other group does (L1); within the group claims decide. It reads
// words of edge_faces that others may be writing where a face is another patch's. A side is handed on only to faces of
// the same patch, so that "not mine" is right whatever is read, and no more is done with it. Marks: the group takes the
// mark only from edges of its own numbers, and then tests the edge or marks it again; all others set marks, by atomics.
// So no mark is lost of an edge that needs a test. Ends: after `most` rounds. After: an edge that is not queued is
// legal or constrained; counters->patch_rounds is the most rounds of a patch.
kernel void flip_patches(uint level, uint units, uint patches, uint room, uint most, GCDT_LEVELS_POINTER levels,
                         GCDT_MESH_PARAMETERS, global uint* edge_marks, volatile global Counters* counters,
                         local uint* memory) {
  local uint sum;
  local PatchLevel* of_patch = (local PatchLevel*)memory;
  volatile local uint *tested = memory + GCDT_PATCH_LENGTHS, *found = tested + 1, *claims = memory + GCDT_PATCH_CLAIMS;
  volatile local uint* queued = memory + GCDT_PATCH_QUEUED(room);
  local ushort *tests = (local ushort*)(memory + GCDT_PATCH_LISTS(room)), *illegal = tests + 3u * room;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const PatchQueue queue = {.tests = tests, .queued = queued, .length = tested};
  const uint span = units * levels->stride[level];
  uint flips = 0, rounds = 0;
  FOR_EACH_OF_GROUPS(number, 0u, patches) {
    const Patch patch = make_patch(of_patch, levels, level, number * span, (number + 1u) * span, room);
    const uint vertices = vertices_of_patch(patch), edges = 3u * vertices, words = (edges + 31u) / 32u;
    if (get_local_id(0) == 0) *tested = edges;
    FOR_ALL_TILES(tile, edges) {
      const uint i = tile + get_local_id(0);
      if (i < 2u * vertices) claims[i] = 0u;
      if (i < edges) take_edge(patch, mesh, edge_marks, tests, i);
    }
    leave_beyond(patch, mesh, edge_marks);
    barrier(CLK_LOCAL_MEM_FENCE);
    uint round = 0;
    for (;;) {
      const uint count = *tested;
      barrier(CLK_LOCAL_MEM_FENCE);
      if (count == 0u || round == most) break;
      if (get_local_id(0) == 0) *tested = *found = 0u;
      FOR_ALL_TILES(tile, words) {
        if (tile + get_local_id(0) < words) queued[tile + get_local_id(0)] = 0u;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      FOR_ALL_TILES(tile, count) {
        const uint i = tile + get_local_id(0);
        if (i < count && test_in_patch(patch, mesh, edge_marks, claims, round, tests[i]))
          illegal[atomic_inc(found)] = tests[i];
      }
      barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
      const uint candidates = *found;
      FOR_ALL_TILES(tile, candidates) {
        const uint i = tile + get_local_id(0);
        if (i < candidates) flips += flip_in_patch(patch, mesh, edge_marks, claims, round, illegal[i], queue);
      }
      barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
      ++round;
    }
    const uint left = *tested;
    FOR_ALL_TILES(tile, left) {
      const uint i = tile + get_local_id(0);
      if (i < left) atomic_or(edge_marks + edge_of_patch(patch, mesh, tests[i]), GCDT_MARK_QUEUED);
    }
    rounds = max(rounds, round);
  }
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
  if (get_local_id(0) == 0 && rounds > counters->patch_rounds) atomic_max(&counters->patch_rounds, rounds);
}

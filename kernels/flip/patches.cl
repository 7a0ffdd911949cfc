// SPDX-License-Identifier: Apache-2.0
// Flips within patches and districts, of large meshes alone: a program of its own, which others need not wait for.
#include "flip/districts.h"
#include "flip/patches.h"

// One work-group per patch (patches.h) of `units` of the evenly spread vertices up to `level`; isolated ones come
// besides. `memory` has GCDT_PATCH_WORDS(room, others) words; `others` is a power of two. Takes all edges of the
// patch's numbers out of the queue, and does up to `most` rounds among the patch's faces: each illegal edge between two
// of them asks for both, and is flipped if it gets both.
// Reads and writes words of the patch's faces, of their sides and of marks of the patch's edges, which no other group
// does (L1), but that it reads the other side of an edge of its number that has another patch's face there, which that
// patch may be handing on: only to faces of its own, so that "not mine" is right whatever is read, and no more is done
// with it. Points nobody changes. Within the group: taking in, tests, flips and putting back are set apart by barriers;
// what a test takes or lists it does by atomics, and a flip writes words of two faces that only its edge has. The bits
// of faces are cleared before each round. Ends: after `most` rounds. After: an edge that is not queued is legal or
// constrained; counters->patch_rounds[0] is the most rounds of a patch, and counters->patches_left counts those that
// have left all to others.
kernel void flip_patches(uint level, uint units, uint patches, uint room, uint others, uint most,
                         GCDT_LEVELS_POINTER levels, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                         volatile global Counters* counters, local uint* memory) {
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const uint ranks = units * levels->stride[level];
  uint flips = 0, rounds = 0, left = 0;
  FOR_EACH_OF_GROUPS(number, 0u, patches) {
    const Span span = make_span(memory, levels, level, number * ranks, (number + 1u) * ranks, room);
    const Patch patch = make_patch(span, memory, room, others);
    const uint vertices = vertices_of_span(span), edges = 3u * vertices;
    leave_beyond(span, mesh, edge_marks);
    const uint begin = vertices - min(PATCH_SAMPLE, vertices);
    take_all_faces(patch, mesh, begin, vertices);
    const bool crowded = *patch.others_kept > others / 2u;
    barrier(CLK_LOCAL_MEM_FENCE);  // all have read it before it grows
    if (crowded) {
      leave_all(span, mesh, edge_marks);
      ++left;
    } else {
      take_all_faces(patch, mesh, 0u, begin);
      FOR_ALL_TILES(tile, vertices) {
        if (tile + get_local_id(0) < vertices) take_edges(patch, mesh, edge_marks, tile + get_local_id(0));
      }
      barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);  // marks, too, which are set again below
      rounds = max(rounds, rounds_of_patch(patch, mesh, vertices, most, &flips));
      FOR_ALL_TILES(tile, edges) {
        const uint i = tile + get_local_id(0);
        if (i < 2u * vertices) put_face(patch, mesh, i);
        if (i < edges) put_edge(patch, mesh, edge_marks, i);
      }
    }
  }
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
  if (get_local_id(0) != 0) return;
  if (rounds > counters->patch_rounds[0]) atomic_max(&counters->patch_rounds[0], rounds);
  if (left > 0u) atomic_add(&counters->patches_left, left);
}

// One work-group per district (districts.h) of `units` of the evenly spread vertices up to `level`, the first of which
// has `before` less. `memory` has GCDT_DISTRICT_WORDS(room) words. Takes the queued edges of the district's numbers out
// of the queue, and does up to `most` rounds among the district's faces, as flip_patches does.
// Reads and writes words of the district's faces and of their sides, which no other group writes (L1); within the group
// only a flip writes them, of two faces that only its edge has, and barriers set flips apart from tests. It reads
// words of edge_faces that others may be writing where a face is another district's, and no more is done with what is
// read: "not mine" is right. Marks: the group takes the mark only from edges of its own numbers, and then tests the
// edge or marks it again; all others set marks, by atomics. So no mark is lost of an edge that needs a test. Ends:
// after `most` rounds. After: an edge that is not queued is legal or constrained; counters->patch_rounds[turn] is the
// most rounds of a district.
kernel void flip_districts(uint turn, uint level, uint units, uint before, uint districts, uint room, uint most,
                           GCDT_LEVELS_POINTER levels, GCDT_MESH_PARAMETERS, global uint* edge_marks,
                           volatile global Counters* counters, local uint* memory) {
  local uint sum;
  const Mesh mesh = make_mesh(n, points, face_data, edge_faces);
  const uint ranks = units * levels->stride[level], missing = before * levels->stride[level];
  uint flips = 0, rounds = 0;
  FOR_EACH_OF_GROUPS(number, 0u, districts) {
    const Span span =
        make_span(memory, levels, level, max(number * ranks, missing) - missing, (number + 1u) * ranks - missing, room);
    const District district = make_district(span, memory, room);
    const uint vertices = vertices_of_span(span);
    FOR_ALL_TILES(tile, vertices) {
      if (tile + get_local_id(0) < vertices) take_queued(district, mesh, edge_marks, tile + get_local_id(0));
    }
    leave_beyond(span, mesh, edge_marks);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    rounds = max(rounds, rounds_of_district(district, mesh, edge_marks, vertices, most, &flips));
    FOR_ALL_TILES(tile, vertices) {
      if (tile + get_local_id(0) < vertices) leave_queued(district, mesh, edge_marks, tile + get_local_id(0));
    }
  }
  add_for_group(&sum, &counters->flips_low, &counters->flips_high, flips);
  if (get_local_id(0) == 0 && rounds > counters->patch_rounds[turn]) atomic_max(&counters->patch_rounds[turn], rounds);
}

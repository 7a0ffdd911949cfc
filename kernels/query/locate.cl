// SPDX-License-Identifier: Apache-2.0
// Point location in a finished mesh that covers the convex hull: queries are placed on the grid as vertices
// are, and each walks from a vertex beside it on the curve. They walk in the order of the curve, roughly, so that
// work-items side by side go through triangles that are near each other.
//
// The walk goes over any edge that has the query strictly on its other side, the first of the three from a
// place that a hash of query and step chooses. In a Delaunay triangulation every such walk ends; in a
// constrained one a fixed choice could go in circles, a random one leaves every circle: from each triangle
// some choice comes nearer along the segment to the query. The result does not depend on the way.
#include "common/corners.h"
#include "common/predicates.h"
#include "common/search.h"
#include "order/decimals.h"
#include "query/locate.h"

// Three points of triangle t.
typedef struct Corners {
  Vertex at[3];
} Corners;

GCDT_INLINE Corners corners_of(global const uint* corners, uint t, global const uint* input_vertex, uint by_input,
                               global const int2* points) {
  Corners c;
  c.at[0] = vertex_at(points, vertex_of(input_vertex, by_input, corners[3u * t]));
  c.at[1] = vertex_at(points, vertex_of(input_vertex, by_input, corners[3u * t + 1u]));
  c.at[2] = vertex_at(points, vertex_of(input_vertex, by_input, corners[3u * t + 2u]));
  return c;
}

// Twice the area of the query with the edge across from corner k: negative if the query is beyond that edge.
GCDT_INLINE i64 area_across(Corners c, uint k, Vertex query) {
  return gcdt_orient2d_finite(c.at[next_corner(k)], c.at[previous_corner(k)], query);
}

GCDT_INLINE Vertex query_of(u64 key) { return gcdt_finite_vertex(gcdt_gather_bits(key), gcdt_gather_bits(key >> 1)); }

// One work-item per triangle.
// Reads corners. Writes least[v] for the vertices v of its corners, by atomic_min: the order cannot matter.
// After this kernel least[v] is the least triangle that has v as a corner, GCDT_NONE (as before) without any.
kernel void least_triangles(const uint count, const uint by_input, global const uint* input_vertex,
                            global const uint* corners, volatile global uint* least) {
  FOR_EACH(t, count)
  for (uint k = 0; k < 3; ++k) atomic_min(&least[vertex_of(input_vertex, by_input, corners[3u * t + k])], t);
}

// One work-item per input vertex.
// Reads input_vertex and least. Writes triangles[i].
// Word i has one writer.
// After this kernel triangles[i] is the least triangle at input vertex i, -1 if there is none.
kernel void number_least(const uint count, global const uint* input_vertex, global const uint* least,
                         global int* triangles) {
  FOR_EACH(i, count) triangles[i] = (int)least[input_vertex[i]];
}

// The 32 highest bits of a Morton code.
GCDT_INLINE uint high_bits(u64 key) { return (uint)(key >> (GCDT_MORTON_BITS - 32u)); }

// One work-item per query.
// Reads coordinates and the grid. Writes keys[i] and numbers[i]; found[0], found[1] and found[2] by atomic_min.
// Words i have one writer; least values are the same in any order.
// After this kernel keys[i] is the Morton code of the query's grid point, or GCDT_OFF_GRID. found[0] is the first
// coordinate that is not finite; found[1] are the least high bits of queries on the grid, and found[2] the complement
// of the greatest; or GCDT_NONE, as before, if there are none.
kernel void place_queries(const uint count, const uint type, global const ulong* coordinates, const uint by_decimals,
                          global const Scale* scale, global const Decimals* decimals, global ulong* keys,
                          global uint* numbers, volatile global uint* found) {
  local uint of_group[2];
  uint least = GCDT_NONE, least_complement = GCDT_NONE;
  FOR_EACH(i, count) {
    uint place[2] = {0u, 0u}, outside = 0u;
    for (uint axis = 0; axis < 2; ++axis) {
      const u64 bits = gcdt_coordinate(coordinates, type, 2u * i + axis);
      if (!gcdt_is_finite(bits)) {
        atomic_min(found, 2u * i + axis);
        outside = 1u;
        continue;
      }
      const Quantised q = gcdt_place_query(bits, by_decimals, scale, decimals, axis);
      place[axis] = q.value;
      outside |= q.outside;
    }
    const u64 key = outside ? GCDT_OFF_GRID : gcdt_morton(place[0], place[1]);
    keys[i] = key;
    numbers[i] = i;
    if (outside) continue;
    least = min(least, high_bits(key));
    least_complement = min(least_complement, ~high_bits(key));
  }
  if (get_local_id(0) == 0) of_group[0] = of_group[1] = GCDT_NONE;
  barrier(CLK_LOCAL_MEM_FENCE);
  atomic_min(of_group, least);
  atomic_min(of_group + 1, least_complement);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0) {
    atomic_min(found + 1, of_group[0]);
    atomic_min(found + 2, of_group[1]);
  }
}

// The vertex at which a query's walk begins: the last one on the curve whose Morton code is not above the query's or
// the next one.
GCDT_INLINE uint start_of(global const Levels* levels, global const int2* points, Vertex query) {
  const int2 at = (int2)((int)query.x, (int)query.y);
  const uint all = levels->count, before = last_on_curve(levels, all - 1u, points, 0u, levels->n, at);
  return nearer_coarse_vertex(levels, all, points, levels->n, before, at);
}

// A number without a pattern.
GCDT_INLINE uint hash_of(uint query, uint step) {
  uint x = (query ^ (step * 0x9E3779B1u)) * 0x85EBCA6Bu;
  x ^= x >> 15;
  return x * 0xC2B2AE35u >> 16;
}

// The first edge from `first` on that has the query beyond it; 3: none. Not a loop: a driver that ends loops after some
// number of rounds may end the walk, which goes on in the next launch, but not this.
GCDT_INLINE uint edge_to_cross(Corners c, uint first, Vertex query) {
  const uint second = next_corner(first), third = next_corner(second);
  if (area_across(c, first, query) < 0) return first;
  if (area_across(c, second, query) < 0) return second;
  return area_across(c, third, query) < 0 ? third : 3u;
}

// The triangle of vertex v's fan that the query's direction from v points into. On the convex hull the fan is
// open, and its directions span at most 180 degrees: the last of its triangles that has the query left of its ray, or
// on it; if the query is outside of the fan, the first or the last triangle. Ends: the range halves.
static uint triangle_towards(Fans fans, uint v, Vertex query, global const uint* corners, global const int* neighbours,
                             uint by_input, global const uint* input_vertex, global const int2* points, uint n) {
  const Vertex at = vertex_at(points, v);
  const uint begin = fans.begins[v], first = fans.faces[begin].x;
  uint k = 0u;
  while (k < 2u && vertex_of(input_vertex, by_input, corners[3u * first + k]) != v) ++k;
  uint steps = 0u;
  if (neighbours[3u * first + previous_corner(k)] >= 0) return face_of_fan(fans, points, n, v, at, query, &steps);
  uint low = begin, high = fans.begins[v + 1u];
  while (high - low > 1u) {
    const uint middle = low + (high - low) / 2u;
    if (gcdt_orient2d_finite(at, vertex_at(points, fans.faces[middle].y), query) >= 0)
      low = middle;
    else
      high = middle;
  }
  return fans.faces[low].x;
}

// The lesser of two triangles, of which -1 is none.
GCDT_INLINE int lesser(int a, int b) { return a < 0 ? b : b < 0 ? a : min(a, b); }

// The least kept triangle that holds the query, which triangle t of the whole mesh with corners c does; -1 if there is
// none. `kept`: the number of a triangle in the kept mesh or -1, if `selected`; else both are the same mesh. `least`:
// the kept mesh's least triangle at each vertex.
static int least_that_holds(Corners c, uint t, Vertex query, global const uint* corners, global const int* neighbours,
                            uint by_input, global const uint* input_vertex, uint selected, global const int* kept,
                            global const uint* least) {
  uint zeros = 0, on = 0, corner = 0;
  for (uint k = 0; k < 3; ++k) {
    const uint zero = area_across(c, k, query) == 0;
    zeros += zero;
    if (zero)
      on = k;
    else
      corner = k;
  }
  if (zeros == 2u) return (int)least[vertex_of(input_vertex, by_input, corners[3u * t + corner])];
  const int found = selected ? kept[t] : (int)t;
  if (zeros == 0u) return found;
  const int across = neighbours[3u * t + on];
  return lesser(found, across < 0 || !selected ? across : kept[across]);
}

// One work-item per query, in the order of keys; numbers are a permutation.
// Reads keys, levels and starts (a triangle at each vertex), the mesh and its fans; of the kept mesh (least_that_holds)
// corners and least. Writes places[i], *pending by atomic_or, and of query q = numbers[i] triangles, areas and
// found_corners.
// Word i has one reader and writer, and so have those of q.
// After this kernel the query is GCDT_LOCATE_STEPS further, at triangle places[i], and *pending is 1; or places[i] is
// GCDT_NONE, and triangles[q] is the least kept triangle that holds the query, its border included, -1 if there is
// none; areas[3q + k] is twice the area of the query with the edge across from that triangle's corner k, and
// found_corners its corners; 0 without a triangle.
// The loop ends after that many steps.
//
// At a vertex that has a fan a step turns around it as far as the query's direction, by bisection: the same triangles
// that a walk over edges at that vertex goes through, since it turns by less than 180 degrees. So in a Delaunay
// triangulation these walks end, too. Every second such step, by the hash, goes over one edge all the same: in a
// constrained triangulation walks must not be without a choice (above).
kernel void locate_walk(const uint count, const uint begun, global const uint* corners, global const int* neighbours,
                        const uint by_input, global const uint* input_vertex, const uint n, global const int2* points,
                        GCDT_FAN_PARAMETERS, global const Levels* levels, global const ulong* keys,
                        global const uint* numbers, global const uint* starts, const uint selected,
                        global const int* kept, global const uint* kept_corners, global const uint* least,
                        global uint* places, global int* triangles, global uint* found_corners, global long* areas,
                        volatile global uint* pending) {
  const Fans fans = make_fans(fans_made, fan_begins, fan_faces);
  FOR_EACH(i, count) {
    const uint q = numbers[i];
    const ulong key = keys[i];
    const Vertex query = query_of(key);
    uint t = GCDT_NONE;
    if (begun > 0u) {
      t = places[i];
      if (t == GCDT_NONE) continue;
    } else if (key != GCDT_OFF_GRID) {
      t = starts[start_of(levels, points, query)];
    }
    Corners c;
    bool arrived = false;
    for (uint step = 0; step < GCDT_LOCATE_STEPS && t != GCDT_NONE && !arrived; ++step) {
      c = corners_of(corners, t, input_vertex, by_input, points);
      const uint hash = hash_of(i, begun + step), k = edge_to_cross(c, hash % 3u, query);
      if (k == 3u) {
        arrived = true;
        continue;
      }
      if (fans.made && (hash & 0x100u)) {
        uint v = vertex_of(input_vertex, by_input, corners[3u * t + next_corner(k)]);
        if (!has_fan(fans, v)) v = vertex_of(input_vertex, by_input, corners[3u * t + previous_corner(k)]);
        const uint there =
            has_fan(fans, v) ? triangle_towards(fans, v, query, corners, neighbours, by_input, input_vertex, points, n)
                             : t;
        if (there != t) {
          t = there;
          continue;
        }
      }
      t = (uint)neighbours[3u * t + k];  // -1, beyond an edge of the convex hull, is GCDT_NONE
    }
    const bool goes_on = t != GCDT_NONE && !arrived;
    places[i] = goes_on ? t : GCDT_NONE;
    if (goes_on) {
      atomic_or(pending, 1u);
      continue;
    }
    const int found =
        arrived ? least_that_holds(c, t, query, corners, neighbours, by_input, input_vertex, selected, kept, least)
                : -1;
    if (found >= 0 && (selected || (uint)found != t))
      c = corners_of(kept_corners, (uint)found, input_vertex, by_input, points);
    triangles[q] = found;
    for (uint k = 0; k < 3; ++k) {
      found_corners[3u * q + k] = found < 0 ? 0u : kept_corners[3u * (uint)found + k];
      areas[3u * q + k] = found < 0 ? 0 : area_across(c, k, query);
    }
  }
}

// One work-item per query.
// Reads triangles and areas. Writes weights.
// Words 3q .. 3q + 2 have one writer.
// After this kernel the weights are the areas' shares, in single precision: 0 outside.
kernel void locate_weights(const uint count, global const int* triangles, global const long* areas,
                           global float* weights) {
  FOR_EACH(q, count) {
    const long a = areas[3u * q], b = areas[3u * q + 1u], c = areas[3u * q + 2u];
    const float all = triangles[q] < 0 ? 1.0f : (float)(a + b + c);
    weights[3u * q] = (float)a / all;
    weights[3u * q + 1u] = (float)b / all;
    weights[3u * q + 2u] = (float)c / all;
  }
}

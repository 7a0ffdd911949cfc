// SPDX-License-Identifier: Apache-2.0
// Point location in a finished mesh that covers the convex hull: queries are placed on the grid as vertices
// are, sorted along the curve, and each walks from the vertex before it on the curve.
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

// One work-item per query.
// Reads coordinates and the grid. Writes keys[i] and numbers[i]; *not_finite by atomic_min.
// Words i have one writer; the least bad coordinate is the same in any order.
// After this kernel keys[i] is the Morton code of the query's grid point, or GCDT_OFF_GRID.
kernel void place_queries(const uint count, const uint type, global const ulong* coordinates, const uint by_decimals,
                          global const Scale* scale, global const Decimals* decimals, global ulong* keys,
                          global uint* numbers, volatile global uint* not_finite) {
  FOR_EACH(i, count) {
    uint place[2] = {0u, 0u}, outside = 0u;
    for (uint axis = 0; axis < 2; ++axis) {
      const u64 bits = gcdt_coordinate(coordinates, type, 2u * i + axis);
      if (!gcdt_is_finite(bits)) {
        atomic_min(not_finite, 2u * i + axis);
        outside = 1u;
        continue;
      }
      const Quantised q = gcdt_place_query(bits, by_decimals, scale, decimals, axis);
      place[axis] = q.value;
      outside |= q.outside;
    }
    keys[i] = outside ? GCDT_OFF_GRID : gcdt_morton(place[0], place[1]);
    numbers[i] = i;
  }
}

// One work-item per query, in sorted order.
// Reads levels, points, keys and starts: a triangle at each vertex. Writes places[i].
// Word i has one writer.
// After this kernel places[i] is a triangle at the last vertex whose Morton code is not above the query's (or
// at the first vertex), GCDT_NONE for a query off the grid.
kernel void locate_start(const uint count, global const Levels* levels, global const int2* points,
                         global const ulong* keys, global const uint* starts, global uint* places) {
  FOR_EACH(i, count) {
    const ulong key = keys[i];
    const uint last = levels->count - 1u, before = last_on_curve(levels, last, points, 0u, levels->n, key);
    places[i] = key == GCDT_OFF_GRID ? GCDT_NONE : starts[gcdt_vertex_of_rank(levels, last, before)];
  }
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

// One work-item per query, in sorted order.
// Reads keys, the mesh and its fans. Writes places[i], and *pending by atomic_or.
// Word i has one reader and writer.
// After this kernel the query has arrived, is known to be outside, or is GCDT_LOCATE_STEPS further and *pending is 1.
// The loop ends after that many steps.
//
// At a vertex that has a fan a step turns around it as far as the query's direction, by bisection: the same triangles
// that a walk over edges at that vertex goes through, since it turns by less than 180 degrees. So in a Delaunay
// triangulation these walks end, too. Every second such step, by the hash, goes over one edge all the same: in a
// constrained triangulation walks must not be without a choice (above).
kernel void locate_walk(const uint count, const uint begun, global const uint* corners, global const int* neighbours,
                        const uint by_input, global const uint* input_vertex, const uint n, global const int2* points,
                        GCDT_FAN_PARAMETERS, global const ulong* keys, global uint* places,
                        volatile global uint* pending) {
  const Fans fans = make_fans(fans_made, fan_begins, fan_faces);
  FOR_EACH(i, count) {
    uint t = places[i];
    if (t == GCDT_NONE || (t & GCDT_ARRIVED)) continue;
    const Vertex query = query_of(keys[i]);
    for (uint step = 0; step < GCDT_LOCATE_STEPS; ++step) {
      const Corners c = corners_of(corners, t, input_vertex, by_input, points);
      const uint hash = hash_of(i, begun + step), k = edge_to_cross(c, hash % 3u, query);
      if (k == 3u) {
        t |= GCDT_ARRIVED;
        break;
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
      const int across = neighbours[3u * t + k];
      t = (uint)across;  // -1, beyond an edge of the convex hull, is GCDT_NONE
      if (across < 0) break;
    }
    places[i] = t;
    if (t != GCDT_NONE && !(t & GCDT_ARRIVED)) atomic_or(pending, 1u);
  }
}

// The lesser of two triangles, of which -1 is none.
GCDT_INLINE int lesser(int a, int b) { return a < 0 ? b : b < 0 ? a : min(a, b); }

// One work-item per query, in sorted order.
// Reads keys, numbers, places; the whole mesh; kept, the number of a triangle in the kept mesh or -1 (if
// `selected`; else both are the same mesh); the kept mesh's corners, and least, its least triangle at each vertex.
// Writes triangles, weights and found_corners at the query's own number: numbers is a permutation.
// After this kernel triangles[q] is the least kept triangle that holds query q, its border included, -1 if
// there is none; areas[3q + k] is twice the area of the query with the edge across from that triangle's
// corner k, and found_corners its corners; 0 without a triangle.
kernel void locate_finish(const uint count, global const ulong* keys, global const uint* numbers,
                          global const uint* places, global const uint* corners, global const int* neighbours,
                          const uint by_input, global const uint* input_vertex, global const int2* points,
                          const uint selected, global const int* kept, global const uint* kept_corners,
                          global const uint* least, global int* triangles, global uint* found_corners,
                          global long* areas) {
  FOR_EACH(i, count) {
    const uint q = numbers[i];
    const Vertex query = query_of(keys[i]);
    int found = -1;
    if (places[i] != GCDT_NONE) {
      const uint t = places[i] & ~GCDT_ARRIVED;
      const Corners c = corners_of(corners, t, input_vertex, by_input, points);
      uint zeros = 0, on = 0, corner = 0;
      for (uint k = 0; k < 3; ++k) {
        const uint zero = area_across(c, k, query) == 0;
        zeros += zero;
        if (zero)
          on = k;
        else
          corner = k;
      }
      found = selected ? kept[t] : (int)t;
      if (zeros == 1u) {
        const int across = neighbours[3u * t + on];
        found = lesser(found, across < 0 || !selected ? across : kept[across]);
      }
      if (zeros == 2u) found = (int)least[vertex_of(input_vertex, by_input, corners[3u * t + corner])];
    }
    triangles[q] = found;
    Corners c;
    if (found >= 0) c = corners_of(kept_corners, (uint)found, input_vertex, by_input, points);
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

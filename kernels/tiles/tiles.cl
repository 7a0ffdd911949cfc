// SPDX-License-Identifier: Apache-2.0
// A tile's part in a problem that is cut (docs/scale.md): its vertices among all, what of its mesh is final, what the
// seam is to know of it, and where its triangles are in the result. Vertices are the tile's: its own by ascending input
// number, then the ends of other tiles' constraints that pass.
#include "common/corners.h"
#include "common/pieces.h"
#include "common/predicates.h"
#include "tiles/final_pieces.h"
#include "tiles/shares.h"
#include "tiles/tiles.h"

// ---- Its input --------------------------------------------------------------------------------------

// One work-item per number. Reads ids: those of own vertices ascend, and so do the others. Writes vertices[i], the
// tile's vertex of input number wanted[i]; `all` if it is not there. Word i has one writer.
kernel void tile_numbers(const uint count, const uint own, const uint all, global const uint* ids,
                         global const uint* wanted, global uint* vertices) {
  FOR_EACH(i, count) {
    const uint place = place_of_id(ids, 0u, own, wanted[i]);
    vertices[i] = place < own ? place : place_of_id(ids, own, all, wanted[i]);
  }
}

// One work-item per element of a list. Writes out[i]. Word i has one writer.
kernel void tile_gather(const uint count, global const uint* list, global const uint* from, global uint* out) {
  FOR_EACH(i, count) out[i] = from[list[i]];
}
kernel void tile_gather_points(const uint count, global const uint* list, global const int2* from, global int2* out) {
  FOR_EACH(i, count) out[i] = from[list[i]];
}

// One work-item per own vertex. Raises box to the greatest of x, y, and of what they are below the last grid point: by
// atomic_max, whose order cannot matter.
kernel void tile_box(const uint own, global const int2* points, volatile global uint* box) {
  uint4 most = (uint4)(0u, 0u, 0u, 0u);
  FOR_EACH(v, own) {
    const uint x = (uint)points[v].x, y = (uint)points[v].y;
    most = max(most, (uint4)(x, y, GCDT_TILE_LAST - x, GCDT_TILE_LAST - y));
  }
  atomic_max(box, most.x);
  atomic_max(box + 1, most.y);
  atomic_max(box + 2, most.z);
  atomic_max(box + 3, most.w);
}

// One work-item per own vertex. Writes flags[v]: whether another vertex stands for v. Word v has one writer.
kernel void tile_merged_flags(const uint own, global const uint* representatives, global uint* flags) {
  FOR_EACH(v, own) flags[v] = representatives[v] == v ? 0u : 1u;
}

// One work-item per own vertex. Reads the scan of those flags. Writes for each merged vertex its input number and that
// of its representative: places differ, by the scan.
kernel void tile_merged(const uint own, global const uint* before, global const uint* representatives,
                        global const uint* ids, global uint2* merged) {
  FOR_EACH(v, own)
  if (before[v + 1u] != before[v]) merged[before[v]] = (uint2)(ids[v], ids[representatives[v]]);
}

// One work-item per own vertex, of a tile without triangles. Writes wanted[v]: whether v stands for itself. Word v has
// one writer.
kernel void tile_standing(const uint own, global const uint* representatives, global uint* wanted) {
  FOR_EACH(v, own) wanted[v] = representatives[v] == v ? 1u : 0u;
}

// ---- Final triangles --------------------------------------------------------------------------------

// What of the box around the circle of a triangle is in the box of all vertices, as its least and its greatest corner
// (x, y). All of it is rounded outwards.
//
// Numbers are counted from corner a. Bounds, with e = 2^-24: a difference of coordinates is off by e of itself, b2 and
// c2 by 4 e, a product with another difference by 6 e, so a numerator by 8 e of h, the sum of its products' magnitudes;
// the area, which is exact as a 64-bit integer, by e, and 1 / (2 area) by 4 e. So the centre is off by less than
// 16 e h / |2 area| = 2^-20 h / |2 area| on either axis; slack has four times that. The square root is good to 3 ulp.
// A centre is less than 2^95 away; if it is more than 2^60, the squares might overflow, and all of the box is taken.
typedef struct Reach {
  int2 least, most;
} Reach;

#define REACH_TINY 0x1p-18f

// A whole number, not less (upwards) or not more than what, if it is of the grid's size; else beyond it.
static inline long whole_above(float what) {
  return what >= 0x1p33f ? (long)1 << 33 : convert_long_rtp(max(what, -0x1p33f));
}
static inline long whole_below(float what) {
  return what <= -0x1p33f ? -((long)1 << 33) : convert_long_rtn(min(what, 0x1p33f));
}

// Half of what the circle measures along one axis, where its other coordinate is between `least` and `most`: less than
// the radius if the centre is d beyond them.
static inline float half_width(float radius, float centre, float slack, float least, float most) {
  const float beyond = max(centre - most, least - centre);
  const float d = beyond - slack - (fabs(centre) + fabs(least) + fabs(most)) * REACH_TINY - 1.0f;
  const float width = d <= 0.0f ? radius : sqrt(max(0.0f, (radius - d) * (radius + d)));
  return width * (1.0f + REACH_TINY) + slack + 1.0f;
}

static inline Reach reach_of_circle(int2 a, int2 b, int2 c, int4 all) {
  const Vertex va = gcdt_finite_vertex(a.x, a.y), vb = gcdt_finite_vertex(b.x, b.y), vc = gcdt_finite_vertex(c.x, c.y);
  const float bx = (float)((long)b.x - a.x), by = (float)((long)b.y - a.y), cx = (float)((long)c.x - a.x),
              cy = (float)((long)c.y - a.y);
  const float scale = 0.5f / (float)gcdt_orient2d_finite(va, vb, vc);
  const float b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const float centre_x = (b2 * cy - c2 * by) * scale, centre_y = (c2 * bx - b2 * cx) * scale;
  const float slack_x = (fabs(b2 * cy) + fabs(c2 * by)) * scale * REACH_TINY,
              slack_y = (fabs(c2 * bx) + fabs(b2 * cx)) * scale * REACH_TINY;
  if (max(fabs(centre_x), fabs(centre_y)) > 0x1p60f) return (Reach){all.xy, all.zw};
  const float radius = sqrt(centre_x * centre_x + centre_y * centre_y) * (1.0f + REACH_TINY) + slack_x + slack_y;
  const float half_x = half_width(radius, centre_y, slack_y, (float)(all.y - (long)a.y), (float)(all.w - (long)a.y)),
              half_y = half_width(radius, centre_x, slack_x, (float)(all.x - (long)a.x), (float)(all.z - (long)a.x));
  Reach reach;
  reach.least.x = (int)clamp((long)a.x + whole_below(centre_x - half_x - slack_x), (long)all.x, (long)all.z);
  reach.least.y = (int)clamp((long)a.y + whole_below(centre_y - half_y - slack_y), (long)all.y, (long)all.w);
  reach.most.x = (int)clamp((long)a.x + whole_above(centre_x + half_x + slack_x), (long)all.x, (long)all.z);
  reach.most.y = (int)clamp((long)a.y + whole_above(centre_y + half_y + slack_y), (long)all.y, (long)all.w);
  return reach;
}

// The plane in GCDT_TILE_ROW x GCDT_TILE_ROW cells of 2^shift grid points a side, which begin at 0. One work-item per
// word. Writes the bits of 32 cells of a row: whether all points of the cell are the tile's. Word i has one writer.
kernel void tile_inner(const uint words, const uint shift, const ulong first_code, const ulong last_code,
                       global uint* inner) {
  FOR_EACH(i, words) {
    uint bits = 0;
    for (uint j = 0; j < 32u; ++j) {
      const uint cell = 32u * i + j, x = (cell % GCDT_TILE_ROW) << shift, y = (cell / GCDT_TILE_ROW) << shift,
                 beyond = (1u << shift) - 1u;
      if (gcdt_morton(x, y) >= first_code && gcdt_morton(x + beyond, y + beyond) <= last_code) bits |= 1u << j;
    }
    inner[i] = bits;
  }
}

static inline bool is_inner(global const uint* inner, uint x, uint y) {
  const uint cell = y * GCDT_TILE_ROW + x;
  return (inner[cell / 32u] >> (cell % 32u) & 1u) != 0u;
}

// Whether the circle is no wider than half a cell, and the square of a cell's size around corner a, which then has all
// of it, is the tile's: the cells of its least and its greatest corner are (T1 of docs/scale.md). The diameter is |ab|
// |bc| |ca| / |2 area|; here in units of a cell. Bounds, with e = 2^-24: a squared side is off by 4 e of itself, their
// product by 15 e, the area's square by 4 e, and REACH_TINY is more than all of that. A product of sides that is less
// than 2^-126, of which nothing may be left, is less than what stands on the right: twice the area is 2^-54 at least,
// since a cell has at most 2^27 points a side.
static inline bool is_within_cells(int2 a, int2 b, int2 c, uint shift, global const uint* inner) {
  const float cell = (float)(1u << shift), unit = 1.0f / cell;
  const int2 ab = b - a, ac = c - a, bc = c - b;
  const float bx = (float)ab.x * unit, by = (float)ab.y * unit, cx = (float)ac.x * unit, cy = (float)ac.y * unit,
              dx = (float)bc.x * unit, dy = (float)bc.y * unit;
  const float area = (float)((long)ab.x * ac.y - (long)ab.y * ac.x) * unit * unit;
  const float sides = (bx * bx + by * by) * (cx * cx + cy * cy) * (dx * dx + dy * dy);
  if (!(sides < 0.25f * (1.0f - REACH_TINY) * area * area) || shift == 0u) return false;
  const uint away = 1u << (shift - 1u), px = (uint)a.x, py = (uint)a.y;
  if (px < away || py < away) return false;
  const uint x = (px - away) >> shift, y = (py - away) >> shift, last_x = (px + away) >> shift,
             last_y = (py + away) >> shift;
  return last_x < GCDT_TILE_ROW && last_y < GCDT_TILE_ROW && is_inner(inner, x, y) && is_inner(inner, last_x, last_y);
}

// One work-item per triangle. Reads the mesh and points, and which cells are the tile's. Writes final[t]: whether the
// box around its circle, cut to `all`, the box of all vertices, is the tile's. Word t has one writer. For nearly all a
// cell says so, at a tenth of what the codes take. After this kernel the final triangles are of the whole result, but
// for those that an open constraint passes (T2).
kernel void tile_final(const uint triangles, global const uint* corners, global const int2* points, const int4 all,
                       const ulong first_code, const ulong last_code, const uint shift, global const uint* inner,
                       global uint* final) {
  FOR_EACH(t, triangles) {
    const int2 a = points[corners[3u * t]], b = points[corners[3u * t + 1u]], c = points[corners[3u * t + 2u]];
    bool is_final = is_within_cells(a, b, c, shift, inner);
    if (!is_final) {
      const Reach reach = reach_of_circle(a, b, c, all);
      is_final = code_of_point(reach.least) >= first_code && code_of_point(reach.most) <= last_code;
    }
    final[t] = is_final ? 1u : 0u;
  }
}

// One work-item per element of a list of triangles, which may have some more than once: all that write a word write 0.
kernel void tile_not_final(const uint count, global const uint* list, global uint* final) {
  FOR_EACH(i, count) final[list[i]] = 0u;
}

// ---- What the seam gets -----------------------------------------------------------------------------

// One work-item per triangle. Reads final, 1 or 0, and the mesh; pieces' ends as vertices of the mesh. Writes 1 to
// wanted[v] for the own corners of triangles that are not final, and to kept[p] for the pieces along edges of those
// that are. All that write a word write 1.
kernel void tile_mark(const uint triangles, const uint own, global const uint* final, global const uint* corners,
                      global const uchar* constrained, global const Levels* levels, global const uint* input_vertex,
                      const uint pieces, global const uint2* ends, global uint* wanted, global uint* kept) {
  FOR_EACH(t, triangles) {
    const uint is_final = final[t], marks = constrained[t];
    if (is_final && marks == 0u) continue;  // nearly all
    for (uint k = 0; k < 3u; ++k) {
      const uint v = corners[3u * t + k];
      if (!is_final) {
        if (v < own) wanted[v] = 1u;
      } else if ((marks >> k) & 1u) {
        const uint piece = find_piece(levels, pieces, ends, input_vertex[corners[3u * t + next_corner(k)]],
                                      input_vertex[corners[3u * t + previous_corner(k)]]);
        if (piece != GCDT_NONE) kept[piece] = 1u;
      }
    }
  }
}

// One work-item per triangle. Reads final, 1 or 0, and the mesh. Writes sides[t], the number of edges of a final
// triangle that have no final neighbour; 0 for others. Word t has one writer.
kernel void tile_sides(const uint triangles, global const uint* final, global const int* neighbours,
                       global uint* sides) {
  FOR_EACH(t, triangles) {
    uint count = 0;
    for (uint k = 0; k < 3u; ++k) {
      const int u = neighbours[3u * t + k];
      if (u < 0 || final[u] == 0u) ++count;
    }
    sides[t] = final[t] ? count : 0u;
  }
}

// One work-item per triangle. Reads the scans of sides and of final, and the mesh. Writes the edges of final triangles
// without a final neighbour: the triangle's number among the final ones, where the edge begins and ends, and k with
// marks (tiles.h). Places differ, by the scan of sides.
kernel void tile_border(const uint triangles, global const uint* sides, global const uint* before,
                        global const uint* corners, global const int* neighbours, global const uchar* constrained,
                        global uint4* border) {
  FOR_EACH(t, triangles) {
    uint place = sides[t];
    if (sides[t + 1u] == place) continue;  // nearly all
    for (uint k = 0; k < 3u; ++k) {
      const int u = neighbours[3u * t + k];
      if (u >= 0 && before[u + 1] != before[u]) continue;
      const uint marks = (u < 0 ? GCDT_TILE_ON_HULL : 0u) | ((constrained[t] >> k) & 1u ? GCDT_TILE_CONSTRAINED : 0u);
      border[place++] =
          (uint4)(before[t], corners[3u * t + next_corner(k)], corners[3u * t + previous_corner(k)], k | marks);
    }
  }
}

// One work-item per triangle. Reads the scan of final, and the mesh. Writes the final triangles' arrays, where
// neighbours are numbers of final triangles, or -1 where there is none. Places differ, by the scan.
kernel void tile_finals(const uint triangles, global const uint* before, global const uint* corners,
                        global const int* neighbours, global const uchar* constrained, global uint* out_corners,
                        global int* out_neighbours, global uchar* out_constrained) {
  FOR_EACH(t, triangles) {
    const uint r = before[t];
    if (before[t + 1u] == r) continue;
    for (uint k = 0; k < 3u; ++k) {
      const int u = neighbours[3u * t + k];
      out_corners[3u * r + k] = corners[3u * t + k];
      out_neighbours[3u * r + k] = u < 0 || before[u + 1] == before[u] ? -1 : (int)before[u];
    }
    out_constrained[r] = constrained[t];
  }
}

// ---- The result -------------------------------------------------------------------------------------

// One work-item per GCDT_TILE_STEP final triangles. Writes codes[i], of the first corner of the first of them. Word i
// has one writer.
kernel void tile_codes(const uint count, global const uint* corners, global const int2* points, global ulong* codes) {
  FOR_EACH(i, count) codes[i] = code_of_point(points[corners[3u * GCDT_TILE_STEP * i]]);
}

// One work-item per corner of a final triangle, or end of a kept piece, that leaves the device before its place is
// known. Makes the tile's vertex an input number. Word i is read and written by one work-item.
kernel void tile_input_numbers(const uint count, global const uint* ids, global uint* corners) {
  FOR_EACH(i, count) corners[i] = ids[corners[i]];
}

// One work-item per triangle of the seam among those of the tile. Reads its key, the codes of its first two vertices,
// the tile's triangles, which are in the order of theirs, and the scan of final; not that if all of them are. Writes
// before[i], the number of final ones before it. Word i has one writer. Ends: the range halves.
kernel void tile_before(const uint count, const uint triangles, const uint all_final, global const ulong2* keys,
                        global const uint* corners, global const int2* points, global const uint* finals_before,
                        global uint* before) {
  FOR_EACH(i, count) {
    uint low = 0, high = triangles;
    while (low < high) {
      const uint middle = low + (high - low) / 2u;
      if (is_before_key(points, corners[3u * middle], corners[3u * middle + 1u], keys[i]))
        low = middle + 1u;
      else
        high = middle;
    }
    before[i] = all_final ? low : finals_before[low];
  }
}

// One work-item per triangle. Reads the scan of final, unless all are, and `before` of `count` triangles of the seam,
// which ascend. Writes places[t], the place of a final triangle among all of the tile's: its number among the final
// ones, and those of the seam that come before it; GCDT_NONE for others. Word t has one writer. Of many triangles in a
// row mostly none of the seam's comes between the first and the last.
#define PLACES_TILE 2048u
kernel void tile_places(const uint triangles, const uint all_final, const uint count, global const uint* finals_before,
                        global const uint* before, global uint* places) {
  FOR_EACH_TILE_OF(tile, PLACES_TILE, triangles) {
    const uint end = min(tile + PLACES_TILE, triangles), first = all_final ? tile : finals_before[tile],
               low = count_up_to(before, count, first),
               more = count_up_to(before + low, count - low, all_final ? end : finals_before[end]);
    for (uint t = tile + (uint)get_local_id(0); t < end; t += (uint)get_local_size(0)) {
      const uint r = all_final ? t : finals_before[t];
      const bool is_final = all_final || finals_before[t + 1u] != r;
      places[t] = is_final ? r + low + (more == 0u ? 0u : count_up_to(before + low, more, r)) : GCDT_NONE;
    }
  }
}

// One work-item per triangle from number `begin` on. Reads places, ids and the mesh. Writes the arrays of a final
// triangle at its place: input numbers, neighbours as places from `first` on, -1 where there is no final one. Places
// differ. Places of the seam's triangles are not written.
kernel void tile_write(const uint count, const uint begin, const uint first, global const uint* places,
                       global const uint* ids, global const uint* corners, global const int* neighbours,
                       global const uchar* constrained, global uint* out_corners, global int* out_neighbours,
                       global uchar* out_constrained) {
  FOR_EACH(i, count) {
    const uint t = begin + i, place = places[t];
    if (place == GCDT_NONE) continue;
    for (uint k = 0; k < 3u; ++k) {
      const int u = neighbours[3u * t + k];
      const uint other = u < 0 ? GCDT_NONE : places[u];
      out_corners[3u * place + k] = ids[corners[3u * t + k]];
      out_neighbours[3u * place + k] = other == GCDT_NONE ? -1 : (int)(first + other);
    }
    out_constrained[place] = constrained[t];
  }
}

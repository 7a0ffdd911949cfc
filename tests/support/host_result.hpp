// SPDX-License-Identifier: Apache-2.0
// A result on the host, to be damaged in the ways that a check must notice.
#pragma once

#include <array>
#include <vector>

#include "device/runtime.hpp"

namespace gcdt::test {

/// A result on the host, to be damaged and put back.
struct HostResult {
  std::vector<cl_uint> corners;
  std::vector<cl_int> neighbours;
  std::vector<cl_uchar> constrained;

  cl_uint triangles() const { return static_cast<cl_uint>(constrained.size()); }
  cl_uint corner(cl_uint t, cl_uint k) const { return corners[3 * t + k % 3]; }
  cl_int& neighbour(cl_uint t, cl_uint k) { return neighbours[3 * t + k % 3]; }
  /// The corner of u across from the edge to triangle t.
  cl_uint corner_to(cl_uint u, cl_uint t) {
    cl_uint j = 0;
    while (neighbour(u, j) != static_cast<cl_int>(t)) ++j;
    return j;
  }
  bool flagged(cl_uint t, cl_uint k) const { return constrained[t] >> k & 1; }
  void toggle(cl_uint t, cl_uint k) { constrained[t] ^= static_cast<cl_uchar>(1 << k); }
  void toggle_both(cl_uint t, cl_uint k) {
    toggle(t, k);
    if (neighbour(t, k) >= 0) toggle(neighbour(t, k), corner_to(neighbour(t, k), t));
  }
  void append(cl_uint t) {
    for (cl_uint k = 0; k < 3; ++k) {
      corners.push_back(corner(t, k));
      neighbours.push_back(neighbour(t, k));
    }
    constrained.push_back(constrained[t]);
  }
  /// Takes triangle t out; the last one gets its number.
  void remove(cl_uint t) {
    const cl_uint last = triangles() - 1;
    for (cl_uint k = 0; k < 3; ++k)
      if (neighbour(t, k) >= 0) neighbour(neighbour(t, k), corner_to(neighbour(t, k), t)) = -1;
    if (t != last)
      for (cl_uint k = 0; k < 3; ++k) {
        if (neighbour(last, k) >= 0)
          neighbour(neighbour(last, k), corner_to(neighbour(last, k), last)) = static_cast<cl_int>(t);
        corners[3 * t + k] = corner(last, k);
        neighbour(t, k) = neighbour(last, k);
      }
    constrained[t] = constrained[last];
    corners.resize(3 * last), neighbours.resize(3 * last), constrained.resize(last);
  }
  /// Replaces the diagonal across from corner k of t by the other one; its four sides keep all they have.
  void flip(cl_uint t, cl_uint k) {
    const auto u = static_cast<cl_uint>(neighbour(t, k));
    const cl_uint j = corner_to(u, t), p = corner(t, k), a = corner(t, k + 1), b = corner(t, k + 2), q = corner(u, j);
    struct Side {
      cl_int neighbour;
      bool flag;
    };
    auto side = [&](cl_uint s, cl_uint i) { return Side{neighbour(s, i), flagged(s, i % 3)}; };
    const Side pa = side(t, k + 2), bp = side(t, k + 1), aq = side(u, j + 1), qb = side(u, j + 2);
    auto write = [&](cl_uint s, std::array<cl_uint, 3> c, std::array<Side, 3> n) {
      constrained[s] = 0;
      for (cl_uint i = 0; i < 3; ++i) {
        corners[3 * s + i] = c[i];
        neighbour(s, i) = n[i].neighbour;
        if (n[i].flag) toggle(s, i);
      }
    };
    if (aq.neighbour >= 0) neighbour(aq.neighbour, corner_to(aq.neighbour, u)) = static_cast<cl_int>(t);
    if (bp.neighbour >= 0) neighbour(bp.neighbour, corner_to(bp.neighbour, t)) = static_cast<cl_int>(u);
    write(t, {p, a, q}, {aq, Side{static_cast<cl_int>(u), false}, pa});
    write(u, {p, q, b}, {qb, bp, Side{static_cast<cl_int>(t), false}});
  }
};

}  // namespace gcdt::test

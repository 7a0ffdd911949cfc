// SPDX-License-Identifier: Apache-2.0
#include "phases/refine_lengths.hpp"

#include "refine/refine.h"

namespace gcdt {

namespace {

template <class T>
std::vector<T> read_all(runtime::Runtime& runtime, const runtime::Buffer<T>& from) {
  std::vector<T> values(from.size());
  if (!values.empty()) runtime.read(from, values.data(), values.size());
  return values;
}

/// What is known of the vertices, by input number.
struct Known {
  std::vector<cl_int2> points;
  std::vector<cl_uint> vertex;

  device::Vertex at(cl_uint number) const {
    const cl_int2& p = points[vertex[number]];
    return device::gcdt_finite_vertex(p.s[0], p.s[1]);
  }
};

cl_uint length_on(const Known& known, const cl_uint4& origin, cl_uint v, const std::vector<cl_uint>& lengths) {
  const cl_uint a = origin.s[0], b = origin.s[1], c = origin.s[2];
  if (c == GCDT_NONE) return device::gcdt_length_on_edge(known.at(a), known.at(b), known.at(v), lengths[a], lengths[b]);
  return device::gcdt_length_on_face(known.at(a), known.at(b), known.at(c), known.at(v), lengths[a], lengths[b],
                                     lengths[c]);
}

}  // namespace

// Ends: a vertex was put on others that were there before it, so what waits for what is no circle.
void extend_lengths(runtime::Runtime& runtime, const Vertices& vertices, const runtime::Buffer<cl_uint4>& origins,
                    std::vector<cl_uint>& lengths) {
  const Known known = {read_all(runtime, vertices.points), read_all(runtime, vertices.input_vertex)};
  const std::vector<cl_uint4> on = read_all(runtime, origins);
  const std::size_t inputs = lengths.size();
  constexpr cl_uint unknown = 0;  // lengths are at least 1
  lengths.resize(inputs + on.size(), unknown);
  std::vector<std::size_t> stack;
  for (std::size_t first = inputs; first < lengths.size(); ++first) {
    stack.push_back(first);
    while (!stack.empty()) {
      const std::size_t v = stack.back(), before = stack.size();
      const cl_uint4& origin = on[v - inputs];
      for (const cl_uint u : origin.s) {
        if (&u == &origin.s[3] || u == GCDT_NONE) continue;
        if (lengths[u] == unknown) stack.push_back(u);
      }
      if (stack.size() > before) continue;
      lengths[v] = length_on(known, origin, static_cast<cl_uint>(v), lengths);
      stack.pop_back();
    }
  }
}

}  // namespace gcdt

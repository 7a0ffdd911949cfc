// SPDX-License-Identifier: Apache-2.0
// Whole calls by a runtime that is tuned in one way and in another, and what they give, to be compared.
#pragma once

#include <string>
#include <vector>

#include "kinds.hpp"
#include "solve/triangulate.hpp"
#include "workloads.hpp"

namespace gcdt::test {

/// What a call gives, or how it fails.
struct Seen {
  std::vector<cl_uint> corners, ends, sources, dropped;
  std::string error;
  std::vector<std::uint64_t> indices;
  bool operator==(const Seen& o) const {
    return corners == o.corners && ends == o.ends && sources == o.sources && dropped == o.dropped && error == o.error &&
           indices == o.indices;
  }
};

struct Called {
  Seen seen;
  Statistics statistics;
};

template <class T>
std::vector<cl_uint> words_of(runtime::Runtime& runtime, const runtime::Buffer<T>& buffer, std::size_t count) {
  std::vector<cl_uint> words(count * sizeof(T) / sizeof(cl_uint));
  if (count > 0) runtime.read_bytes(buffer.handle(), 0, words.data(), count * sizeof(T));
  return words;
}

inline Called call(runtime::Runtime& runtime, const Workload& work, const Tuning& tuning,
                   Crossing policy = Crossing::reject) {
  const Tuned tuned(runtime, tuning);
  Primitives primitives(runtime);
  runtime.memory().begin_call();
  Options options;
  options.crossing = policy;
  const Points points = work.points;
  const Constraints constraints = work.constraints;
  Called called;
  try {
    const DeviceTriangulation made = triangulate(runtime, primitives, source_of(runtime, points, constraints), options);
    called.seen.corners = words_of(runtime, made.mesh.corners, 3 * std::size_t{made.mesh.triangles});
    called.seen.ends = words_of(runtime, made.pieces.ends, made.pieces.count);
    called.seen.sources = words_of(runtime, made.pieces.sources, made.pieces.source_count);
    called.seen.dropped = words_of(runtime, made.dropped, made.dropped.size());
    called.statistics = made.statistics;
  } catch (const Error& error) {
    called.seen.error = error.what();
    called.seen.indices = error.indices();
  }
  return called;
}

}  // namespace gcdt::test

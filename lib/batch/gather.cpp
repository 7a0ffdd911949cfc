// SPDX-License-Identifier: Apache-2.0
#include "batch/gather.hpp"

#include <algorithm>

#include "phases/clean.hpp"

namespace gcdt {

using runtime::Upload;

namespace {

// Problems are ordered by size, so each begins at an address that the processor does not expect.
void prefetch([[maybe_unused]] Span<unsigned char> bytes) {
#ifdef __GNUC__
  constexpr std::size_t line = 64;  // of a cache
  for (std::size_t at = 0; at < std::min(bytes.size(), Tuning::most_prefetched); at += line)
    __builtin_prefetch(bytes.data() + at);
#endif
}

/// Uploads a problem's constraints. If one has an end that is no vertex, the problem gets an error instead.
void add_constraints(Upload& upload, Span<Constraint> given, std::uint64_t n, std::uint32_t first_input,
                     std::uint32_t place, InvalidProblems& invalid) {
  // Two plain loops, for compilers that make vector instructions of such.
  std::uint32_t greatest = 0;
  for (const Constraint& c : given) greatest = std::max(greatest, std::max(c[0], c[1]));
  if (given.size() > 0 && greatest >= n) {
    const auto* bad = std::find_if(given.begin(), given.end(), [&](Constraint c) { return c[0] >= n || c[1] >= n; });
    invalid.errors.emplace_back(
        place, index_error(static_cast<std::uint64_t>(bad - given.begin()), (*bad)[0] >= n ? 0 : 1, n));
    return;
  }
  for (std::size_t c = 0; c < given.size();) {
    const auto [to, count] = upload.room<Constraint>(given.size() - c);
    for (std::size_t i = 0; i < count; ++i) to[i] = {given[c + i][0] + first_input, given[c + i][1] + first_input};
    c += count;
  }
}

}  // namespace

ProblemRanges ranges_of(const BatchInput& batch, const std::vector<std::uint32_t>& numbers) {
  ProblemRanges ranges;
  std::uint64_t inputs = 0, constraints = 0;
  for (std::size_t i = 0;; ++i) {
    ranges.first_input.push_back(static_cast<cl_uint>(inputs));
    ranges.first_constraint.push_back(static_cast<cl_uint>(constraints));
    if (i == numbers.size()) return ranges;
    inputs += batch.n(numbers[i]), constraints += batch.m(numbers[i]);
  }
}

DeviceInput gather(runtime::Runtime& runtime, const BatchInput& batch, const std::vector<std::uint32_t>& numbers,
                   const ProblemRanges& ranges, runtime::TransferChunks& chunks) {
  const std::size_t words = words_per_vertex(batch.type), vertex_bytes = words * sizeof(cl_ulong);
  const cl_uint n = ranges.first_input.back(), m = ranges.first_constraint.back();
  runtime.tracer().begin_phase("gather");
  DeviceInput loaded;
  loaded.points.n = n;
  loaded.points.type = coordinates_type(batch.type);
  loaded.points.coordinates = runtime.allocate<cl_ulong>("coordinates", n * words);
  loaded.constraints = runtime.allocate<cl_uint2>("constraints", m);
  const auto vertices_of = [&](std::uint32_t p) {
    return Span<unsigned char>(
        static_cast<const unsigned char*>(batch.vertices) + batch.vertex_offsets[p] * vertex_bytes,
        batch.n(p) * vertex_bytes);
  };
  {
    Upload upload(chunks, loaded.points.coordinates.handle());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (i + 1 < numbers.size()) prefetch(vertices_of(numbers[i + 1]));
      const Span<unsigned char> given = vertices_of(numbers[i]);
      upload.append(given.data(), given.size());
    }
    upload.send();
  }
  static_assert(sizeof(Constraint) == sizeof(cl_uint2), "a constraint is copied as it is");
  Upload upload(chunks, loaded.constraints.handle());
  InvalidProblems invalid;
  for (std::uint32_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t p = numbers[i];
    const Span<Constraint> given(batch.constraints + batch.constraint_offsets[p], batch.m(p));
    add_constraints(upload, given, batch.n(p), ranges.first_input[i], i, invalid);
  }
  if (!invalid.errors.empty()) throw invalid;
  upload.send();
  runtime.tracer().end_phase();
  return loaded;
}

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// The C interface: results.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstring>

#include <gcdt/detail.hpp>

#include "api/state.hpp"
#include "query/quality.hpp"

using namespace gcdt;
using namespace gcdt::api;

std::uint64_t gcdt_result::count(std::int32_t number) const {
  const ResultArray* array = result_array(number);
  return array ? elements(data, *array) : 0;
}

DeviceArray gcdt_result::array(std::int32_t number) const {
  const ResultArray& array = known_array(number);
  const runtime::Memory memory =
      array.derive ? array.derive(state->runtime, state->primitives, derived, data) : array.memory(data);
  return {memory, elements(data, array), array.element_bytes};
}

const ResultArray& gcdt::api::known_array(std::int32_t number) {
  if (const ResultArray* array = result_array(number)) return *array;
  throw Error(Status::invalid_argument, "no array of a result has the number " + std::to_string(number));
}

size_t gcdt_element_bytes(int32_t array) {
  const ResultArray* found = result_array(array);
  return found ? found->element_bytes : 0;
}

uint64_t gcdt_result_count(const gcdt_result* result, int32_t array) { return result ? result->count(array) : 0; }

int32_t gcdt_result_copy(gcdt_result* result, int32_t array, void* destination, uint64_t capacity) {
  return gcdt_result_copy_arrays(result, &array, &destination, &capacity, 1);
}

int32_t gcdt_result_copy_arrays(gcdt_result* result, const int32_t* arrays, void* const* destinations,
                                const uint64_t* capacities, size_t count) {
  return guarded_call(result, [&] {
    require(count == 0 || (arrays && destinations && capacities), "arrays, destinations or capacities is null");
    std::vector<runtime::HostRead> reads;
    for (std::size_t i = 0; i < count; ++i) {
      const DeviceArray from = result->array(arrays[i]);
      if (capacities[i] < from.count) throw too_small(from.count, capacities[i]);
      if (from.count == 0) continue;
      require(destinations[i], "destination is null");
      reads.push_back({from.memory, destinations[i], static_cast<std::size_t>(from.bytes())});
    }
    const auto start = std::chrono::steady_clock::now();
    Statistics& s = result->data.statistics;
    runtime::Runtime& runtime = result->state->runtime;
    const std::uint64_t read_backs = runtime.read_backs();
    runtime.read_all(reads);
    s.read_backs += runtime.read_backs() - read_backs;
    const double ms = milliseconds_since(start);
    s.ms.output += ms;
    s.ms.full += ms;
    s.ms.call += ms;
  });
}

void gcdt_result_release(gcdt_result* result) { delete result; }

int32_t gcdt_result_statistics(const gcdt_result* result, gcdt_statistics* statistics) {
  return guarded_call(result, [&] {
    const Statistics& s = result->data.statistics;
    gcdt_statistics c = {};
#define GCDT_STATISTIC(member, name) c.member = s.name;
#define GCDT_STATISTIC_HIDDEN GCDT_STATISTIC
#define GCDT_STATISTIC_TEXT(member, name) c.member = s.name.c_str();
#include <gcdt/statistics.def>
    c.grid = detail::grid(s.grid);
    std::copy(s.rounded_pair.begin(), s.rounded_pair.end(), c.rounded_pair);
    write_struct(c, statistics, "gcdt_statistics", offsetof(gcdt_statistics, ms_domain));
  });
}

int32_t gcdt_result_quality(gcdt_result* result, gcdt_quality* quality) {
  return guarded_call(result, [&] {
    const device::Quality q = measure_quality(result->state->runtime, result->data.vertices, result->data.mesh);
    gcdt_quality c = {};
    c.least_angle_triangle = c.largest_angle_triangle = -1;
    if (q.count != 0) {
      c.triangles = q.count;
      c.least_angle = degrees(q.least_dot, q.least_angle_area);
      c.largest_angle = degrees(q.most_dot, q.most_angle_area);
      c.least_angle_triangle = static_cast<std::int32_t>(q.least_triangle);
      c.largest_angle_triangle = static_cast<std::int32_t>(q.most_triangle);
      c.least_doubled = q.least_area, c.largest_doubled = q.most_area, c.doubled = q.area_sum;
      const double cell = result->data.statistics.grid.cell();
      const auto area = [&](std::uint64_t doubled) { return static_cast<double>(doubled) / 2 * cell * cell; };
      c.least_area = area(q.least_area), c.largest_area = area(q.most_area), c.area = area(q.area_sum);
    }
    write_struct(c, quality, "gcdt_quality");
  });
}

const char* gcdt_result_note(const gcdt_result* result, size_t number) {
  if (!result || number >= result->data.statistics.notes.size()) return nullptr;
  return result->data.statistics.notes[number].c_str();
}

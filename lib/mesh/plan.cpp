// SPDX-License-Identifier: Apache-2.0
#include "mesh/plan.hpp"

#include <algorithm>

#include "constrain/clean.h"
#include "mesh/mesh.hpp"
#include "sort/sizes.h"

namespace gcdt {

namespace {

// Loops of lanes end early (docs/devices.md): a group's flips end within 16 rounds of 4 tiles, each with 32 flips of a
// chain and their edges.
constexpr std::uint32_t edges_of_lanes = 256, rounds_of_lanes = 16;

constexpr std::uint64_t gates_of_edge = 32;  // bytes (phases/gates.hpp)

const char* name(Plan::By by) {
  switch (by) {
    case Plan::By::one: return "one work-item";
    case Plan::By::each: return "one work-item a problem";
    case Plan::By::groups: return "one work-group a problem";
    default: return "all";
  }
}

}  // namespace

std::uint32_t part_pool(const Plan& plan, std::uint64_t crossings, std::uint32_t had) {
  const std::uint64_t usual =
      std::min<std::uint64_t>(crossings / plan.crossings_per_part + plan.least_parts, plan.most_parts);
  const std::uint32_t left = plan.long_parts - std::min(had, plan.long_parts);
  return static_cast<std::uint32_t>(std::max(usual, std::min<std::uint64_t>(crossings / plan.crossings_of_long, left)));
}

std::uint32_t long_part_pool(const Plan& plan, std::uint32_t pool) {
  const std::uint64_t wanted = std::uint64_t{pool} * plan.long_piece;
  return std::max(pool, static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted, plan.long_parts)));
}

bool pays_in_turn(const Plan& plan, const PlannedSizes& sizes, std::uint32_t constraints, std::uint64_t crossings) {
  return sizes.problems == 1 && constraints > plan.step_ahead &&
         crossings / device::gcdt_face_count(sizes.vertices) >= plan.crossings_ahead;
}

Plan make_plan(const PlannedDevice& device, const Tuning& tuning, const PlannedSizes& sizes) {
  using By = Plan::By;
  const bool threads = device.kind == DeviceKind::threads, lanes = device.kind == DeviceKind::lanes;
  const bool gpu = device.kind == DeviceKind::gpu, many = sizes.problems > 1;
  const std::uint32_t units = std::max(1u, device.units);
  const auto by_one = [&](std::uint32_t count, std::uint32_t times = 1) {
    const bool few = device.works_here || count <= std::uint64_t{times} * tuning.one_item_vertices;
    return threads && few ? By::one : By::all;
  };
  // Threads take whole problems if each has several.
  const auto shared_out = [&](std::uint32_t count) {
    return threads && many && std::uint64_t{sizes.largest} * units <= count;
  };
  const auto of_lanes = [&](std::uint32_t most, std::uint32_t there) { return lanes ? std::min(most, there) : most; };

  Plan plan;
  plan.works_here = device.works_here;
  plan.order = by_one(sizes.inputs, many ? 1 : Tuning::one_item_orders);
  plan.sort_problems = !is_cpu(device.kind) && sizes.largest <= GCDT_SORT_SMALL ? By::groups
                       : shared_out(sizes.inputs)                               ? By::each
                                                                                : By::all;
  plan.one_level = shared_out(sizes.vertices);
  plan.coarsest_level = tuning.coarsest_level;

  plan.grows = threads;
  const bool small = sizes.largest <= (lanes ? Tuning::most_of_a_group_of_lanes : Tuning::most_of_a_group);
  plan.problems = shared_out(sizes.vertices) ? By::each : !threads && many && small ? By::groups : By::all;
  plan.problems_of_launch =
      lanes ? device.groups : std::max(device.groups, Tuning::most_of_a_launch / std::max(1u, sizes.largest));
  plan.group_vertices = tuning.one_group_vertices;
  plan.group_rounds = tuning.rounds_of_group;
  plan.group_edges = of_lanes(tuning.one_group_edges, edges_of_lanes);
  plan.group_flip_rounds = of_lanes(tuning.rounds_of_group, rounds_of_lanes);
  plan.rounds_per_read = tuning.rounds_per_read;
  plan.least_patched = tuning.least_patched;
  plan.patch_vertices = tuning.patch_vertices;
  plan.least_divided = tuning.least_divided;
  plan.district_vertices = tuning.district_vertices;
  plan.patch_bytes = std::min<std::uint64_t>(device.local_bytes, Tuning::most_patch_bytes) - Tuning::spare_local_bytes;
  plan.patch_rounds = of_lanes(tuning.rounds_of_patch, rounds_of_lanes);
  plan.rounds_before_few = device.spares_programs ? Tuning::rounds_without_few : 0;
  plan.least_sweep = device.spares_programs ? UINT32_MAX : tuning.least_sweep;
  plan.sweep_share = tuning.sweep_share;
  plan.grown_shares = device.works_here ? 1 : units * Tuning::grown_shares_per_unit;

  const bool each = plan.problems == By::each && sizes.largest <= Tuning::most_enforced_by_one;
  plan.constraints = each ? By::each : many ? By::all : by_one(sizes.inputs);
  plan.curve_crossings = tuning.curve_crossings.value_or(threads ? 0 : gpu ? Tuning::gpu_curve_crossings : UINT32_MAX);
  plan.curve_bits = gpu ? GCDT_CLEAN_CELL_BITS : 0;
  plan.most_parts = tuning.part_pool.value_or(gpu ? Tuning::gpu_parts : Tuning::cpu_parts_per_unit * units);
  plan.long_parts = tuning.part_pool || !gpu
                        ? plan.most_parts
                        : std::max(plan.most_parts, std::min(sizes.vertices / 2, Tuning::gpu_long_parts));
  plan.crossings_of_long = Tuning::crossings_of_long;
  plan.long_piece = gpu ? Tuning::gpu_long_piece : 1;
  plan.least_parts = std::min(plan.most_parts, gpu ? Tuning::gpu_least_parts : Tuning::cpu_least_parts);
  plan.crossings_per_part = threads ? Tuning::cpu_crossings_per_part : tuning.crossings_per_part;
  plan.crossings_ahead =
      tuning.crossings_ahead.value_or(gpu ? Tuning::gpu_crossings_ahead : Tuning::cpu_crossings_ahead);
  const std::uint64_t gates = gates_of_edge * device::gcdt_forest_edges(sizes.vertices, sizes.problems);
  plan.crossings_gated = gates > device.largest_buffer
                             ? UINT32_MAX
                             : tuning.crossings_gated.value_or(gpu ? Tuning::gpu_crossings_gated : UINT32_MAX);
  plan.crossings_ordered = tuning.crossings_ordered.value_or(gpu ? Tuning::gpu_crossings_ordered : UINT32_MAX);
  plan.step_ahead = gpu ? Tuning::gpu_step_ahead : Tuning::cpu_step_ahead;
  plan.least_existing = tuning.least_existing.value_or(gpu ? Tuning::gpu_least_existing : Tuning::cpu_least_existing);
  plan.least_grouped = threads ? UINT32_MAX : tuning.least_grouped;
  plan.grouped_crossings = tuning.grouped_crossings;
  plan.all_pairs = lanes ? Tuning::most_of_all_pairs_of_lanes : Tuning::most_of_all_pairs;

  plan.output = each ? By::each : by_one(sizes.vertices);
  plan.number = by_one(sizes.inputs);
  plan.check = by_one(sizes.vertices);
  plan.lists_pieces = threads;
  return plan;
}

std::string Plan::text() const {
  std::string all = "order by " + std::string(name(order));
  if (problems != By::all || sort_problems != By::all)
    all += "; problems sorted by " + std::string(name(sort_problems)) + ", inserted by " + name(problems);
  all += !grows ? "; vertices in rounds, level by level"
         : grown_shares == 1
             ? "; vertices one after the other"
             : "; vertices one after the other in at most " + std::to_string(grown_shares) + " sequences";
  all += "; constraints by " + std::string(name(constraints));
  if (constraints == By::all && curve_crossings == 0) all += ", along the curve";
  if (!grows)
    all += "; flips within patches from " + std::to_string(least_patched) + " edges on, and districts from " +
           std::to_string(least_divided);
  if (!grows && least_sweep < UINT32_MAX) all += "; flips swept from " + std::to_string(least_sweep) + " edges on";
  if (rounds_before_few > 0) all += "; without programs that only save time, since none is compiled yet";
  return all + "; output by " + name(output) + ", numbered by " + name(number) + ", checked by " + name(check) +
         (works_here ? "; all by the calling thread" : "");
}

PlannedDevice planned_device(const runtime::Runtime& runtime) {
  return {runtime.kind(),
          runtime.info().compute_units,
          static_cast<std::uint32_t>(runtime.geometry().max_groups),
          runtime.info().local_bytes,
          runtime.info().largest_buffer_bytes,
          runtime.spares_programs(),
          runtime.works_here()};
}

Plan make_plan(const runtime::Runtime& runtime, const PlannedSizes& sizes) {
  return make_plan(planned_device(runtime), runtime.tuning(), sizes);
}

PlannedSizes sizes_of(const Vertices& vertices) {
  return {vertices.roots, static_cast<std::uint32_t>(vertices.input_vertex.size()), vertices.n(), vertices.largest};
}

}  // namespace gcdt

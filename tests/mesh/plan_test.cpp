// SPDX-License-Identifier: Apache-2.0
// Which way inputs go: the plan as a table of devices and sizes.
#include "mesh/plan.hpp"

#include <doctest/doctest.h>

using namespace gcdt;
using By = Plan::By;

namespace {

const PlannedDevice gpu{DeviceKind::gpu, 132, 4224}, threads{DeviceKind::threads, 8, 128},
    lanes{DeviceKind::lanes, 4, 256}, accelerator{DeviceKind::accelerator, 2, 128};

PlannedSizes one(std::uint32_t n) { return {1, n, n, 0}; }
PlannedSizes many(std::uint32_t problems, std::uint32_t n, std::uint32_t largest) { return {problems, n, n, largest}; }

}  // namespace

TEST_CASE("who does what, by device and sizes") {
  struct Row {
    const char* name;
    PlannedDevice device;
    PlannedSizes sizes;
    By order, sort_problems, problems, constraints, output, number, check;
    bool grows, one_level;
  };
  const By all = By::all, single = By::one, each = By::each, groups = By::groups;
  const Row rows[] = {
      {"GPU, one", gpu, one(1000000), all, groups, all, all, all, all, all, false, false},
      {"GPU, few", gpu, one(100), all, groups, all, all, all, all, all, false, false},
      {"GPU, small problems", gpu, many(100, 10000, 2048), all, groups, groups, all, all, all, all, false, false},
      {"GPU, a larger one", gpu, many(100, 10000, 2049), all, all, all, all, all, all, all, false, false},
      {"threads, one", threads, one(1000000), all, all, all, all, all, all, all, true, false},
      {"threads, few", threads, one(2048), single, all, all, single, single, single, single, true, false},
      {"threads, more", threads, one(2049), single, all, all, all, all, all, all, true, false},
      {"threads, which one orders", threads, one(12288), single, all, all, all, all, all, all, true, false},
      {"threads, which all order", threads, one(12289), all, all, all, all, all, all, all, true, false},
      {"threads, problems", threads, many(100, 10000, 1250), all, each, each, each, each, all, all, true, true},
      {"threads, a large one", threads, many(100, 10000, 1251), all, all, all, all, all, all, all, true, false},
      {"threads, few of small ones", threads, many(8, 80, 10), single, each, each, each, each, single, single, true,
       true},
      {"threads, few of which one is large", threads, many(2, 100, 60), single, all, all, all, single, single, single,
       true, false},
      {"threads, too large to be enforced by one", threads, many(100, 200000, 16385), all, each, each, all, all, all,
       all, true, true},
      {"lanes, one", lanes, one(100), all, all, all, all, all, all, all, false, false},
      {"lanes, small problems", lanes, many(10, 1000, 256), all, all, groups, all, all, all, all, false, false},
      {"lanes, a larger one", lanes, many(10, 1000, 257), all, all, all, all, all, all, all, false, false},
      {"accelerator, small problems", accelerator, many(10, 1000, 2048), all, groups, groups, all, all, all, all, false,
       false},
  };
  for (const Row& row : rows) {
    CAPTURE(row.name);
    const Plan plan = make_plan(row.device, {}, row.sizes);
    CHECK(plan.order == row.order);
    CHECK(plan.sort_problems == row.sort_problems);
    CHECK(plan.problems == row.problems);
    CHECK(plan.constraints == row.constraints);
    CHECK(plan.output == row.output);
    CHECK(plan.number == row.number);
    CHECK(plan.check == row.check);
    CHECK(plan.grows == row.grows);
    CHECK(plan.one_level == row.one_level);
    // Problems are put out one by one only as they were enforced; work-groups have no vertices to grow.
    CHECK((plan.output == each) == (plan.constraints == each));
    CHECK((plan.constraints != each || plan.problems == each));
    CHECK((plan.problems != each || plan.grows));
    CHECK((plan.problems != groups || !plan.grows));
  }
}

TEST_CASE("parts are walked in order on GPUs") {
  CHECK(make_plan(gpu, {}, one(1000000)).crossings_ordered == 24);
  CHECK(make_plan(threads, {}, one(1000000)).crossings_ordered == UINT32_MAX);
  Tuning always;
  always.crossings_ordered = 0;
  CHECK(make_plan(threads, always, one(1000000)).crossings_ordered == 0);
}

TEST_CASE("gates are made on GPUs, if a buffer can hold them") {
  CHECK(make_plan(gpu, {}, one(1000000)).crossings_gated == 2);
  CHECK(make_plan(threads, {}, one(1000000)).crossings_gated == UINT32_MAX);
  Tuning always;
  always.crossings_gated = 0;
  CHECK(make_plan(threads, always, one(1000000)).crossings_gated == 0);
  PlannedDevice small = gpu;
  small.largest_buffer = 96000096;  // two of 16 bytes for each of 3 (n + 1) edges
  CHECK(make_plan(small, always, one(1000000)).crossings_gated == 0);
  CHECK(make_plan(small, always, one(1000001)).crossings_gated == UINT32_MAX);
}

TEST_CASE("distinct vertices are counted where given ones are not") {
  PlannedSizes sizes = many(100, 10000, 1250);
  sizes.vertices = 9999;  // less than 8 times the largest
  const Plan plan = make_plan(threads, {}, sizes);
  CHECK(plan.sort_problems == By::each);
  CHECK(plan.problems == By::all);
  CHECK(!plan.one_level);
  CHECK(make_plan(threads, {}, {1, 13000, 2000}).order == By::all);
  CHECK(make_plan(threads, {}, {1, 13000, 2000}).number == By::all);
  CHECK(make_plan(threads, {}, {1, 13000, 2000}).constraints == By::all);
  CHECK(make_plan(threads, {}, {1, 13000, 2000}).output == By::one);
  CHECK(make_plan(threads, {}, {1, 13000, 2000}).check == By::one);
}

TEST_CASE("limits by device") {
  const Tuning usual;
  for (const PlannedDevice& device : {gpu, threads, lanes, accelerator}) {
    const Plan plan = make_plan(device, usual, one(1000));
    const bool few = device.kind == DeviceKind::lanes;
    CHECK(plan.group_edges == (few ? 256 : usual.one_group_edges));
    CHECK(plan.group_flip_rounds == (few ? 16 : usual.rounds_of_group));
    CHECK(plan.group_rounds == usual.rounds_of_group);
    CHECK(plan.group_vertices == usual.one_group_vertices);
    CHECK(plan.all_pairs == (few ? 2048 : 65536));
    CHECK(plan.curve_crossings == (device.kind == DeviceKind::threads ? 0
                                   : device.kind == DeviceKind::gpu   ? 16
                                                                      : UINT32_MAX));
    CHECK(plan.curve_bits == (device.kind == DeviceKind::gpu ? 12 : 0));
    CHECK(plan.lists_pieces == (device.kind == DeviceKind::threads));
    CHECK(plan.most_parts == (device.kind == DeviceKind::gpu ? 1u << 17 : 512 * device.units));
    CHECK(plan.long_parts == plan.most_parts);
    CHECK(plan.least_parts == (device.kind == DeviceKind::gpu ? 4096 : 64));
    CHECK(plan.grown_shares == 2 * device.units);
    // A launch of many problems is as long as one of 2^24 vertices, or has a group for each.
    CHECK(make_plan(device, usual, many(10, 100, 10)).problems_of_launch ==
          (few ? device.groups : std::max<std::uint32_t>(device.groups, (1u << 24) / 10)));
    CHECK(make_plan(device, usual, many(10, 100, 10)).all_pairs == (few ? 2048 : 65536));
  }
  Tuning none;
  none.part_pool = 0;
  none.curve_crossings = 0;
  CHECK(make_plan(gpu, none, one(10)).most_parts == 0);
  CHECK(make_plan(gpu, none, one(10)).least_parts == 0);
  CHECK(make_plan(gpu, none, one(10000000)).long_parts == 0);
  CHECK(make_plan(gpu, none, one(10)).curve_crossings == 0);
}

TEST_CASE("constraints that cross much get more parts on GPUs, as far as there are vertices") {
  const Plan plan = make_plan(gpu, {}, one(1000000));
  CHECK(plan.long_parts == 500000);
  CHECK(make_plan(gpu, {}, one(10000000)).long_parts == 1u << 19);
  CHECK(make_plan(gpu, {}, one(400000)).long_parts == 200000);
  CHECK(part_pool(plan, 0) == 4096);
  CHECK(part_pool(plan, 8000) == 5096);
  CHECK(part_pool(plan, 32u << 17) == 1u << 17);
  CHECK(part_pool(plan, 32u << 18) == 1u << 18);
  CHECK(part_pool(plan, 32u << 19) == 500000);
  // Those that there are already are not made again.
  CHECK(part_pool(plan, 32u << 19, 100000) == 400000);
  CHECK(part_pool(plan, 32u << 19, 500000) == 1u << 17);
  CHECK(part_pool(plan, 8000, 500000) == 5096);
  CHECK(part_pool(make_plan(threads, {}, one(1000000)), 1u << 31) == 512 * threads.units);
}

TEST_CASE("long pieces have eight times as many parts on GPUs, of those that there is room for") {
  const Plan plan = make_plan(gpu, {}, one(1000000));
  CHECK(long_part_pool(plan, 5096) == 8 * 5096);
  CHECK(long_part_pool(plan, 1u << 17) == 500000);
  CHECK(long_part_pool(plan, 500000) == 500000);
  CHECK(long_part_pool(make_plan(threads, {}, one(1000000)), 100) == 100);
  CHECK(long_part_pool(make_plan(lanes, {}, one(1000000)), 100) == 100);
}

TEST_CASE("constraints that cross much are taken in turn, if they are of one problem and more than are left out") {
  const Plan plan = make_plan(gpu, {}, one(1000));
  const std::uint64_t faces = 2 * 1000 + 1;
  CHECK(pays_in_turn(plan, one(1000), 17, 40 * faces));
  CHECK(!pays_in_turn(plan, one(1000), 16, 40 * faces));
  CHECK(!pays_in_turn(plan, one(1000), 17, 40 * faces - 1));
  CHECK(!pays_in_turn(plan, many(2, 1000, 500), 17, 40 * faces));
  CHECK(pays_in_turn(make_plan(threads, {}, one(1000)), one(1000), 9, 8 * faces));
  CHECK(may_pay_in_turn(plan, one(1000), 17, 10 * faces));
  CHECK(!may_pay_in_turn(plan, one(1000), 17, 10 * faces - 1));
}

TEST_CASE("a plan in words names its ways") {
  const auto text = [](const PlannedDevice& device, const PlannedSizes& sizes) {
    return make_plan(device, {}, sizes).text();
  };
  const auto has = [](const std::string& all, const char* words) { return all.find(words) != std::string::npos; };
  CHECK(has(text(gpu, one(1000000)), "vertices in rounds, level by level"));
  CHECK(has(text(gpu, one(1000000)), "flips swept from 131072 edges on"));
  CHECK(text(threads, one(1000)).rfind("order by one work-item; vertices one after the other in at most", 0) == 0);
  PlannedDevice here = threads;
  here.works_here = true;
  const std::string by_caller = "checked by one work-item; all by the calling thread", all = text(here, one(1000));
  CHECK(has(all, "order by one work-item; vertices one after the other; "));
  CHECK(all.substr(all.size() - by_caller.size()) == by_caller);
  CHECK(has(text(threads, many(100, 10000, 100)), "constraints by one work-item a problem; output"));
  CHECK(has(text(gpu, many(100, 10000, 100)), "inserted by one work-group a problem"));
}

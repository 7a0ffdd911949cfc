// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <string>

#include <gcdt/types.hpp>

#include "device/programs.hpp"

namespace gcdt::runtime {

namespace {

const ProgramInfo programs[] = {
    {"adopt", "adopt", false},
    {"arrange", "arrange", false},
    {"buckets", "core", false},
    {"check", "core", false},
    {"check_faults", "check_faults", false},
    {"check_forest", "check_forest", false},
    {"clean", "constraints", true},
    {"constrain", "constraints", true},
    {"constraints", "constraints", true},
    {"core", "core", true},
    {"crossings", "crossings", true},
    {"decimals", "core", false},
    {"domain", "domain", false},
    {"domain_each", "domain_each", false},
    {"enforce", "enforce", true},
    {"by_one_item", "core", false},
    {"fans", "fans", true},
    {"first", "constraints", true},
    {"flip", "flips", true},
    {"flip_few", "flips", true},
    {"flips", "flips", true},
    {"imported", "imported", false},
    {"forest", "forest", false},
    {"freeze", "constraints", true, "insertion"},
    {"gates", "gates", true},
    {"given", "given", false},
    {"grow", "core", true},
    {"holes", "holes", true},
    {"hull", "hull", false},
    {"insert", "insert", true, "insertion"},
    {"insert_few", "insert_few", true},
    {"insertion", "insertion", true},
    {"judge", "judge", true},
    {"locate", "locate", true},
    {"mesh", "core", true},
    {"order", "core", false},
    {"order_parts", "order_parts", false},
    {"output", "core", false},
    {"parts", "constraints", true},
    {"passages", "passages", false},
    {"patches", "patches", true},
    {"primitives", "core", false},
    {"primitives_group", "primitives_group", false},
    {"quality", "quality", false},
    {"refine", "refine", true},
    {"regions", "regions", false},
    {"relink", "relink", true},
    {"result_fans", "result_fans", true},
    {"renew", "renew", true},
    {"retriangulate", "constraints", true},
    {"route", "route", true},
    {"select", "select", true},
    {"selftest", "core", false},
    {"slots", "slots", true},
    {"sort32_group", "sort32_group", false},
    {"sort32_serial", "sort32_serial", false},
    {"sort64_group", "sort64_group", false},
    {"sort64_serial", "core", false},
    {"sort_left", "sort_left", false},
    {"sort_merge", "sort_merge", false},
    {"sort_segments", "sort_segments", false},
    {"split", "split", true},
    {"stitch", "constraints", true},
    {"sweeps", "flips", true},
    {"tail", "tail", true},
    {"take", "take", false},
    {"tiles", "tiles", false},
};

}  // namespace

const ProgramInfo& info_of(const char* program) {
  for (const ProgramInfo& info : programs)
    if (std::strcmp(info.name, program) == 0) return info;
  throw Error(Status::device_failed, std::string("no program is named ") + program);
}

}  // namespace gcdt::runtime

// SPDX-License-Identifier: Apache-2.0
#include "solve/programs.hpp"

namespace gcdt {

namespace {

using runtime::Meshes;

struct Needed {
  const char* program;
  bool (*by)(const CallShape&);
};

bool all(const CallShape&) { return true; }
bool one(const CallShape& call) { return call.meshes == Meshes::one; }
bool many(const CallShape& call) { return call.meshes == Meshes::many; }
bool constrained(const CallShape& call) { return call.constrained; }
// Those that only save time.
bool whole(const CallShape& call) { return !call.spares; }
bool whole_one(const CallShape& call) { return one(call) && whole(call); }
// Of constrained calls, pieces are sorted, too: fewer or more than vertices.
bool digits(const CallShape& call) { return whole_one(call) && (call.constrained || !call.merged); }
bool merging(const CallShape& call) { return call.constrained || (one(call) && (call.merged || call.spares)); }
bool swept(const CallShape& call) { return call.swept && whole(call); }
bool grouped(const CallShape& call) { return call.constrained && call.grouped; }
bool patched(const CallShape& call) { return call.patched; }

// In the order in which a call comes to them, but that those that take long are begun before others that are needed
// earlier.
constexpr Needed needed[] = {
    {"order", one},
    {"forest", many},
    {"sort64_group", digits},
    {"sort_merge", merging},
    {"sort_segments", many},
    {"first", constrained},
    {"insertion", all},
    {"primitives_group", all},
    {"mesh", all},
    {"constrain", constrained},
    {"clean", constrained},
    {"flip", all},
    {"parts", constrained},
    {"stitch", constrained},
    {"retriangulate", constrained},
    {"buckets", whole},
    {"output", all},
    {"check", all},
    {"check_forest", many},
    {"insert_few", whole_one},
    {"flip_few", whole_one},
    {"sweeps", swept},
    {"slots", grouped},
    {"patches", patched},
};

}  // namespace

std::vector<const char*> programs_of_call(const CallShape& call) {
  std::vector<const char*> programs;
  for (const Needed& n : needed)
    if (n.by(call)) programs.push_back(n.program);
  return programs;
}

}  // namespace gcdt

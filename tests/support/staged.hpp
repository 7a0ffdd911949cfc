// SPDX-License-Identifier: Apache-2.0
// Constraints staged on a device, with the mesh that they are cleaned and enforced in.
#pragma once

#include "constraint_oracle.hpp"
#include "phases/clean.hpp"

namespace fixture {

/// Vertices and constraints between them, with the mesh before its last flips.
struct Staged : MeshOnDevice {
  Staged(runtime::Runtime& on, const std::vector<Point>& given, const std::vector<Constraint>& pairs)
      : MeshOnDevice(on, given, 8),
        primitives(on),
        constraints(renumbered(pairs, given, points)),
        staged(stage(on, Constraints(constraints))),
        cleaner(on, primitives, vertices, staged, n()) {
    insert_all(false);
  }
  Primitives primitives;
  std::vector<Constraint> constraints;
  runtime::Buffer<cl_uint2> staged;
  Cleaner cleaner;
};

}  // namespace fixture

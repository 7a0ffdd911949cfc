// SPDX-License-Identifier: Apache-2.0
// The table of kernel programs: which there are, and in which forms they are built.
#pragma once

namespace gcdt::runtime {

/// What a mesh holds.
enum class Meshes {
  one,   ///< one triangulation
  many,  ///< one for each problem of a batch (kernels/common/forest.h)
};

/// A program, kernels/*/NAME.cl. Every program is built by kind of device, too: -DGCDT_GPU, -DGCDT_CONTIGUOUS.
struct ProgramInfo {
  const char* name;
  /// On CPUs with threads: the program that includes it and is built in its place, so that one serves every call.
  const char* bundle;
  bool differs_for_many;  ///< built with -DGCDT_FOREST for meshes of many
};

/// Throws device_failed if there is none of that name.
const ProgramInfo& info_of(const char* program);

}  // namespace gcdt::runtime

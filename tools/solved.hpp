// SPDX-License-Identifier: Apache-2.0
// What the subcommands that ask a mesh something share: the mesh of an input, on a device.
#pragma once

#include <memory>

#include "command.hpp"

namespace gcdt::command {

/// An input or a mesh file, and the mesh in device memory.
struct Solved {
  io::Input input;
  std::unique_ptr<Solver> solver;
  std::unique_ptr<Result> result;

  /// Attribute k of all vertices, added ones last.
  std::vector<double> attribute(std::uint32_t k) const;
};

/// Reads and triangulates; a mesh file (.ele with its .node, .vtu, .npz) is taken as it is. Throws what these throw,
/// explained. `regions`: their labels, too, where there is no domain.
Solved solved(const MeshArguments& arguments, bool regions = false);

/// Throws if a mesh, which is taken as it is, comes with options that make one.
void check_mesh_options(const MeshArguments& arguments);

/// The device that the option names, by number; says which, if several fit, unless `quiet`.
std::string device_number(const std::string& spec, bool quiet);

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
// A result as the writers see it, wherever its arrays lie: they are not copied to be written.
#pragma once

#include <gcdt/gcdt_pool.hpp>

namespace gcdt::io {

/// Views of a result's arrays, which must outlive them, and what is said of it.
struct MeshArrays {
#define GCDT_ARRAY(number, name, type, width, ...) Span<gcdt::detail::Element<type, width>> name;
#include <gcdt/arrays.def>
  Span<std::array<double, 2>> added;
  Statistics statistics;

  /// Of a result that has its own.
  MeshArrays(const Triangulation& mesh) : added(mesh.added), statistics(mesh.statistics) {
#define GCDT_ARRAY(number, name, ...) name = mesh.name;
#include <gcdt/arrays.def>
  }
  /// Of a problem of a batch, whose arrays are the batch's: `mesh` has the rest.
  MeshArrays(const BatchResult& batch, std::size_t problem, const Triangulation& mesh)
      : added(mesh.added), statistics(mesh.statistics) {
#define GCDT_ARRAY(number, name, ...) name = batch.name(problem);
#include <gcdt/arrays.def>
  }
};

}  // namespace gcdt::io

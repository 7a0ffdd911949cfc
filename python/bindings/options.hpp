// SPDX-License-Identifier: Apache-2.0
// The options of a call as Python gives them, and the callbacks that go back there.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "turns.hpp"

namespace gcdt::python {

/// What is to be refined to, with the lengths and areas that it refers to.
struct GivenRefinement {
  Refinement wanted;  ///< without these
  std::vector<double> region_areas, sizes;

  Refinement view() const {
    Refinement refine = wanted;
    refine.region_areas = region_areas, refine.sizes = sizes;
    return refine;
  }
};

/// Options whose progress function looks for signals, so that Ctrl-C ends a call. It does so a few times a second: the
/// interpreter's lock may have to be waited for.
struct CallOptions {
  Options options;      ///< without refine
  nb::object progress;  ///< called as progress(phase, done); None: not called
  std::optional<GivenRefinement> refine;

  /// Those that a mesh is verified by.
  Options for_proof() const {
    Options given = options;
    if (refine) given.refine = refine->view();
    return given;
  }
  Options for_call() const {
    Options given = for_proof();
    auto next = std::chrono::steady_clock::now() + signal_interval;
    given.progress = [this, next](const char* phase, double done) mutable {
      const auto now = std::chrono::steady_clock::now();
      if (progress.is_none() && now < next) return true;
      next = now + signal_interval;
      nb::gil_scoped_acquire acquire;
      raise_signals();
      if (progress.is_none()) return true;
      const nb::object goes_on = progress(phase, done);
      return goes_on.is_none() || nb::cast<bool>(goes_on);
    };
    return given;
  }

 private:
  static constexpr std::chrono::milliseconds signal_interval{50};
};

/// A log function of Python's; what it raises is dropped.
inline Log python_log(nb::object log) {
  if (log.is_none()) return {};
  // Shared, since a Log may be copied without the interpreter's lock.
  auto kept = std::shared_ptr<nb::object>(new nb::object(std::move(log)), [](nb::object* object) {
    nb::gil_scoped_acquire acquire;
    delete object;
  });
  return [kept](int level, const char* message) {
    nb::gil_scoped_acquire acquire;
    (*kept)(level, message);
  };
}

/// Statistics as a dictionary, with the names and groups of the file of --stats.
nb::dict statistics_dict(const Statistics& statistics);
nb::dict grid_dict(const Grid& grid);
Grid grid_of(const nb::dict& grid);
nb::dict device_dict(const DeviceInfo& info);

/// An exception of Python.
nb::object error_object(const Error& error);

void bind_errors();
void bind_options(nb::module_& m);
void bind_solver(nb::module_& m);
void bind_proof(nb::module_& m);
void bind_pool(nb::module_& m);
void bind_device_memory(nb::module_& m);

}  // namespace gcdt::python

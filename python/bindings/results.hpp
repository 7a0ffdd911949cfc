// SPDX-License-Identifier: Apache-2.0
// A result that Python holds: together with its solver, and dropped at any time.
#pragma once

#include <memory>
#include <utility>

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/unique_ptr.h>

#include "options.hpp"

namespace gcdt::python {

class DeviceResult {
 public:
  DeviceResult(std::shared_ptr<SharedSolver> solver, Result result)
      : solver_(std::move(solver)), result_(std::make_shared<const Result>(std::move(result))) {}
  ~DeviceResult() { release(); }

  void release() {
    if (result_) solver_->drop(std::move(result_));
  }
  bool released() const { return !result_; }

  const Result& get() const {
    if (!result_) throw Error(Status::invalid_argument, "the device memory of this mesh was released");
    return *result_;
  }
  SharedSolver& solver() const { return *solver_; }
  const std::shared_ptr<SharedSolver>& shared_solver() const { return solver_; }

  /// What question(result) answers, in a turn and without the interpreter's lock. Another thread may release the result
  /// meanwhile: then it ends here, in the turn.
  template <class Question>
  auto ask(Question&& question) {
    get();
    std::shared_ptr<const Result> held = result_;
    nb::gil_scoped_release release;
    const SharedSolver::Turn turn(*solver_);
    const std::shared_ptr<const Result> asked = std::move(held);
    return question(*asked);
  }

 private:
  std::shared_ptr<SharedSolver> solver_;
  std::shared_ptr<const Result> result_;
};

}  // namespace gcdt::python

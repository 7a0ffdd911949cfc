// SPDX-License-Identifier: Apache-2.0
// Many Python threads at one solver: they take turns, and what Python drops meanwhile waits for the end of a turn.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "arrays.hpp"

namespace gcdt::python {

/// Throws what a signal's handler has raised, such as KeyboardInterrupt. To be called with the interpreter's lock.
inline void raise_signals() {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

/// Who may call an object that belongs to one thread at a time.
class TurnLock {
 public:
  /// Waits; a signal ends the wait. False if this thread has the turn already (a callback asks again): there is no
  /// second one, and the library refuses the call by itself. To be called without the interpreter's lock.
  bool lock() {
    if (owner_ == std::this_thread::get_id()) return false;
    while (!mutex_.try_lock_for(std::chrono::milliseconds(100))) {
      nb::gil_scoped_acquire acquire;
      raise_signals();
    }
    owner_ = std::this_thread::get_id();
    return true;
  }
  bool try_lock() {
    if (owner_ == std::this_thread::get_id() || !mutex_.try_lock()) return false;
    owner_ = std::this_thread::get_id();
    return true;
  }
  void unlock() {
    owner_ = std::thread::id();
    mutex_.unlock();
  }

 private:
  std::timed_mutex mutex_;
  std::atomic<std::thread::id> owner_{std::thread::id()};
};

/// A solver, which belongs to one thread at a time together with its results, for all threads.
///
/// The destructor of a result cannot wait for a turn: it may run in any thread, whenever Python collects. So results
/// that are dropped go to a list, which is emptied by whoever has a turn, and, since he may just have looked, once more
/// when his turn is over.
class SharedSolver {
 public:
  explicit SharedSolver(Solver solver) : solver_(std::move(solver)) {}
  SharedSolver(const SharedSolver&) = delete;

  /// The solver, for the time of a turn.
  class Turn {
   public:
    explicit Turn(SharedSolver& shared) : shared_(shared), first_(shared.turns_.lock()) {}
    ~Turn() {
      if (!first_) return;
      shared_.release_dropped();
      shared_.turns_.unlock();
      shared_.release_if_free();
    }
    Turn(const Turn&) = delete;
    Solver& solver() const { return shared_.solver_; }

   private:
    SharedSolver& shared_;
    bool first_;
  };

  void drop(std::shared_ptr<const Result> result) {
    {
      const std::lock_guard guard(dropped_mutex_);
      dropped_.push_back(std::move(result));
    }
    release_if_free();
  }

 private:
  /// Ends: each further pass means that a result was dropped while this thread had the turn.
  void release_if_free() {
    while (any_dropped() && turns_.try_lock()) {
      release_dropped();
      turns_.unlock();
    }
  }
  bool any_dropped() {
    const std::lock_guard guard(dropped_mutex_);
    return !dropped_.empty();
  }
  void release_dropped() {
    std::vector<std::shared_ptr<const Result>> released;
    const std::lock_guard guard(dropped_mutex_);
    released.swap(dropped_);
  }

  Solver solver_;
  TurnLock turns_;
  std::mutex dropped_mutex_;
  std::vector<std::shared_ptr<const Result>> dropped_;
};

}  // namespace gcdt::python

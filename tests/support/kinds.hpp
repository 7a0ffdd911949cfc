// SPDX-License-Identifier: Apache-2.0
// Devices as what they are and as GPUs, for tests of phases that have a way of their own for each (docs/testing.md).
#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "device_list.hpp"

namespace gcdt::test {

runtime::CallHook treated_as(DeviceKind kind);

/// A device, treated as something.
struct Treated {
  std::string name;  ///< such as "rusticl as gpu"
  std::unique_ptr<runtime::Runtime> runtime;
};

/// PoCL and Mesa's llvmpipe, both as they are and as GPUs, and the machine's other devices. Fails without the two,
/// unless GCDT_TEST_DEVICE is set: whoever names a device, such as a GPU, takes what else the machine has.
std::vector<Treated>& devices_as_all_kinds();

/// Levels, groups, lists and patches of a few; stamps that run out; sweeps from the start; isolated vertices
/// everywhere.
Tuning small_thresholds();

/// Other choices of a runtime for its life.
class Tuned {
 public:
  Tuned(runtime::Runtime& runtime, const Tuning& tuning) : tuning_(runtime.tuning()), before_(tuning_) {
    tuning_ = tuning;
  }
  ~Tuned() { tuning_ = before_; }
  Tuned(const Tuned&) = delete;
  Tuned& operator=(const Tuned&) = delete;

 private:
  Tuning& tuning_;
  Tuning before_;
};

}  // namespace gcdt::test

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "device/pinned_ranges.hpp"
#include "phases/order.hpp"

namespace gcdt {

/// As long as it lives, the input is known to be pinned, if the options say that it is.
class PinnedInput {
 public:
  PinnedInput(runtime::PinnedRanges& ranges, Points points, Constraints constraints, const Options& options) {
    if (!options.pinned) return;
    vertices_.emplace(ranges, points.data(), sizeof(cl_ulong) * words_per_vertex(points.type()) * points.size());
    constraints_.emplace(ranges, constraints.data(), sizeof(Constraint) * constraints.size());
  }

 private:
  std::optional<runtime::KnownPinned> vertices_, constraints_;
};

}  // namespace gcdt

// SPDX-License-Identifier: Apache-2.0
// The statistics of a call, as JSON and as a table.
#pragma once

#include <optional>
#include <string>

#include <gcdt/gcdt_pool.hpp>

namespace gcdt::command {

/// What was found of a result by asking further.
struct Measured {
  std::optional<Quality> quality;   ///< as `quality`
  TilesReport tiles;                ///< as `tiles`
  std::string plan;                 ///< as `plan`: which way the input went, as the library's log says
  std::optional<Assessment> given;  ///< as `given`, if it was asked for
  bool refined = false;             ///< that was asked for
  std::string noted;                ///< the one of `notes` that was said before the work, if any
};

/// Every field of Statistics under its own name (docs/statistics.md), and `measured`, indented, with a newline at the
/// end.
std::string statistics_json(const Statistics& statistics, const Measured& measured);

/// The counts and times that matter, one a line, aligned.
std::string statistics_table(const Statistics& statistics, const Measured& measured);

}  // namespace gcdt::command

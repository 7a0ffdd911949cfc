// SPDX-License-Identifier: Apache-2.0
// The statistics of a call, as JSON and as a table.
#pragma once

#include <string>

#include <gcdt/gcdt.hpp>

namespace gcdt::command {

/// Every field of Statistics under its own name (contract 7), and those of Quality, indented, with a newline at the
/// end.
std::string statistics_json(const Statistics& statistics, const Quality& quality);

/// The counts and times that matter, one a line, aligned.
std::string statistics_table(const Statistics& statistics);

}  // namespace gcdt::command

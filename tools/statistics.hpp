// SPDX-License-Identifier: Apache-2.0
// The statistics of a call, as JSON and as a table.
#pragma once

#include <optional>
#include <string>

#include <gcdt/gcdt.hpp>

namespace gcdt::command {

/// Every field of Statistics under its own name (contract 7), indented, with a newline at the end; the assessment, if
/// there is one, as `given`.
std::string statistics_json(const Statistics& statistics, const std::optional<Assessment>& assessment = {});

/// The counts and times that matter, one a line, aligned.
std::string statistics_table(const Statistics& statistics, const std::optional<Assessment>& assessment = {});

}  // namespace gcdt::command

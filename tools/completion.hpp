// SPDX-License-Identifier: Apache-2.0
// What shells and man need of the command.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace gcdt::command {

/// A completion for "bash", "zsh" or "fish", or the page for "man".
std::string completion(const CLI::App& app, const std::string& what, const std::string& version);

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
// Small questions about paths.
#pragma once

#include <string>

namespace gcdt::io {

/// The extension in lower case with its dot, such as ".poly"; empty if there is none.
std::string lower_extension(const std::string& path);

/// Whether two paths name one file, be it there already or not.
bool same_file(const std::string& a, const std::string& b);

}  // namespace gcdt::io

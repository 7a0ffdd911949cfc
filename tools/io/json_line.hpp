// SPDX-License-Identifier: Apache-2.0
// Where in a JSON text a value stands.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gcdt::io {

/// A member of an object, or an element of an array.
struct JsonStep {
  std::string key;  ///< empty: the element
  std::size_t element = 0;
};

/// The line, from 1, on which the value at the end of the path begins in `text`, which is JSON; of the last value on
/// the way that there is.
std::size_t json_line(std::string_view text, const std::vector<JsonStep>& path);

}  // namespace gcdt::io

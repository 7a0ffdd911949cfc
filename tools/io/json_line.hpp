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

/// Why a text is no JSON.
struct JsonFault {
  std::size_t line = 0, column = 0;  ///< of the last character that the parser has read, from 1
  std::string what;
};

/// The first fault of a text that the parser has refused.
JsonFault json_fault(std::string_view text);

}  // namespace gcdt::io

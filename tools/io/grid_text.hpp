// SPDX-License-Identifier: Apache-2.0
// The grid as one line of text, from which exactly the same grid is read back.
#pragma once

#include <optional>
#include <string>

#include <gcdt/gcdt.hpp>

namespace gcdt::io {

/// "binary", "decimal", "rounded" or "fixed".
const char* kind_name(Grid::Kind kind);

/// The cell's edge, exact: "<units>e<exponent>" for a decimal one, "2^<exponent>" for a power of two.
std::string cell_text(const Grid& grid);

/// Such as "kind=decimal origin=-180,-90 cell=1e-6 largest_move=0".
std::string to_text(const Grid& grid);

/// The inverse of to_text; nothing if the text is not of that form. Unknown words are passed over.
std::optional<Grid> grid_from_text(const std::string& text);

}  // namespace gcdt::io

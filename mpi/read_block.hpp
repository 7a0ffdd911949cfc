// SPDX-License-Identifier: Apache-2.0
// What a rank is given of an input file.
#pragma once

#include <string>

#include "io/triangle_files.hpp"
#include "tiles/ranks.hpp"

namespace gcdt::ranks {

/// Of a .pslg file each rank reads its own part alone; a file of another format is read by the first rank, which hands
/// the parts out, and has the whole in `whole`. Throws io::Failure: what is wrong with a .pslg file's size or head, all
/// ranks; else the rank that finds it.
tiles::InputBlock read_block(tiles::Team& team, const std::string& path, io::Input& whole);

}  // namespace gcdt::ranks

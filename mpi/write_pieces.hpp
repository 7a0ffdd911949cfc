// SPDX-License-Identifier: Apache-2.0
// A result that stays where it was made: a .vtu piece a rank, and the .pvtu that names them.
#pragma once

#include "io/output_files.hpp"
#include "tiles/ranks.hpp"

namespace gcdt::ranks {

/// The rank's piece: the vertices of its tiles, then those of other ranks, and added ones, that its triangles have. The
/// point array `vertex` has their numbers; the cell array `triangle` has those of the triangles, which `neighbours`
/// are, too. All pieces' triangles in the order of the ranks are the whole result. All ranks call it.
void write_piece(io::OutputFile& file, tiles::Team& team, const tiles::RankResult& rank);

/// `pieces`: their names, as they stand in the file.
void write_pvtu(io::OutputFile& file, const std::vector<std::string>& pieces);

}  // namespace gcdt::ranks

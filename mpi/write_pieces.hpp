// SPDX-License-Identifier: Apache-2.0
// A result that stays where it was made: a .vtu piece a rank, and the .pvtu that names them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/output_files.hpp"
#include "tiles/ranks.hpp"

namespace gcdt::ranks {

/// The names of all ranks' pieces, for an index NAME.pvtu: NAME_RANK.vtu, or, where there is one of these, those of the
/// first set NAME_RANK.1.vtu, NAME_RANK.2.vtu ... of which none is there: so no piece that an index names is written
/// over. The same for all ranks, which all call it.
std::vector<std::string> piece_names(tiles::Team& team, const std::filesystem::path& index);

/// Those that an index names which is there, if they are named like that.
std::vector<std::string> pieces_named_by(const std::filesystem::path& index);

/// The rank's piece: the vertices of its tiles, then those of other ranks, and added ones, that its triangles have. The
/// point array `vertex` has their numbers; the cell array `triangle` has those of the triangles, which `neighbours`
/// are, too. All pieces' triangles in the order of the ranks are the whole result. All ranks call it.
void write_piece(io::OutputFile& file, tiles::Team& team, const tiles::RankResult& rank);

/// `pieces`: their names, as they stand in the file.
void write_pvtu(io::OutputFile& file, const std::vector<std::string>& pieces);

}  // namespace gcdt::ranks

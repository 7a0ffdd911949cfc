// SPDX-License-Identifier: Apache-2.0
#include "read_block.hpp"

#include "io/inputs.hpp"
#include "io/paths.hpp"
#include "io/pslg.hpp"

namespace gcdt::ranks {

using tiles::begin_of_part;

namespace {

tiles::InputBlock read_part(const tiles::Team& team, const std::string& path) {
  io::PslgFile file(path);
  tiles::InputBlock block;
  block.all_vertices = file.vertices(), block.all_constraints = file.segments();
  const auto begin = [&](std::uint64_t count, std::size_t rank) { return begin_of_part(count, rank, team.size()); };
  const std::uint64_t v = begin(block.all_vertices, team.rank()), c = begin(block.all_constraints, team.rank());
  block.vertices.resize(static_cast<std::size_t>(begin(block.all_vertices, team.rank() + 1) - v));
  block.constraints.resize(static_cast<std::size_t>(begin(block.all_constraints, team.rank() + 1) - c));
  file.read_vertices(v, block.vertices.size(), block.vertices.data());
  file.read_segments(c, block.constraints.size(), block.constraints.data());
  return block;
}

}  // namespace

tiles::InputBlock read_block(tiles::Team& team, const std::string& path, io::Input& whole) {
  if (io::lower_extension(path) == ".pslg") return read_part(team, path);
  std::vector<tiles::Bytes> parts;
  if (team.is_first()) {
    whole = io::read_input(path);
    for (std::size_t rank = 0; rank < team.size(); ++rank) {
      const auto part = [&](const auto& all) {
        const std::uint64_t begin = begin_of_part(all.size(), rank, team.size());
        return Span(all.data() + begin,
                    static_cast<std::size_t>(begin_of_part(all.size(), rank + 1, team.size()) - begin));
      };
      tiles::Packer packer;
      packer.put_one(std::uint64_t{whole.vertices.size()});
      packer.put_one(std::uint64_t{whole.constraints.size()});
      packer.put(part(whole.vertices));
      packer.put(part(whole.constraints));
      parts.push_back(packer.take());
    }
  }
  const tiles::Bytes own = team.scatter(std::move(parts));
  tiles::InputBlock block;
  tiles::Unpacker from(own);
  from.get_one(block.all_vertices);
  from.get_one(block.all_constraints);
  from.append_to(block.vertices);
  from.append_to(block.constraints);
  return block;
}

}  // namespace gcdt::ranks

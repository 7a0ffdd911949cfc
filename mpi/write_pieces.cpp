// SPDX-License-Identifier: Apache-2.0
#include "write_pieces.hpp"

#include <fstream>

#include "device/parts.hpp"
#include "io/vtu_arrays.hpp"
#include "tiles/input_exchange.hpp"

#include <gcdt/gcdt.hpp>

namespace gcdt::ranks {

using namespace tiles;
namespace fs = std::filesystem;

namespace {

/// Vertices that a piece has: those of the rank's tiles, then others, each part by ascending number.
class PieceVertices {
 public:
  PieceVertices(Team& team, const RankResult& rank) : own_(rank.own), given_{{}, 0, own_.numbers, 0} {
    const std::uint64_t n = rank.part.result.statistics.n;
    const Span<GridPoint> added = added_of(rank.part.result);
    std::vector<Wanted> wanted;
    for (const SeamTriangle& triangle : rank.part.seam)
      for (std::size_t k = 0; k < 3; ++k)
        if (triangle.corners[k] < n && !is_own(triangle.corners[k]))
          wanted.push_back({triangle.corners[k], triangle.points[k]});
    std::sort(wanted.begin(), wanted.end(), [](const Wanted& a, const Wanted& b) { return a.number < b.number; });
    const auto same = [](const Wanted& a, const Wanted& b) { return a.number == b.number; };
    wanted.erase(std::unique(wanted.begin(), wanted.end(), same), wanted.end());
    others_ = coordinates_of(team, rank, wanted);
    for (const Wanted& one : wanted) numbers_.push_back(one.number);
    const std::vector<std::uint32_t> used = used_of(rank, n);
    std::vector<GridPoint> points;
    for (const std::uint32_t v : used) points.push_back(added[v - n]);
    const auto coordinates = grid_coordinates(rank.part.result.statistics.grid, points);
    others_.insert(others_.end(), coordinates.begin(), coordinates.end());
    numbers_.insert(numbers_.end(), used.begin(), used.end());
  }

  std::size_t size() const { return own_.numbers.size() + numbers_.size(); }
  std::uint32_t number(std::size_t i) const {
    const std::size_t own = own_.numbers.size();
    return i < own ? own_.numbers[i] : numbers_[i - own];
  }
  const std::array<double, 2>& coordinates(std::size_t i) const {
    const std::size_t own = own_.numbers.size();
    return i < own ? own_.vertices[i] : others_[i - own];
  }
  /// Of a vertex by its number.
  std::int32_t place_of(std::uint32_t number) const {
    if (is_own(number)) return static_cast<std::int32_t>(given_.place_of(number));
    const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), number);
    return static_cast<std::int32_t>(own_.numbers.size() + static_cast<std::size_t>(found - numbers_.begin()));
  }

 private:
  static Span<GridPoint> added_of(const ForestResult& result) {
    return result.begins[GCDT_ADDED].empty() ? Span<GridPoint>() : array_of<GridPoint>(result, GCDT_ADDED);
  }
  /// The added vertices that triangles of the rank have.
  static std::vector<std::uint32_t> used_of(const RankResult& rank, std::uint64_t n) {
    std::vector<std::uint32_t> used;
    for (const Triangle& triangle : array_of<Triangle>(rank.part.result, GCDT_TRIANGLES))
      for (const std::uint32_t v : triangle)
        if (v >= n) used.push_back(v);
    sort_unique(used);
    return used;
  }
  bool is_own(std::uint32_t v) const { return std::binary_search(own_.numbers.begin(), own_.numbers.end(), v); }

  const OwnVertices& own_;
  const GivenVertices given_;
  std::vector<std::uint32_t> numbers_;  ///< of the others
  Array<std::array<double, 2>> others_;
};

/// As the value of an attribute.
std::string escaped(const std::string& text) {
  std::string made;
  for (const char c : text) made += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return made;
}

std::string piece_name(const fs::path& index, std::size_t rank, unsigned set) {
  return fmt::format("{}_{}{}.vtu", index.stem().string(), rank, set > 0 ? fmt::format(".{}", set) : "");
}

/// Whether it is one of piece_name().
bool is_piece_name(const fs::path& index, const std::string& name) {
  const std::string head = index.stem().string() + "_", tail = ".vtu", digits = "0123456789";
  if (name.size() < head.size() + tail.size() || name.compare(0, head.size(), head) != 0) return false;
  if (name.compare(name.size() - tail.size(), tail.size(), tail) != 0) return false;
  const std::string numbers = name.substr(head.size(), name.size() - head.size() - tail.size());
  return numbers.find_first_not_of(digits + ".") == std::string::npos;
}

}  // namespace

std::vector<std::string> piece_names(Team& team, const fs::path& index) {
  std::vector<std::uint64_t> set(1, 0);
  const auto is_taken = [&] {
    std::error_code ignored;
    for (std::size_t rank = 0; rank < team.size(); ++rank) {
      const fs::path piece = index.parent_path() / piece_name(index, rank, static_cast<unsigned>(set[0]));
      if (fs::exists(fs::symlink_status(piece, ignored))) return true;
    }
    return false;
  };
  while (team.is_first() && is_taken()) ++set[0];  // ends: a folder has finitely many files
  broadcast(team, set);
  std::vector<std::string> names;
  for (std::size_t rank = 0; rank < team.size(); ++rank)
    names.push_back(piece_name(index, rank, static_cast<unsigned>(set[0])));
  return names;
}

std::vector<std::string> pieces_named_by(const fs::path& index) {
  constexpr std::uintmax_t most_bytes = 1 << 26;  // what is larger is no index of ours
  std::error_code error;
  std::vector<std::string> names;
  if (const auto size = fs::file_size(index, error); error || size > most_bytes) return names;
  std::ifstream file(index, std::ios::binary);
  const std::string begin = "<Piece Source=\"";
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, begin.size(), begin) != 0) continue;
    const std::string source = line.substr(begin.size(), line.find('"', begin.size()) - begin.size());
    const std::string head = escaped(index.stem().string());
    if (source.compare(0, head.size(), head) != 0) continue;
    const std::string name = index.stem().string() + source.substr(head.size());
    if (is_piece_name(index, name)) names.push_back(name);
  }
  return names;
}

void write_piece(io::OutputFile& file, Team& team, const RankResult& rank) {
  const ForestResult& result = rank.part.result;
  const PieceVertices vertices(team, rank);
  const auto triangles = array_of<Triangle>(result, GCDT_TRIANGLES);
  const auto neighbours = array_of<Neighbours>(result, GCDT_NEIGHBOURS);
  const auto constrained = array_of<std::uint8_t>(result, GCDT_CONSTRAINED);
  const std::uint64_t count = triangles.size(), points = vertices.size();
  Array<std::array<std::int32_t, 3>> corners(triangles.size());
  for_each_in_threads(triangles.size(), [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) corners[t][k] = vertices.place_of(triangles[t][k]);
  });
  file.print("{}<UnstructuredGrid>\n", io::vtk_head("UnstructuredGrid"));
  io::write_grid(file, result.statistics.grid);
  file.print("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n", points, count);
  io::write_array<double>(file, "Name=\"Points\" NumberOfComponents=\"3\"", 3 * points,
                          [&](std::uint64_t i) { return i % 3 < 2 ? vertices.coordinates(i / 3)[i % 3] : 0.0; });
  file.print("</Points>\n<PointData>\n");
  io::write_array<std::uint32_t>(file, "Name=\"vertex\"", points, [&](std::uint64_t i) { return vertices.number(i); });
  file.print("</PointData>\n<Cells>\n");
  io::write_array<std::int32_t>(file, "Name=\"connectivity\"", 3 * count,
                                [&](std::uint64_t i) { return corners[i / 3][i % 3]; });
  io::write_array<std::int64_t>(file, "Name=\"offsets\"", count, [](std::uint64_t i) { return 3 * (i + 1); });
  io::write_array<std::uint8_t>(file, "Name=\"types\"", count, [](std::uint64_t) { return io::vtk_triangle; });
  file.print("</Cells>\n<CellData>\n");
  io::write_array<std::uint32_t>(file, "Name=\"triangle\"", count,
                                 [&](std::uint64_t i) { return rank.part.first + i; });
  io::write_array<std::uint8_t>(file, "Name=\"constrained\"", count, [&](std::uint64_t i) { return constrained[i]; });
  io::write_array<std::int32_t>(file, "Name=\"neighbours\" NumberOfComponents=\"3\"", 3 * count,
                                [&](std::uint64_t i) { return neighbours[i / 3][i % 3]; });
  file.print("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
}

void write_pvtu(io::OutputFile& file, const std::vector<std::string>& pieces) {
  file.print(
      "{}<PUnstructuredGrid GhostLevel=\"0\">\n<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" "
      "NumberOfComponents=\"3\"/>\n</PPoints>\n<PPointData>\n<PDataArray type=\"UInt32\" "
      "Name=\"vertex\"/>\n</PPointData>\n<PCellData>\n<PDataArray type=\"UInt32\" Name=\"triangle\"/>\n<PDataArray "
      "type=\"UInt8\" Name=\"constrained\"/>\n<PDataArray type=\"Int32\" Name=\"neighbours\" "
      "NumberOfComponents=\"3\"/>\n</PCellData>\n",
      io::vtk_head("PUnstructuredGrid"));
  for (const std::string& piece : pieces) file.print("<Piece Source=\"{}\"/>\n", escaped(piece));
  file.print("</PUnstructuredGrid>\n</VTKFile>\n");
}

}  // namespace gcdt::ranks

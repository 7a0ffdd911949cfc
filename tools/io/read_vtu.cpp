// SPDX-License-Identifier: Apache-2.0
#include <pugixml.hpp>

#include <algorithm>
#include <cstring>
#include <limits>
#include <sstream>
#include <string_view>
#include <type_traits>

#include "base64.hpp"
#include "grid_text.hpp"
#include "vtu.hpp"

namespace gcdt::io {

namespace {

constexpr std::string_view marker_array = "marker";  // of points; see write_vtu

/// A number as another type; out of that type's range, or not a number, it is the least of the type.
template <class To, class From>
To narrowed(From value) {
  if constexpr (std::is_floating_point_v<From> && std::is_integral_v<To>) {
    constexpr double low = static_cast<double>(std::numeric_limits<To>::min());
    constexpr double high = static_cast<double>(std::numeric_limits<To>::max());
    if (!(value >= low && value < high)) return std::numeric_limits<To>::min();
  }
  return static_cast<To>(value);
}

template <class To, class From>
std::vector<To> converted(const std::string& bytes, std::size_t skip) {
  std::vector<To> values((bytes.size() - skip) / sizeof(From));
  for (std::size_t i = 0; i < values.size(); ++i) {
    From value;
    std::memcpy(&value, bytes.data() + skip + i * sizeof value, sizeof value);
    values[i] = narrowed<To>(value);
  }
  return values;
}

class VtuReader {
 public:
  explicit VtuReader(const std::string& path) : name_(path), text_(read_file(path)) {
    const auto parsed = document_.load_buffer(text_.data(), text_.size());
    if (!parsed) fail(parsed.offset, parsed.description());
    const auto file = document_.child("VTKFile");
    grid_ = file.child("UnstructuredGrid");
    if (!grid_) fail(0, "not a VTKFile of type UnstructuredGrid");
    if (file.attribute("compressor")) fail(file, "compressed arrays are not supported");
    const std::uint16_t one = 1;
    const bool little = *reinterpret_cast<const unsigned char*>(&one) == 1;
    const std::string order = file.attribute("byte_order").as_string(little ? "LittleEndian" : "BigEndian");
    if (order != (little ? "LittleEndian" : "BigEndian")) fail(file, "the byte order is not this machine's");
    header_bytes_ = file.attribute("header_type").as_string("UInt32") == std::string("UInt64") ? 8 : 4;
  }

  MeshFile read() {
    MeshFile mesh;
    const auto piece = grid_.child("Piece");
    if (!piece) fail(grid_, "no Piece");
    if (piece.next_sibling("Piece")) fail(piece.next_sibling("Piece"), "more than one Piece is not supported");
    read_points(piece, mesh);
    read_point_data(piece.child("PointData"), mesh);
    read_triangles(piece, mesh);
    read_cell_data(piece.child("CellData"), mesh);
    read_grid(grid_.child("FieldData"), mesh);
    return mesh;
  }

 private:
  [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& what, Exit exit = Exit::input) const {
    const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    throw Failure(exit, fmt::format("{}:{}: {}", name_, 1 + std::count(text_.begin(), end, '\n'), what));
  }
  [[noreturn]] void fail(pugi::xml_node node, const std::string& what, Exit exit = Exit::input) const {
    fail(node.offset_debug(), what, exit);
  }

  static pugi::xml_node named(pugi::xml_node parent, const char* name) {
    return parent.find_child_by_attribute("DataArray", "Name", name);
  }

  template <class To>
  std::vector<To> ascii(pugi::xml_node array) const {
    std::vector<To> values;
    std::istringstream in(array.text().get());
    using Read = std::conditional_t<sizeof(To) == 1, int, To>;  // a byte would be read as a letter
    for (Read value; in >> value;) values.push_back(narrowed<To>(value));
    if (!in.eof()) fail(array, "an array holds something that is not a number");
    return values;
  }

  template <class To>
  std::vector<To> numbers(pugi::xml_node array) const {
    const std::string format = array.attribute("format").as_string(), type = array.attribute("type").as_string();
    if (format == "ascii") return ascii<To>(array);
    if (format != "binary") fail(array, fmt::format("arrays of format \"{}\" are not supported", format));
    std::string bytes;
    if (!decode_base64(array.text().get(), bytes)) fail(array, "an array is not valid base64");
    std::uint64_t size = 0;
    if (bytes.size() >= header_bytes_)
      std::memcpy(&size, bytes.data(), header_bytes_);  // a little-endian UInt32 or UInt64
    if (bytes.size() < header_bytes_ || size != bytes.size() - header_bytes_)
      fail(array, "an array is not as long as its header says");
    if (type == "Float64") return converted<To, double>(bytes, header_bytes_);
    if (type == "Float32") return converted<To, float>(bytes, header_bytes_);
    if (type == "Int64") return converted<To, std::int64_t>(bytes, header_bytes_);
    if (type == "UInt64") return converted<To, std::uint64_t>(bytes, header_bytes_);
    if (type == "Int32") return converted<To, std::int32_t>(bytes, header_bytes_);
    if (type == "UInt32") return converted<To, std::uint32_t>(bytes, header_bytes_);
    if (type == "UInt8") return converted<To, std::uint8_t>(bytes, header_bytes_);
    if (type == "Int8") return converted<To, std::int8_t>(bytes, header_bytes_);
    fail(array, fmt::format("arrays of type \"{}\" are not supported", type));
  }

  void read_points(pugi::xml_node piece, MeshFile& mesh) const {
    const auto array = piece.child("Points").child("DataArray");
    if (!array) fail(piece, "no points");
    const auto xyz = numbers<double>(array);
    if (xyz.size() != 3 * piece.attribute("NumberOfPoints").as_ullong())
      fail(array, "the points are not as many as the Piece says");
    bool flat = true;
    for (std::size_t i = 0; i + 2 < xyz.size(); i += 3) {
      mesh.vertices.push_back({xyz[i], xyz[i + 1]});
      flat = flat && xyz[i + 2] == 0;
    }
    if (flat) return;
    mesh.attribute_count = 1;
    for (std::size_t i = 2; i < xyz.size(); i += 3) mesh.attributes.push_back(xyz[i]);
  }

  /// Arrays of one number a point, but for the markers; after the heights, if there are any.
  void read_point_data(pugi::xml_node data, MeshFile& mesh) const {
    std::vector<std::vector<double>> columns;
    if (mesh.attribute_count == 1) columns.push_back(std::move(mesh.attributes));
    mesh.attributes.clear();
    for (const auto array : data.children("DataArray")) {
      if (array.attribute("NumberOfComponents").as_uint(1) != 1 || array.attribute("Name").value() == marker_array)
        continue;
      columns.push_back(numbers<double>(array));
      if (columns.back().size() != mesh.vertices.size()) fail(array, "not one number for every point");
    }
    mesh.attribute_count = static_cast<std::uint32_t>(columns.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      for (const auto& column : columns) mesh.attributes.push_back(column[v]);
  }

  void read_triangles(pugi::xml_node piece, MeshFile& mesh) const {
    const auto cells = piece.child("Cells");
    const auto corners = numbers<std::int64_t>(named(cells, "connectivity"));
    const auto offsets = numbers<std::int64_t>(named(cells, "offsets"));
    const auto types = numbers<std::int64_t>(named(cells, "types"));
    const std::size_t count = types.size();
    if (count != piece.attribute("NumberOfCells").as_ullong() || offsets.size() != count || corners.size() != 3 * count)
      fail(cells, "the cells are not as many as the Piece says, or not all triangles");
    for (std::size_t t = 0; t < count; ++t) {
      if (types[t] != 5 || offsets[t] != static_cast<std::int64_t>(3 * (t + 1)))
        fail(cells, fmt::format("cell {} is not a triangle", t));
      for (std::size_t k = 3 * t; k < 3 * t + 3; ++k)
        if (corners[k] < 0 || static_cast<std::size_t>(corners[k]) >= mesh.vertices.size())
          fail(cells, fmt::format("triangle {} names point {}, which does not exist", t, corners[k]), Exit::check);
      auto corner = [&](std::size_t k) { return static_cast<std::uint32_t>(corners[3 * t + k]); };
      mesh.triangles.push_back({corner(0), corner(1), corner(2)});
    }
  }

  void read_cell_data(pugi::xml_node data, MeshFile& mesh) const {
    const std::size_t count = mesh.triangles.size();
    if (const auto array = named(data, "constrained")) {
      mesh.constrained = numbers<std::uint8_t>(array);
      if (mesh.constrained.size() != count) fail(array, "not one number for every triangle");
    }
    auto regions = [&](const char* name, auto& values) {
      const auto array = named(data, name);
      if (!array) return;
      values = numbers<std::decay_t<decltype(values[0])>>(array);
      if (values.size() != count) fail(array, "not one number for every triangle");
    };
    regions("region", mesh.region);
    regions("depth", mesh.depth);
    regions("winding", mesh.winding);
    if (const auto array = named(data, "neighbours")) {
      const auto across = numbers<std::int64_t>(array);
      if (across.size() != 3 * count) fail(array, "not three numbers for every triangle");
      for (std::size_t i = 0; i < across.size(); ++i)
        if (across[i] < -1 || across[i] >= static_cast<std::int64_t>(count))
          fail(array, fmt::format("triangle {} names neighbour {}, which does not exist", i / 3, across[i]),
               Exit::check);
      for (std::size_t t = 0; t < count; ++t) {
        auto neighbour = [&](std::size_t k) { return static_cast<std::int32_t>(across[3 * t + k]); };
        mesh.neighbours.push_back({neighbour(0), neighbour(1), neighbour(2)});
      }
    }
  }

  /// The grid if the field data hold all of it; checked by going through its text.
  void read_grid(pugi::xml_node fields, MeshFile& mesh) const {
    const auto kind_array = named(fields, "gcdt_grid_kind");
    if (!kind_array) return;
    auto field = [&](const char* name, std::size_t size) {
      const auto array = named(fields, name);
      if (!array) fail(fields, fmt::format("no field {}", name));
      return std::make_pair(array, size);
    };
    auto take = [&](const char* name, auto zero, std::size_t size = 1) {
      const auto values = numbers<decltype(zero)>(field(name, size).first);
      if (values.size() != size) fail(field(name, size).first, fmt::format("{} numbers in {}", values.size(), name));
      return values;
    };
    Grid grid;
    const auto kind = take("gcdt_grid_kind", std::int32_t{});
    if (kind[0] < 0 || kind[0] > 3) fail(kind_array, "no such kind of grid");
    grid.kind = static_cast<Grid::Kind>(kind[0]);
    const auto origin = take("gcdt_grid_origin", double{}, 2);
    grid.origin = {origin[0], origin[1]};
    grid.cell_units = take("gcdt_grid_cell_units", std::uint64_t{})[0];
    grid.cell_decimals = take("gcdt_grid_cell_decimals", std::int32_t{})[0];
    grid.cell_exponent = take("gcdt_grid_cell_exponent", std::int32_t{})[0];
    grid.largest_move = take("gcdt_grid_largest_move", double{})[0];
    if (!grid_from_text(to_text(grid))) fail(kind_array, "the grid makes no sense");
    mesh.grid = grid;
  }

  std::string name_, text_;
  pugi::xml_document document_;
  pugi::xml_node grid_;
  std::size_t header_bytes_ = 8;
};

}  // namespace

MeshFile read_vtu(const std::string& path) { return VtuReader(path).read(); }

}  // namespace gcdt::io

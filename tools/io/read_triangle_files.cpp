// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <unordered_map>

#include "grid_text.hpp"
#include "inputs.hpp"
#include "paths.hpp"
#include "triangle_files.hpp"

namespace gcdt::io {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t max_constraints = (1ull << 31) - 1;
/// The shortest record, "0 0 0" and its line end, bounds how many records a text can hold.
constexpr std::size_t shortest_record = 6;

void expect_end(Records& in) {
  if (in.next()) in.fail("more text than the counts announce");
}

/// A field that may be absent; 0 then. Beyond 32 bits it is refused.
std::int32_t marker(Records& in, const char* what) {
  if (!in.more()) return 0;
  const std::int64_t value = in.integer(what);
  if (value != static_cast<std::int32_t>(value)) in.fail(fmt::format("{} has more than 32 bits: {}", what, in.field()));
  return static_cast<std::int32_t>(value);
}

/// What a header says about each record.
struct Extras {
  std::uint64_t count = 0, attributes = 0;
  bool markers = false;
};

/// `<vertices> <dimension> <attributes> <markers>`, the last three at will.
Extras vertex_header(Records& in) {
  if (!in.next()) in.fail("the number of vertices is missing");
  Extras header;
  header.count = in.count("the number of vertices", max_vertices);
  if (in.more() && in.integer("the dimension") != 2)
    in.fail(fmt::format("the dimension must be 2, not {}", in.field()));
  if (in.more()) header.attributes = in.count("the number of attributes", max_attributes);
  if (in.more()) header.markers = in.count("the number of markers", 1) == 1;
  in.skip_numbers("the header");
  return header;
}

/// Attributes and marker as the header announces them; further numbers are read over.
void read_extras(Records& in, const Extras& header, Input& out) {
  for (std::uint64_t i = 0; i < header.attributes; ++i) out.attributes.push_back(in.number("an attribute or marker"));
  if (header.markers) out.vertex_markers.push_back(marker(in, "the vertex marker"));
  in.skip_numbers("an attribute or marker");
}

void read_vertices(Records& in, const Extras& header, Input& out) {
  const std::uint64_t count = header.count;
  out.attribute_count = static_cast<std::uint32_t>(header.attributes);
  out.vertices.reserve(in.reservation(count, shortest_record));
  out.vertex_file = in.name();
  for (std::uint64_t i = 0; i < count; ++i) {
    in.expect("vertices", i, count);
    const std::int64_t number = in.integer("the vertex number");
    if (i == 0) {
      if (number != 0 && number != 1)
        in.fail(fmt::format("the first vertex must have the number 0 or 1, not {}", in.field()));
      out.first = static_cast<std::uint32_t>(number);
    } else if (number != static_cast<std::int64_t>(i + out.first)) {
      in.fail(fmt::format("vertex number {} where {} is due", in.field(), i + out.first));
    }
    const double x = in.coordinate("x coordinate");
    const double y = in.coordinate("y coordinate");
    read_extras(in, header, out);
    out.vertices.push_back({x, y});
    out.vertex_lines.append(in.line());
  }
}

std::uint32_t segment_end(Records& in, const Input& out, std::uint64_t segment) {
  const std::int64_t number = in.integer("the segment's end");
  const std::int64_t index = number < 0 ? -1 : number - out.first;
  if (index < 0 || static_cast<std::uint64_t>(index) >= out.vertices.size())
    in.fail(out.vertices.empty()
                ? fmt::format("segment {} names vertex {}, but there are no vertices", segment, in.field())
                : fmt::format("segment {} names vertex {}, but the vertices are {} to {}", segment, in.field(),
                              out.first, out.first + out.vertices.size() - 1));
  return static_cast<std::uint32_t>(index);
}

void read_segments(Records& in, std::uint64_t count, bool markers, Input& out) {
  out.constraints.reserve(in.reservation(count, shortest_record));
  out.constraint_file = in.name();
  for (std::uint64_t i = 0; i < count; ++i) {
    in.expect("segments", i, count);
    const std::int64_t number = in.integer("the segment number");
    if (i == 0) out.first_constraint = number == 1 ? 1 : 0;
    const std::uint32_t a = segment_end(in, out, i + out.first_constraint);
    const std::uint32_t b = segment_end(in, out, i + out.first_constraint);
    if (markers) out.constraint_markers.push_back(marker(in, "a segment's marker"));
    in.skip_numbers("a segment's marker");
    out.constraints.push_back({a, b});
    out.constraint_lines.append(in.line());
  }
}

/// Holes or regions: `<number> <x> <y> ...`. Calls read(point) for each, which may read further fields.
template <class Read>
void read_section(Records& in, const char* kind, Read&& read) {
  if (!in.next()) return;
  const std::uint64_t count = in.count(fmt::format("the number of {}", kind), max_constraints);
  in.skip_numbers("the header");
  for (std::uint64_t i = 0; i < count; ++i) {
    in.expect(kind, i, count);
    in.integer("the number");
    const double x = in.coordinate("x coordinate");
    const double y = in.coordinate("y coordinate");
    read(std::array<double, 2>{x, y});
    in.skip_numbers("an attribute");
  }
}

void read_region(Records& in, const std::array<double, 2>& point, Input& out) {
  Input::Region region;
  region.point = point;
  if (in.more()) region.attribute = in.number("an attribute");
  if (in.more()) region.largest_area = in.number("the largest area");
  out.regions.push_back(region);
}

/// A .poly without vertices takes them from the .node beside it, as Triangle does. Without that file
/// it is the empty input, provided that it has no segments either.
void read_vertices_beside(const std::string& path, const Records& poly, bool segments, Input& out) {
  const std::string beside = path == "-" ? std::string() : fs::path(path).replace_extension(".node").string();
  std::error_code ignored;
  if (beside.empty() || !fs::exists(beside, ignored)) {
    out.vertex_file = poly.name();
    if (!segments) return;
    poly.fail(beside.empty() ? "segments without vertices"
                             : fmt::format("segments without vertices, and no file {} that has them", beside));
  }
  Records in(beside);
  out.files.push_back(beside);
  read_vertices(in, vertex_header(in), out);
  expect_end(in);
}

void read_poly(const std::string& path, Input& out) {
  Records in(path);
  const Extras vertices = vertex_header(in);
  if (vertices.count > 0) read_vertices(in, vertices, out);
  if (!in.next()) in.fail("the number of segments is missing");
  const std::uint64_t segments = in.count("the number of segments", max_constraints);
  const bool markers = in.more() && in.count("the number of markers", 1) == 1;
  in.skip_numbers("the header");
  if (vertices.count == 0) read_vertices_beside(path, in, segments > 0, out);
  read_segments(in, segments, markers, out);
  read_section(in, "holes", [&](const auto& point) { out.holes.push_back(point); });
  read_section(in, "regions", [&](const auto& point) { read_region(in, point, out); });
  expect_end(in);
}

/// The rows of .ele or .neigh, by triangle number: numbers may come in any order.
class RowNumbers {
 public:
  void append(std::int64_t number) { numbers_.push_back(number); }
  std::size_t size() const { return numbers_.size(); }
  /// To be called after the last append.
  void index() {
    for (std::size_t i = 0; i < numbers_.size() && in_order_; ++i) in_order_ = after_first(numbers_[i]) == i;
    if (in_order_) return;
    for (std::size_t i = 0; i < numbers_.size(); ++i) rows_.emplace(numbers_[i], i);
  }
  bool distinct() const { return in_order_ || rows_.size() == numbers_.size(); }
  std::optional<std::size_t> row(std::int64_t number) const {
    if (!in_order_) {
      const auto found = rows_.find(number);
      return found == rows_.end() ? std::nullopt : std::optional(found->second);
    }
    if (numbers_.empty() || after_first(number) >= size()) return std::nullopt;
    return static_cast<std::size_t>(after_first(number));
  }

 private:
  /// The distance from the first number, in wrapping arithmetic: any number may stand in a file.
  std::uint64_t after_first(std::int64_t number) const {
    return static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(numbers_[0]);
  }

  std::vector<std::int64_t> numbers_;
  bool in_order_ = true;
  std::unordered_map<std::int64_t, std::size_t> rows_;
};

void take_grid(const Records& in, MeshFile& out) {
  const auto& [text, line] = in.grid_comment();
  if (text.empty()) return;
  out.grid = grid_from_text(text);
  if (!out.grid)
    throw Failure(Exit::input, fmt::format("{}:{}: the grid cannot be read from this comment", in.name(), line));
}

/// `<triangles> <corners or neighbours: 3> ...`
std::uint64_t triangle_header(Records& in) {
  if (!in.next()) in.fail("the number of triangles is missing");
  const std::uint64_t count = in.count("the number of triangles", 2 * max_vertices);
  if (in.integer("the number of corners") != 3) in.fail(fmt::format("triangles have 3 corners, not {}", in.field()));
  in.skip_numbers("the header");
  return count;
}

void read_ele(Records& in, std::uint64_t vertex_count, std::uint32_t first, MeshFile& out, RowNumbers& rows) {
  const std::uint64_t count = triangle_header(in);
  out.triangles.reserve(in.reservation(count, shortest_record));
  for (std::uint64_t i = 0; i < count; ++i) {
    in.expect("triangles", i, count);
    rows.append(in.integer("the triangle number"));
    std::array<std::uint32_t, 3> corners;
    for (std::uint32_t& corner : corners) {
      const std::int64_t number = in.integer("a corner");
      if (number < first || static_cast<std::uint64_t>(number) - first >= vertex_count)
        in.fail(fmt::format("a triangle names vertex {}, which does not exist", in.field()), Exit::check);
      corner = static_cast<std::uint32_t>(number - first);
    }
    in.skip_numbers("an attribute");
    out.triangles.push_back(corners);
  }
  expect_end(in);
  take_grid(in, out);
  rows.index();
}

void read_neigh(Records& in, const RowNumbers& rows, MeshFile& out) {
  const std::uint64_t count = triangle_header(in);
  if (count != rows.size())
    in.fail(fmt::format("{} triangles here, but {} in the .ele beside", count, rows.size()), Exit::check);
  if (!rows.distinct()) in.fail("triangle numbers occur twice in the .ele beside", Exit::check);
  out.neighbours.assign(out.triangles.size(), {-1, -1, -1});
  std::vector<bool> seen(out.triangles.size());
  for (std::uint64_t i = 0; i < count; ++i) {
    in.expect("triangles", i, count);
    const auto row = rows.row(in.integer("the triangle number"));
    if (!row || seen[*row])
      in.fail(fmt::format("triangle {} {}", in.field(), row ? "occurs twice" : "does not exist in the .ele beside"),
              Exit::check);
    seen[*row] = true;
    for (std::int32_t& neighbour : out.neighbours[*row]) {
      const std::int64_t number = in.integer("a neighbour");
      const auto across = number == -1 ? std::nullopt : rows.row(number);
      if (number != -1 && !across) in.fail(fmt::format("neighbour {} does not exist", in.field()), Exit::check);
      neighbour = across ? static_cast<std::int32_t>(*across) : -1;
    }
  }
  expect_end(in);
  take_grid(in, out);
}

}  // namespace

Input read_triangle_file(const std::string& path) {
  Input input;
  input.files.push_back(path);
  if (lower_extension(path) == ".node") {
    Records in(path);
    read_vertices(in, vertex_header(in), input);
    expect_end(in);
  } else {
    read_poly(path, input);
  }
  return input;
}

std::vector<std::array<double, 2>> vertices_beside(const std::string& path, const Input& input) {
  const std::string node = fs::path(path).replace_extension(".node").string();
  std::error_code ignored;
  if (!fs::exists(node, ignored)) return input.vertices;
  std::vector<std::array<double, 2>> vertices = read_input(node).vertices;
  const bool extends = vertices.size() >= input.vertices.size() &&
                       std::equal(input.vertices.begin(), input.vertices.end(), vertices.begin());
  return extends ? vertices : input.vertices;
}

MeshFile read_mesh(const std::string& path, std::uint64_t vertex_count, std::uint32_t first) {
  MeshFile mesh;
  RowNumbers rows;
  const bool with_neighbours = lower_extension(path) == ".neigh";
  Records ele(with_neighbours ? fs::path(path).replace_extension(".ele").string() : path);
  read_ele(ele, vertex_count, first, mesh, rows);
  if (with_neighbours) {
    Records neigh(path);
    read_neigh(neigh, rows, mesh);
  }
  return mesh;
}

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
// Inputs and meshes as NumPy's arrays, alone (.npy) or by name in an archive (.npz).
#include <fmt/format.h>

#include "binary_file.hpp"
#include "inputs.hpp"
#include "npz.hpp"
#include "zip_archive.hpp"

namespace gcdt::io {

namespace {

/// The first two columns are x and y; others are attributes, the first of them, if it is alone, the height.
void take_vertices(NpyArray& array, Input& input) {
  const std::uint64_t columns = array.columns();
  if (array.rows() > max_vertices)
    array.fail(fmt::format("the array has {} rows; at most {} vertices are possible", array.rows(), max_vertices));
  if (columns < 2 || columns > 2 + max_attributes)
    array.fail(fmt::format("vertices have 2 columns, and more for attributes; these have {}", columns));
  input.vertices.resize(array.rows());
  if (columns == 2) return array.read(reinterpret_cast<double*>(input.vertices.data()));
  std::vector<double> numbers(array.rows() * columns);
  array.read(numbers.data());
  input.attribute_count = static_cast<std::uint32_t>(columns - 2);
  input.heights = columns == 3;
  for (std::uint64_t v = 0; v < array.rows(); ++v) {
    const auto row = numbers.begin() + static_cast<std::ptrdiff_t>(v * columns);
    input.vertices[v] = {row[0], row[1]};
    input.attributes.insert(input.attributes.end(), row + 2, row + static_cast<std::ptrdiff_t>(columns));
  }
}

/// The arrays of an archive by name; each must have the rows and columns that are due.
class Arrays {
 public:
  explicit Arrays(const std::string& path) : archive_(path) {}
  bool has(const char* name) const { return archive_.has(entry(name)); }
  NpyArray open(const char* name) const { return NpyArray(archive_.open(entry(name))); }
  NpyArray open(const char* name, std::optional<std::uint64_t> rows, std::uint64_t columns) const {
    NpyArray array = open(name);
    if (rows && array.rows() != *rows) array.fail(fmt::format("{} rows are due, not {}", *rows, array.rows()));
    if (array.columns() != columns) array.fail(fmt::format("{} columns are due, not {}", columns, array.columns()));
    return array;
  }
  std::vector<double> numbers(const char* name, std::optional<std::uint64_t> rows, std::uint64_t columns) const {
    NpyArray array = open(name, rows, columns);
    std::vector<double> numbers(array.rows() * columns);
    array.read(numbers.data());
    return numbers;
  }
  template <class T>
  void integers(const char* name, std::optional<std::uint64_t> rows, std::uint64_t columns, std::int64_t least,
                std::int64_t most, std::vector<T>& into) const {
    NpyArray array = open(name, rows, columns);
    const std::vector<std::int64_t> numbers = array.integers();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (numbers[i] < least || numbers[i] > most)
        array.fail(fmt::format("row {} has {}; it must be from {} to {}", i / columns, numbers[i], least, most));
      into.push_back(static_cast<T>(numbers[i]));
    }
  }

 private:
  static std::string entry(const char* name) { return fmt::format("{}.npy", name); }
  ZipArchive archive_;
};

constexpr const char* vertices_name = "vertices";

void take_segments(const Arrays& arrays, Input& input) {
  std::vector<std::uint32_t> ends;
  arrays.integers("segments", std::nullopt, 2, 0, static_cast<std::int64_t>(input.vertices.size()) - 1, ends);
  input.constraints.reserve(ends.size() / 2);
  for (std::size_t i = 0; i < ends.size(); i += 2) input.constraints.push_back({ends[i], ends[i + 1]});
}

Input input_of(const Arrays& arrays, const std::string& path) {
  Input input = io::input_of(path);
  if (!arrays.has(vertices_name))
    throw Failure(Exit::input, fmt::format("{}: there is no array \"vertices\" in it", path));
  NpyArray vertices = arrays.open(vertices_name);
  take_vertices(vertices, input);
  const std::uint64_t count = input.vertices.size();
  if (arrays.has("vertex_attributes") && input.attribute_count == 0) {
    NpyArray array = arrays.open("vertex_attributes");
    if (array.rows() != count) array.fail(fmt::format("{} rows are due, not {}", count, array.rows()));
    if (array.columns() > max_attributes) array.fail("too many columns");
    input.attribute_count = static_cast<std::uint32_t>(array.columns());
    input.attributes.resize(count * array.columns());
    array.read(input.attributes.data());
  }
  if (arrays.has("vertex_markers"))
    arrays.integers("vertex_markers", count, 1, INT32_MIN, INT32_MAX, input.vertex_markers);
  if (arrays.has("segments")) take_segments(arrays, input);
  if (arrays.has("segment_markers"))
    arrays.integers("segment_markers", input.constraints.size(), 1, INT32_MIN, INT32_MAX, input.constraint_markers);
  if (arrays.has("holes")) {
    const std::vector<double> holes = arrays.numbers("holes", std::nullopt, 2);
    for (std::size_t i = 0; i < holes.size(); i += 2) input.holes.push_back({holes[i], holes[i + 1]});
  }
  if (arrays.has("regions")) {
    const std::vector<double> r = arrays.numbers("regions", std::nullopt, 4);
    for (std::size_t i = 0; i < r.size(); i += 4) input.regions.push_back({{r[i], r[i + 1]}, r[i + 2], r[i + 3]});
  }
  return input;
}

}  // namespace

Input read_npy(const std::string& path) {
  BinaryFile file(path);
  NpyArray array({path, file.size(), [&](void* to, std::uint64_t bytes) {
                    const std::uint64_t some = std::min(bytes, file.left());
                    file.read(to, some, "the array");
                    return some;
                  }});
  Input input = io::input_of(path);
  take_vertices(array, input);
  return input;
}

Input read_npz(const std::string& path) { return input_of(Arrays(path), path); }

bool npz_holds_mesh(const std::string& path) { return Arrays(path).has("triangles"); }

MeshInput read_npz_mesh(const std::string& path) {
  const Arrays arrays(path);
  MeshInput read;
  read.input = input_of(arrays, path);
  const auto count = static_cast<std::int64_t>(read.input.vertices.size());
  std::vector<std::uint32_t> corners;
  arrays.integers("triangles", std::nullopt, 3, 0, count - 1, corners);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    read.mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  if (arrays.has("constrained"))
    arrays.integers("constrained", read.mesh.triangles.size(), 1, 0, 7, read.mesh.constrained);
  if (arrays.has("region")) arrays.integers("region", read.mesh.triangles.size(), 1, 0, UINT32_MAX, read.mesh.region);
  return read;
}

}  // namespace gcdt::io

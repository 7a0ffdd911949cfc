// SPDX-License-Identifier: Apache-2.0
#include "binary_file.hpp"
#include "grid_text.hpp"
#include "markers.hpp"
#include "npz.hpp"
#include "zip_archive.hpp"

namespace gcdt::io {

namespace {

template <class T>
const char* kind_of() {
  if constexpr (std::is_same_v<T, double>) return "<f8";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "|u1";
  if constexpr (std::is_same_v<T, std::int32_t>) return "<i4";
}

/// The header of version 1.0, filled up so that the numbers begin at a multiple of 64 bytes.
std::string header(const std::string& kind, const std::string& shape) {
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", kind, shape);
  constexpr std::size_t before = 10, alignment = 64;
  text.append((alignment - (before + text.size() + 1) % alignment) % alignment, ' ');
  text += '\n';
  std::string begin = std::string("\x93NUMPY\x01\x00", 8);
  put_little(static_cast<std::uint16_t>(text.size()), [&](std::string_view bytes) { begin += bytes; });
  return begin + text;
}

/// An array of `rows` rows; value(i) is its number i, row by row.
template <class T, class Value, class Sink>
void put_array(std::uint64_t rows, std::uint64_t columns, bool flat, Value&& value, Sink&& sink) {
  sink(header(kind_of<T>(), flat ? fmt::format("({},)", rows) : fmt::format("({}, {})", rows, columns)));
  constexpr std::size_t block = 1 << 16;  // given to the sink at once
  std::string held;
  for (std::uint64_t i = 0; i < rows * columns; ++i) {
    put_little(static_cast<T>(value(i)), [&](std::string_view bytes) { held += bytes; });
    if (held.size() < block) continue;
    sink(held);
    held.clear();
  }
  sink(held);
}

class Archive {
 public:
  explicit Archive(OutputFile& file) : zip_(file) {}
  template <class T, class Value>
  void add(const char* name, std::uint64_t rows, std::uint64_t columns, Value&& value) {
    zip_.add(fmt::format("{}.npy", name),
             [&](const ZipWriter::Sink& sink) { put_array<T>(rows, columns, false, value, sink); });
  }
  template <class T, class Value>
  void add(const char* name, std::uint64_t rows, Value&& value) {
    zip_.add(fmt::format("{}.npy", name),
             [&](const ZipWriter::Sink& sink) { put_array<T>(rows, 1, true, value, sink); });
  }
  /// A text as an array without dimensions, such as NumPy has for it.
  void add_text(const char* name, const std::string& text) {
    zip_.add(fmt::format("{}.npy", name), [&](const ZipWriter::Sink& sink) {
      sink(header(fmt::format("|S{}", text.size()), "()"));
      sink(text);
    });
  }
  void finish() { zip_.finish(); }

 private:
  ZipWriter zip_;
};

void add_vertices(Archive& archive, const Result& result) {
  const Input& input = result.input;
  const std::uint64_t count = result.vertex_count(), attributes = input.attribute_count;
  archive.add<double>("vertices", count, 2, [&](std::uint64_t i) { return result.vertex(i / 2)[i % 2]; });
  if (attributes > 0)
    archive.add<double>("vertex_attributes", count, attributes,
                        [&](std::uint64_t i) { return result.attribute(i / attributes, i % attributes); });
  if (!input.vertex_markers.empty())
    archive.add<std::int32_t>("vertex_markers", count, 1, [&](std::uint64_t i) { return result.vertex_marker(i); });
}

void add_seeds(Archive& archive, const Input& input) {
  if (!input.holes.empty())
    archive.add<double>("holes", input.holes.size(), 2, [&](std::uint64_t i) { return input.holes[i / 2][i % 2]; });
  if (input.regions.empty()) return;
  archive.add<double>("regions", input.regions.size(), 4, [&](std::uint64_t i) {
    const Input::Region& r = input.regions[i / 4];
    return i % 4 < 2 ? r.point[i % 4] : i % 4 == 2 ? r.attribute : r.largest_area;
  });
}

void add_regions(Archive& archive, const Result& result) {
  const MeshArrays& mesh = result.mesh;
  const std::uint64_t count = mesh.triangles.size();
  archive.add<std::int32_t>("region", count, [&](std::uint64_t i) { return mesh.region[i]; });
  archive.add<std::int32_t>("depth", count, [&](std::uint64_t i) { return mesh.depth[i]; });
  archive.add<std::int32_t>("winding", count, [&](std::uint64_t i) { return mesh.winding[i]; });
  if (!mesh.region_seed.empty() && !result.input.regions.empty())
    archive.add<double>("triangle_attributes", count, 1, [&](std::uint64_t i) { return region_attribute(result, i); });
}

}  // namespace

void write_npz(OutputFile& file, const Result& result) {
  const MeshArrays& mesh = result.mesh;
  const std::uint64_t triangles = mesh.triangles.size();
  Archive archive(file);
  add_vertices(archive, result);
  archive.add<std::int32_t>("triangles", triangles, 3, [&](std::uint64_t i) { return mesh.triangles[i / 3][i % 3]; });
  archive.add<std::int32_t>("neighbors", triangles, 3, [&](std::uint64_t i) { return mesh.neighbours[i / 3][i % 3]; });
  archive.add<std::uint8_t>("constrained", triangles, [&](std::uint64_t i) { return mesh.constrained[i]; });
  archive.add<std::int32_t>("segments", mesh.pieces.size(), 2,
                            [&](std::uint64_t i) { return mesh.pieces[i / 2][i % 2]; });
  const PieceMarkers markers(result);
  archive.add<std::int32_t>("segment_markers", mesh.pieces.size(), 1,
                            [&](std::uint64_t i) { return markers.of_piece(i); });
  if (!mesh.region.empty()) add_regions(archive, result);
  add_seeds(archive, result.input);
  archive.add_text("grid", to_text(mesh.statistics.grid));
  archive.finish();
}

void write_npy(OutputFile& file, const Result& result) {
  const auto& triangles = result.mesh.triangles;
  put_array<std::int32_t>(
      triangles.size(), 3, false, [&](std::uint64_t i) { return triangles[i / 3][i % 3]; },
      [&](std::string_view bytes) { file.write(bytes); });
}

}  // namespace gcdt::io

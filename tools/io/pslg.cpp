// SPDX-License-Identifier: Apache-2.0
// Binary planar straight-line graphs (.pslg): "PSLGBIN1", the numbers of vertices and segments (int64), the vertices
// (two float64 each), the segments (two int32 each), least byte first.
#include <fmt/format.h>

#include "binary_file.hpp"
#include "inputs.hpp"
#include "outputs.hpp"

namespace gcdt::io {

namespace {

constexpr std::string_view magic = "PSLGBIN1";
constexpr std::uint64_t vertex_bytes = 2 * sizeof(double), segment_bytes = 2 * sizeof(std::int32_t);

/// A count that the header announces, each record of so many bytes: no more than the file can hold.
std::uint64_t count(BinaryFile& in, const char* what, std::uint64_t most) {
  const auto value = in.little<std::int64_t>(what);
  if (value < 0) in.fail(fmt::format("{} is negative: {}", what, value));
  if (static_cast<std::uint64_t>(value) > most)
    in.fail(fmt::format("{} is {}; at most {} are possible", what, value, most));
  return static_cast<std::uint64_t>(value);
}

/// Turns numbers as they stand in the file into this machine's.
template <class T>
void turn(T* numbers, std::uint64_t count) {
  if (little_endian()) return;
  for (std::uint64_t i = 0; i < count; ++i) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, numbers + i, sizeof(T));
    numbers[i] = number_at<T>(bytes, true);
  }
}

}  // namespace

Input read_pslg(const std::string& path) {
  BinaryFile in(path);
  char begin[8];
  in.read(begin, sizeof begin, "the word PSLGBIN1");
  if (std::string_view(begin, sizeof begin) != magic) in.fail("the word PSLGBIN1 is missing before this");
  Input input = input_of(path);
  const std::uint64_t vertices = count(in, "the number of vertices", max_vertices);
  const std::uint64_t segments = count(in, "the number of segments", (1ull << 31) - 1);
  const std::uint64_t due = vertices * vertex_bytes + segments * segment_bytes;
  if (in.left() != due)
    in.fail(
        fmt::format("{} vertices and {} segments have {} bytes, but {} follow", vertices, segments, due, in.left()));
  input.vertices.resize(vertices);
  in.read(input.vertices.data(), vertices * vertex_bytes, "the vertices");
  turn(reinterpret_cast<double*>(input.vertices.data()), 2 * vertices);
  static_assert(sizeof(Constraint) == segment_bytes);
  input.constraints.resize(segments);
  in.read(input.constraints.data(), segments * segment_bytes, "the segments");
  turn(reinterpret_cast<std::uint32_t*>(input.constraints.data()), 2 * segments);
  for (std::uint64_t c = 0; c < segments; ++c)
    for (const std::uint32_t v : input.constraints[c])
      if (v >= vertices)
        throw Failure(Exit::input, fmt::format("{}: at byte {}: segment {} names vertex {}, but there are {}", path,
                                               in.size() - (segments - c) * segment_bytes, c,
                                               static_cast<std::int32_t>(v), vertices));
  return input;
}

void write_pslg(OutputFile& file, const Result& result) {
  const auto put = [&](auto number) { put_little(number, [&](std::string_view bytes) { file.write(bytes); }); };
  file.write(magic);
  put(static_cast<std::int64_t>(result.vertex_count()));
  put(static_cast<std::int64_t>(result.mesh.pieces.size()));
  for (std::size_t v = 0; v < result.vertex_count(); ++v)
    for (const double c : result.vertex(v)) put(c);
  for (const auto& piece : result.mesh.pieces)
    for (const std::uint32_t v : piece) put(static_cast<std::int32_t>(v));
}

}  // namespace gcdt::io

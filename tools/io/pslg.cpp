// SPDX-License-Identifier: Apache-2.0
#include "pslg.hpp"

#include <fmt/format.h>

#include "inputs.hpp"
#include "outputs.hpp"

namespace gcdt::io {

namespace {

constexpr std::string_view pslg_magic = "PSLGBIN1";
constexpr std::uint64_t head_bytes = 24, vertex_bytes = 2 * sizeof(double), segment_bytes = 2 * sizeof(std::int32_t);

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

PslgFile::PslgFile(const std::string& path) : file_(path) {
  char begin[8];
  file_.read(begin, sizeof begin, "the word PSLGBIN1");
  if (std::string_view(begin, sizeof begin) != pslg_magic) file_.fail("the word PSLGBIN1 is missing before this");
  vertices_ = count(file_, "the number of vertices", max_vertices);
  segments_ = count(file_, "the number of segments", (1ull << 31) - 1);
  const std::uint64_t due = vertices_ * vertex_bytes + segments_ * segment_bytes;
  if (file_.left() != due)
    file_.fail(fmt::format("{} vertices and {} segments have {} bytes, but {} follow", vertices_, segments_, due,
                           file_.left()));
}

void PslgFile::read_vertices(std::uint64_t first, std::uint64_t count, std::array<double, 2>* to) {
  file_.seek(head_bytes + first * vertex_bytes);
  file_.read(to, count * vertex_bytes, "the vertices");
  turn(reinterpret_cast<double*>(to), 2 * count);
}

void PslgFile::read_segments(std::uint64_t first, std::uint64_t count, Constraint* to) {
  static_assert(sizeof(Constraint) == segment_bytes);
  file_.seek(place_of_segment(first));
  file_.read(to, count * segment_bytes, "the segments");
  turn(reinterpret_cast<std::uint32_t*>(to), 2 * count);
}

std::uint64_t PslgFile::place_of_segment(std::uint64_t number) const {
  return head_bytes + vertices_ * vertex_bytes + number * segment_bytes;
}

Input read_pslg(const std::string& path) {
  PslgFile in(path);
  Input input = input_of(path);
  input.vertices.resize(in.vertices());
  in.read_vertices(0, in.vertices(), input.vertices.data());
  input.constraints.resize(in.segments());
  in.read_segments(0, in.segments(), input.constraints.data());
  for (std::uint64_t c = 0; c < in.segments(); ++c)
    for (const std::uint32_t v : input.constraints[c])
      if (v >= in.vertices())
        throw Failure(Exit::input, fmt::format("{}: at byte {}: segment {} names vertex {}, but there are {}", path,
                                               in.place_of_segment(c), c, static_cast<std::int32_t>(v), in.vertices()));
  return input;
}

void write_pslg(OutputFile& file, const Result& result) {
  const auto put = [&](auto number) { put_little(number, [&](std::string_view bytes) { file.write(bytes); }); };
  file.write(pslg_magic);
  put(static_cast<std::int64_t>(result.vertex_count()));
  put(static_cast<std::int64_t>(result.mesh.pieces.size()));
  for (std::size_t v = 0; v < result.vertex_count(); ++v)
    for (const double c : result.vertex(v)) put(c);
  for (const auto& piece : result.mesh.pieces)
    for (const std::uint32_t v : piece) put(static_cast<std::int32_t>(v));
}

}  // namespace gcdt::io

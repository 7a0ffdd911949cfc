// SPDX-License-Identifier: Apache-2.0
// Text files of vertices and what joins them: CDT's .txt, and .obj and .off, whose faces give their edges.
#include <fmt/format.h>

#include <charconv>

#include "inputs.hpp"
#include "surface.hpp"

namespace gcdt::io {

namespace {

constexpr std::uint64_t most = (1ull << 31) - 1;

/// The shortest record of such files, "0 0" and its line end: a vertex without its number.
constexpr std::size_t shortest_bare_record = 4;

std::uint32_t vertex_number(Records& in, const Input& input) {
  const std::int64_t number = in.integer("a vertex number");
  if (number < 0 || static_cast<std::uint64_t>(number) >= input.vertices.size())
    in.fail(fmt::format("there is no vertex {}; there are {}, from 0 on", in.field(), input.vertices.size()));
  return static_cast<std::uint32_t>(number);
}

/// The corner of a face of an .obj file: "7", "7/1", "7//2", "-1": from 1 on, or from the last one backwards.
std::uint32_t corner(Records& in, const Input& input) {
  const std::string_view word = in.word("a corner");
  const std::string_view digits = word.substr(0, word.find('/'));
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const auto count = static_cast<std::int64_t>(input.vertices.size());
  if (error != std::errc() || end != digits.data() + digits.size())
    in.fail(fmt::format("a corner must be a number, not \"{}\"", in.field()));
  const std::int64_t index = number < 0 ? count + number : number - 1;
  if (number == 0 || index < 0 || index >= count)
    in.fail(fmt::format("there is no vertex {}; there are {} before this line", in.field(), count));
  return static_cast<std::uint32_t>(index);
}

/// The first word of an .off file. What ST (texture), C (colour) and N (normal) before OFF announce follows the
/// coordinates of each vertex, and is passed over. 4 and n announce points of another dimension.
void expect_off(Records& in) {
  constexpr std::string_view off = "OFF";
  if (!in.next()) in.fail("the word OFF is missing");
  std::string_view kind = in.word("the word OFF");
  if (kind.size() < off.size() || kind.substr(kind.size() - off.size()) != off) in.fail("the word OFF is missing");
  kind.remove_suffix(off.size());
  for (const std::string_view passed_over : {"ST", "C", "N"})
    if (kind.substr(0, passed_over.size()) == passed_over) kind.remove_prefix(passed_over.size());
  if (kind == "4" || kind == "n" || kind == "4n")
    in.fail(fmt::format("{} has points of another dimension than 3, which are not read", in.field()));
  if (!kind.empty()) in.fail(fmt::format("the word OFF is due, not {}", in.field()));
}

}  // namespace

Input read_cdt_text(const std::string& path) {
  Input input = input_of(path);
  Records in(path);
  if (!in.next()) in.fail("the numbers of vertices and edges are missing");
  const std::uint64_t vertices = in.count("the number of vertices", max_vertices);
  const std::uint64_t edges = in.more() ? in.count("the number of edges", most) : 0;
  in.skip_numbers("the header");
  input.vertices.reserve(in.reservation(vertices, shortest_bare_record));
  for (std::uint64_t i = 0; i < vertices; ++i) {
    in.expect("vertices", i, vertices);
    const double x = in.coordinate("x coordinate");
    const double y = in.coordinate("y coordinate");
    in.skip_numbers("a coordinate");
    input.vertices.push_back({x, y});
    input.vertex_lines.append(in.line());
  }
  input.constraints.reserve(in.reservation(edges, shortest_bare_record));
  for (std::uint64_t i = 0; i < edges; ++i) {
    in.expect("edges", i, edges);
    const std::uint32_t a = vertex_number(in, input);
    const std::uint32_t b = vertex_number(in, input);
    in.skip_numbers("an edge");
    input.constraints.push_back({a, b});
    input.constraint_lines.append(in.line());
  }
  if (in.next()) in.fail("more text than the counts announce");
  return input;
}

Input read_obj(const std::string& path) {
  Input input = input_of(path);
  input.first = input.first_constraint = 1;
  Heights heights;
  Records in(path);
  std::vector<std::uint32_t> corners;
  while (in.next()) {
    const std::string_view kind = in.word("a word");
    if (kind == "v") {
      if (input.vertices.size() == max_vertices) in.fail("too many vertices");
      const double x = in.coordinate("x coordinate");
      const double y = in.coordinate("y coordinate");
      heights.add(in.more() ? in.coordinate("z coordinate") : 0);
      in.skip_numbers("a coordinate");
      input.vertices.push_back({x, y});
      input.vertex_lines.append(in.line());
    } else if (kind == "f" || kind == "l") {
      const bool face = kind == "f";
      corners.clear();
      while (in.more()) corners.push_back(corner(in, input));
      if (corners.size() < (face ? 3 : 2))
        in.fail(face ? "a face has at least 3 corners" : "a line has at least 2 ends");
      join(corners, face, in.line(), input);
    }
  }
  heights.give(input);
  return input;
}

Input read_off(const std::string& path) {
  Input input = input_of(path);
  Heights heights;
  Records in(path);
  expect_off(in);
  if (!in.more() && !in.next()) in.fail("the number of vertices is missing");
  const std::uint64_t vertices = in.count("the number of vertices", max_vertices);
  const std::uint64_t faces = in.count("the number of faces", most);
  in.skip_numbers("the header");
  input.vertices.reserve(in.reservation(vertices, shortest_bare_record));
  for (std::uint64_t i = 0; i < vertices; ++i) {
    in.expect("vertices", i, vertices);
    const double x = in.coordinate("x coordinate");
    const double y = in.coordinate("y coordinate");
    heights.add(in.coordinate("z coordinate"));
    in.skip_numbers("a normal, colour or texture coordinate");
    input.vertices.push_back({x, y});
    input.vertex_lines.append(in.line());
  }
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < faces; ++i) {
    in.expect("faces", i, faces);
    corners.clear();
    for (std::uint64_t k = in.count("the number of corners", vertices); k > 0; --k)
      corners.push_back(vertex_number(in, input));
    in.skip_numbers("a colour");
    join(corners, corners.size() > 2, in.line(), input);
  }
  if (in.next()) in.fail("more text than the counts announce");
  heights.give(input);
  return input;
}

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
#include "triangle_switches.hpp"

#include <fmt/format.h>

#include <fast_float/fast_float.h>
#include <algorithm>
#include <filesystem>
#include <set>

#include "io/failure.hpp"
#include "io/paths.hpp"

namespace gcdt::command {

namespace {

using io::Exit;
using io::Failure;

/// The switches one by one, each with the number behind it, if any.
class Switches {
 public:
  explicit Switches(const std::string& text) : text_(text) {
    const char *at = text.data(), *const end = at + text.size();
    while (at != end) {
      const char letter = *at++;
      if (letter == '-' || letter == ' ') continue;
      const bool counted = letter == 'q' || letter == 'a' || letter == 'S' || letter == 'l' || letter == 'V';
      std::optional<double> number;
      if (counted && at != end && ((*at >= '0' && *at <= '9') || *at == '.')) {
        double value = 0;
        const auto [after, error] = fast_float::from_chars(at, end, value, fast_float::chars_format::fixed);
        if (error != std::errc()) refuse(fmt::format("what follows {} is no number", letter));
        number = value;
        at = after;
      }
      take(letter, number);
    }
  }

  bool has(char letter) const { return letters_.count(letter) > 0; }
  unsigned count(char letter) const { return static_cast<unsigned>(letters_.count(letter)); }
  std::optional<double> angle, area, most;

  [[noreturn]] void refuse(const std::string& why) const {
    throw Failure(Exit::usage, fmt::format("--triangle {}: {}", text_, why));
  }

 private:
  void take(char letter, std::optional<double> number) {
    static const std::string known = "pqaADYSenjczQ";
    // How Triangle computes, what it prints, and which files it leaves out.
    static const std::string accepted = "VCXiFlINEP";
    if (known.find(letter) == std::string::npos && accepted.find(letter) == std::string::npos)
      refuse(fmt::format("switch {} is not known, or not supported", letter));
    letters_.insert(letter);
    if (letter == 'q') angle = number.value_or(20);
    if (letter == 'a' && number) area = number;
    if (letter == 'a' && !number) letters_.insert('b');  // areas of regions
    if (letter == 'S') most = number.value_or(0);
  }

  const std::string text_;
  std::multiset<char> letters_;
};

/// As Triangle names its outputs: box.poly, box.1.ele, box.2.ele.
std::string next_iteration(const std::string& input, bool without) {
  std::filesystem::path path = std::filesystem::path(input).replace_extension();
  if (without) return path.string();
  unsigned number = 0;
  const std::string last = path.extension().string();
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (last.size() > 1 && last.size() < 9 && std::all_of(last.begin() + 1, last.end(), is_digit)) {
    number = static_cast<unsigned>(std::stoul(last.substr(1)));
    path.replace_extension();
  }
  return fmt::format("{}.{}", path.string(), number + 1);
}

void set_outputs(TriangulateArguments& arguments, const Switches& s) {
  if (!arguments.outputs.empty()) return;
  if (arguments.input == "-") s.refuse("standard input has no name for outputs: say -o");
  const std::string name = next_iteration(arguments.input, s.has('I'));
  if (!s.has('N')) arguments.outputs.push_back(name + ".node");
  if (!s.has('E')) arguments.outputs.push_back(name + ".ele");
  if ((s.has('p') || s.has('c')) && !s.has('P')) arguments.outputs.push_back(name + ".poly");
  if (s.has('e')) arguments.outputs.push_back(name + ".edge");
  if (s.has('n')) arguments.outputs.push_back(name + ".neigh");
}

}  // namespace

void apply_triangle_switches(TriangulateArguments& arguments) {
  if (!arguments.triangle) return;
  const Switches s(*arguments.triangle);
  const bool is_poly = arguments.input == "-" || io::lower_extension(arguments.input) == ".poly";
  if (s.has('p') != is_poly)
    s.refuse(is_poly ? "without p Triangle reads vertices alone: name the .node file" : "p reads a .poly file");
  // Segments that cross become vertices there, too.
  if (s.has('p')) arguments.crossing = "split";
  if (s.has('p')) arguments.domain = s.has('c') ? "holes" : "outer-holes";
  arguments.regions = s.has('A');
  arguments.quiet = arguments.quiet || s.has('Q');
  arguments.jettison = s.has('j');
  RefineArguments& refine = arguments.refine;
  if (s.has('q') || s.has('a') || s.has('D')) {
    refine.angle = s.angle.value_or(0);
    refine.most_area = s.area;
    refine.region_areas = s.has('b');
    refine.conforming = s.has('D');
    refine.no_border_split = s.count('Y') == 1;
    refine.no_split = s.count('Y') > 1;
    if (s.most) refine.most_added = static_cast<std::int64_t>(std::min(*s.most, 1e15));
    if (*refine.angle > 34) s.refuse("angles above 34 degrees are out of reach");
  }
  set_outputs(arguments, s);
}

std::pair<io::Input, Triangulation> jettisoned(const io::Result& result) {
  constexpr std::uint32_t none = UINT32_MAX;
  std::vector<std::uint32_t> number(result.vertex_count(), none);
  for (const auto& corners : result.mesh.triangles)
    for (const std::uint32_t v : corners) number[v] = 0;
  io::Input input = result.input;
  Triangulation mesh;
  mesh.statistics = result.mesh.statistics;
#define GCDT_ARRAY(number, name, ...) mesh.name.assign(result.mesh.name.begin(), result.mesh.name.end());
#include <gcdt/arrays.def>
  input.vertices.clear(), input.attributes.clear(), input.vertex_markers.clear();
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == none) continue;
    number[v] = static_cast<std::uint32_t>(input.vertices.size());
    input.vertices.push_back(result.vertex(v));
    for (std::uint32_t k = 0; k < input.attribute_count; ++k) input.attributes.push_back(result.attribute(v, k));
    if (!result.input.vertex_markers.empty()) input.vertex_markers.push_back(result.vertex_marker(v));
  }
  for (auto& corners : mesh.triangles)
    for (std::uint32_t& v : corners) v = number[v];
  mesh.pieces.clear(), mesh.sources.clear(), mesh.source_offsets.assign(1, 0);
  for (std::size_t i = 0; i < result.mesh.pieces.size(); ++i) {
    const auto& [a, b] = result.mesh.pieces[i];
    if (number[a] == none || number[b] == none) continue;
    mesh.pieces.push_back({number[a], number[b]});
    const auto* const sources = result.mesh.sources.data();
    mesh.sources.insert(mesh.sources.end(), sources + result.mesh.source_offsets[i],
                        sources + result.mesh.source_offsets[i + 1]);
    mesh.source_offsets.push_back(static_cast<std::uint32_t>(mesh.sources.size()));
  }
  mesh.added.clear(), mesh.added_on_grid.clear(), mesh.added_crossing.clear(), mesh.added_origin.clear();
  return {std::move(input), std::move(mesh)};
}

}  // namespace gcdt::command

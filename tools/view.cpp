// SPDX-License-Identifier: Apache-2.0
// gcdt view: a page that shows a mesh in a browser.
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "io/base64.hpp"
#include "io/binary_file.hpp"
#include "io/mesh_input.hpp"
#include "io/output_files.hpp"
#include "io/paths.hpp"
#include "progress.hpp"
#include "solved.hpp"

// tools/view/page.html
extern const unsigned char gcdt_view_page[];
extern const std::size_t gcdt_view_page_size;

namespace gcdt::command {

namespace {

using io::Exit;
using io::Failure;

/// What is shown, wherever it comes from.
struct Shown {
  io::Input input;
  std::vector<std::array<double, 2>> vertices;
  std::vector<std::vector<double>> attributes;  ///< of all vertices
  Triangulation mesh;                           ///< without added vertices; arrays that are not known are empty
};

Shown from_file(const MeshArguments& arguments) {
  check_mesh_options(arguments);
  io::MeshInput read = io::read_mesh_input(arguments.input);
  Shown shown;
  shown.input = std::move(read.input);
  shown.vertices = shown.input.vertices;
  for (std::uint32_t k = 0; k < shown.input.attribute_count; ++k)
    shown.attributes.push_back(io::attribute_of(shown.input, k));
  const auto copy = [](const auto& from, auto& to) { to.assign(from.begin(), from.end()); };
  copy(read.mesh.triangles, shown.mesh.triangles);
  copy(read.mesh.constrained, shown.mesh.constrained);
  copy(read.mesh.region, shown.mesh.region);
  copy(read.mesh.depth, shown.mesh.depth);
  copy(read.mesh.winding, shown.mesh.winding);
  return shown;
}

Shown from_input(const MeshArguments& arguments) {
  Solved made = solved(arguments, true);
  Shown shown;
  shown.mesh = made.result->download();
  shown.vertices = made.input.vertices;
  shown.vertices.insert(shown.vertices.end(), shown.mesh.added.begin(), shown.mesh.added.end());
  for (std::uint32_t k = 0; k < made.input.attribute_count; ++k) shown.attributes.push_back(made.attribute(k));
  shown.input = std::move(made.input);
  return shown;
}

/// Text between tags.
std::string escaped(const std::string& text) {
  std::string all;
  for (const char c : text)
    all += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  return all;
}

/// JSON that ends no element, whatever its texts are.
std::string json_in_page(const nlohmann::ordered_json& json) {
  const std::string text = json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  std::string all;
  for (const char c : text)
    all += c == '<' ? "\\u003c" : c == '>' ? "\\u003e" : c == '&' ? "\\u0026" : std::string(1, c);
  return all;
}

/// Numbers, least byte first, packed by zlib, in base64.
class PackedArray {
 public:
  PackedArray(io::OutputFile& file, const std::string& name) : file_(file), base64_(file) {
    constexpr int level = 4;  // a tenth larger than the best, in a third of the time
    if (deflateInit(&stream_, level) != Z_OK) throw std::bad_alloc();
    file_.print("<script type=\"text/plain\" id=\"data-{}\">", name);
  }
  ~PackedArray() { deflateEnd(&stream_); }
  PackedArray(const PackedArray&) = delete;
  PackedArray& operator=(const PackedArray&) = delete;

  template <class T>
  void put(T number) {
    io::put_little(number, [&](std::string_view bytes) { held_ += bytes; });
    if (held_.size() >= block) pack(Z_NO_FLUSH);
  }
  void finish() {
    pack(Z_FINISH);
    base64_.finish();
    file_.print("</script>\n");
  }

 private:
  static constexpr std::size_t block = 1 << 16;
  void pack(int flush) {
    unsigned char out[block];
    stream_.next_in = reinterpret_cast<Bytef*>(held_.data());
    stream_.avail_in = static_cast<uInt>(held_.size());
    do {
      stream_.next_out = out;
      stream_.avail_out = block;
      deflate(&stream_, flush);
      base64_.put(out, block - stream_.avail_out);
    } while (stream_.avail_out == 0);
    held_.clear();
  }

  io::OutputFile& file_;
  io::Base64Writer<io::OutputFile> base64_;
  z_stream stream_{};
  std::string held_;
};

/// Rows of numbers, or numbers.
template <class Rows>
void write_array(io::OutputFile& file, const std::string& name, const Rows& rows) {
  if (rows.empty()) return;
  PackedArray array(file, name);
  for (const auto& row : rows)
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(row)>>)
      array.put(row);
    else
      for (const auto number : row) array.put(number);
  array.finish();
}

void write_data(io::OutputFile& file, const Shown& shown) {
  write_array(file, "places", shown.vertices);
  write_array(file, "triangles", shown.mesh.triangles);
  write_array(file, "constrained", shown.mesh.constrained);
  write_array(file, "region", shown.mesh.region);
  write_array(file, "depth", shown.mesh.depth);
  write_array(file, "winding", shown.mesh.winding);
  write_array(file, "pieces", shown.mesh.pieces);
  write_array(file, "offsets", shown.mesh.source_offsets);
  write_array(file, "sources", shown.mesh.sources);
  for (std::size_t k = 0; k < shown.attributes.size(); ++k)
    write_array(file, fmt::format("attribute{}", k), shown.attributes[k]);
}

void write_page(io::OutputFile& file, const Shown& shown, const std::string& title) {
  const nlohmann::ordered_json meta = {{"title", title},
                                       {"vertices", shown.vertices.size()},
                                       {"triangles", shown.mesh.triangles.size()},
                                       {"attributes", shown.attributes.size()},
                                       {"first", shown.input.first},
                                       {"firstConstraint", shown.input.first_constraint}};
  std::string_view page(reinterpret_cast<const char*>(gcdt_view_page), gcdt_view_page_size);
  const auto fill = [&](std::string_view mark, auto&& write) {
    const std::size_t at = page.find(mark);
    file.write(page.substr(0, at));
    write();
    page.remove_prefix(at + mark.size());
  };
  fill("@TITLE@", [&] { file.write(escaped(title)); });
  fill("@META@", [&] { file.write(json_in_page(meta)); });
  fill("@DATA@", [&] { write_data(file, shown); });
  file.write(page);
}

}  // namespace

void view(const ViewArguments& arguments) {
  if (const std::string extension = io::lower_extension(arguments.output); extension != ".html" && extension != ".htm")
    throw Failure(Exit::usage, fmt::format("{}: the page must be a .html file", arguments.output));
  const std::string& input = arguments.mesh.input;
  const auto check_overwrites = [&](const std::vector<std::string>& inputs) {
    for (const std::string& path : inputs)
      if (path != "-" && io::same_file(arguments.output, path))
        throw Failure(Exit::usage, fmt::format("{}: is an input, and cannot be an output", arguments.output));
  };
  check_overwrites({input});
  const Shown shown = input != "-" && io::holds_mesh(input) ? from_file(arguments.mesh) : from_input(arguments.mesh);
  check_overwrites(shown.input.files);
  stop_if_interrupted();
  const std::string name = input == "-" ? "gcdt" : std::filesystem::path(input).filename().string();
  io::OutputFiles files(stop_if_interrupted);
  write_page(files.add(arguments.output), shown, arguments.title.empty() ? name : arguments.title);
  files.commit();
}

}  // namespace gcdt::command

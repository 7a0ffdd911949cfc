// SPDX-License-Identifier: Apache-2.0
// The command's parsers, one at a time: GCDT_FUZZ_FORMAT says which. What they make of any bytes is an input that is
// consistent, or a Failure with the status for invalid input; nothing else is thrown.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include <unistd.h>

#include "io/geojson.hpp"
#include "io/grid_text.hpp"
#include "io/inputs.hpp"
#include "io/npz.hpp"
#include "io/vtu.hpp"

namespace {

using namespace gcdt;
using io::Failure;
namespace fs = std::filesystem;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "parse_fuzz: %s\n", what);
  std::abort();
}

/// What the members of io::Input promise each other.
void check(const io::Input& input) {
  const std::size_t n = input.vertices.size(), m = input.constraints.size();
  for (const auto& [a, b] : input.constraints) require(a < n && b < n, "a constraint names no vertex");
  require(input.attributes.size() == n * input.attribute_count, "attributes and vertices do not go together");
  require(!input.heights || input.attribute_count > 0, "heights without attributes");
  require(input.vertex_markers.empty() || input.vertex_markers.size() == n, "vertex markers");
  require(input.constraint_markers.empty() || input.constraint_markers.size() == m, "constraint markers");
  require(input.first <= 1 && input.first_constraint <= 1, "the first number");
  require(!input.files.empty(), "no file was read");
}

/// What the members of io::MeshFile promise each other, over n vertices.
void check(const io::MeshFile& mesh, std::size_t n) {
  const std::size_t count = mesh.triangles.size();
  for (const auto& corners : mesh.triangles)
    for (const std::uint32_t v : corners) require(v < n, "a triangle names no vertex");
  require(mesh.neighbours.empty() || mesh.neighbours.size() == count, "neighbours");
  for (const auto& across : mesh.neighbours)
    for (const std::int32_t t : across)
      require(t >= -1 && t < static_cast<std::int64_t>(count), "a neighbour that is none");
  require(mesh.constrained.empty() || mesh.constrained.size() == count, "constrained");
  require(mesh.region.empty() || mesh.region.size() == count, "region");
  require(mesh.depth.empty() || mesh.depth.size() == count, "depth");
  require(mesh.winding.empty() || mesh.winding.size() == count, "winding");
  require(mesh.attributes.size() == mesh.vertices.size() * mesh.attribute_count, "attributes of a mesh");
}

/// A folder in memory for the files that the parsers open; gone when the process ends.
class Folder {
 public:
  Folder() {
    const char* shared = "/dev/shm";
    std::string name = (fs::exists(shared) ? fs::path(shared) : fs::temp_directory_path()) / "gcdt-fuzz-XXXXXX";
    require(mkdtemp(name.data()) != nullptr, "no folder for files");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string file(const std::string& name, const std::uint8_t* data, std::size_t size) const {
    const std::string path = path_ / name;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    require(file && std::fwrite(data, 1, size, file) == size && std::fclose(file) == 0, "a file is not written");
    return path;
  }

 private:
  fs::path path_;
};

using Parse = std::function<void(const Folder&, const std::uint8_t*, std::size_t)>;

void parse_lines(const Folder& folder, const std::uint8_t* data, std::size_t size) {
  const std::string path = folder.file("x.geojsonl", data, size);
  for (const io::TextLine& line : io::lines_of(path)) {
    try {
      check(io::read_geojson_line(path, line));
    } catch (const Failure& failure) {
      require(failure.exit() == io::Exit::input, "a status that is not of input");
    }
  }
}

/// The .ele goes up to the first byte 0, and a .neigh follows it.
void parse_mesh(const Folder& folder, const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t vertices = 6;
  const std::size_t split = static_cast<std::size_t>(std::find(data, data + size, 0) - data);
  const std::string ele = folder.file("x.ele", data, split);
  if (split == size) return check(io::read_mesh(ele, vertices, 0), vertices);
  check(io::read_mesh(folder.file("x.neigh", data + split + 1, size - split - 1), vertices, 0), vertices);
}

/// The text of a grid is read back as it was written.
void parse_grid(const Folder&, const std::uint8_t* data, std::size_t size) {
  const auto grid = io::grid_from_text(std::string(data, data + size));
  if (!grid) return;
  const auto again = io::grid_from_text(io::to_text(*grid));
  require(again && io::to_text(*again) == io::to_text(*grid), "a grid that is not read back");
}

const std::map<std::string, Parse>& parsers() {
  static const std::map<std::string, Parse> all = [] {
    std::map<std::string, Parse> map = {
        {"geojsonl", parse_lines},
        {"ele", parse_mesh},
        {"grid", parse_grid},
        {"vtu",
         [](const Folder& folder, const std::uint8_t* data, std::size_t size) {
           const io::MeshFile mesh = io::read_vtu(folder.file("x.vtu", data, size));
           check(mesh, mesh.vertices.size());
         }},
        {"npz-mesh", [](const Folder& folder, const std::uint8_t* data, std::size_t size) {
           const io::MeshInput read = io::read_npz_mesh(folder.file("x.npz", data, size));
           check(read.input);
           check(read.mesh, read.input.vertices.size());
         }}};
    for (const io::InputFormat& format : io::input_formats()) {
      if (format.read == io::read_with_gdal) continue;
      const std::string extension = format.extension;
      map[extension.substr(1)] = [=](const Folder& folder, const std::uint8_t* data, std::size_t size) {
        check(format.read(folder.file("x" + extension, data, size)));
      };
    }
    return map;
  }();
  return all;
}

const Parse& chosen() {
  const char* name = std::getenv("GCDT_FUZZ_FORMAT");
  const auto found = parsers().find(name ? name : "");
  if (found != parsers().end()) return found->second;
  std::fprintf(stderr, "parse_fuzz: GCDT_FUZZ_FORMAT must be one of");
  for (const auto& [format, parse] : parsers()) std::fprintf(stderr, " %s", format.c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Parse& parse = chosen();
  static const Folder folder;
  try {
    parse(folder, data, size);
  } catch (const Failure& failure) {
    // A number that a mesh names and that does not exist makes it a mesh that is not valid.
    require(failure.exit() == io::Exit::input || failure.exit() == io::Exit::check, "a status that is not of input");
  }
  return 0;
}

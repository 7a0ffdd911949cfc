// SPDX-License-Identifier: Apache-2.0
// Files of mesh viewers: vtu, which is read, too, with its base64, and svg.
#include "format_cases.hpp"
#include "io/base64.hpp"

using namespace gcdt;
using namespace gcdt::testing;

TEST_CASE("base64 decodes to what was encoded, at every length") {
  struct Sink {
    std::string text;
    void write(std::string_view part) { text += part; }
  };
  for (std::size_t size : {0, 1, 2, 3, 4, 5, 3071, 3072, 3073, 10000}) {
    std::string bytes(size, '\0'), back;
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 37 + i / 256);
    Sink sink;
    io::Base64Writer<Sink> writer(sink);
    writer.put(bytes.data(), size / 2);
    writer.put(bytes.data() + size / 2, size - size / 2);
    writer.finish();
    CHECK(sink.text.size() == (size + 2) / 3 * 4);
    CHECK(io::decode_base64(sink.text, back));
    CHECK(back == bytes);
  }
  std::string back;
  CHECK(io::decode_base64("Z2 Nk\ndA==", back));
  CHECK(back == "gcdt");
  for (const char* bad : {"Z", "Zg==Zg==", "Z!==", "Zg===", "ZgA=B"}) CHECK(!io::decode_base64(bad, back));
}

TEST_CASE("a vtu file that is malformed is refused with its line, and a wrong number in it is a failed check") {
  ScratchFolder folder;
  auto vtu = [](const std::string& connectivity, const std::string& neighbours) {
    return "<VTKFile type=\"UnstructuredGrid\">\n<UnstructuredGrid><Piece NumberOfPoints=\"3\" NumberOfCells=\"1\">\n"
           "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 "
           "0</DataArray></Points>\n"
           "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" +
           connectivity +
           "</DataArray>\n"
           "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray>\n"
           "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5</DataArray></Cells>\n"
           "<CellData><DataArray type=\"Int32\" Name=\"neighbours\" format=\"ascii\">" +
           neighbours +
           "</DataArray></CellData>\n"
           "</Piece></UnstructuredGrid></VTKFile>\n";
  };
  auto read = [&](const std::string& text) { return io::read_vtu(folder.write("o.vtu", text)); };
  auto failed = [&](Exit exit, const std::string& text) {
    return failure(folder / "o.vtu", exit, [&] { read(text); });
  };
  CHECK(read(vtu("0 1 2", "-1 -1 -1")).triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}});
  CHECK(failed(Exit::check, vtu("0 1 3", "-1 -1 -1")) == "4: triangle 0 names point 3, which does not exist");
  CHECK(failed(Exit::check, vtu("0 1 2", "-1 -1 1")) == "7: triangle 0 names neighbour 1, which does not exist");
  CHECK(failed(Exit::input, vtu("0 1 x", "-1 -1 -1")) == "4: an array holds something that is not a number");
  CHECK(failed(Exit::input, vtu("0 1", "-1 -1 -1")).substr(0, 2) == "4:");
  CHECK(failed(Exit::input, "<VTKFile>\n<Unstruct").substr(0, 2) == "2:");
  CHECK(failed(Exit::input, "").substr(0, 2) == "1:");
  CHECK(failed(Exit::input, "<VTKFile type=\"PolyData\"/>").substr(0, 2) == "1:");
  const std::string good = written(folder, "g.vtu", Square());
  for (std::size_t size = 0; size < good.size(); size += 61) CHECK(!failed(Exit::input, good.substr(0, size)).empty());
  std::string broken = good;
  broken.replace(broken.find("Name=\"types\""), 12, "Name=\"typos\"");
  CHECK(!failed(Exit::input, broken).empty());
}

namespace {

/// Ends of all segments drawn by the path data of an svg file, in canvas units.
std::vector<std::array<long, 4>> drawn(const std::string& svg) {
  std::vector<std::array<long, 4>> segments;
  for (std::size_t at = svg.find(" d=\""); at != std::string::npos; at = svg.find(" d=\"", at + 1)) {
    const char* p = svg.c_str() + at + 4;
    long x = 0, y = 0;
    while (*p != '"') {
      char* end;
      if (*p == 'M') {
        x = std::strtol(p + 1, &end, 10);
        y = std::strtol(end, &end, 10);
      } else if (*p == '\n' || *p == 'l') {
        end = const_cast<char*>(p) + 1;
      } else if (*p == 'h') {  // a dot
        std::strtol(p + 1, &end, 10);
      } else {
        const long dx = std::strtol(p, &end, 10), dy = std::strtol(end, &end, 10);
        segments.push_back({x, y, x + dx, y + dy});
        x += dx;
        y += dy;
      }
      REQUIRE(end != p);
      p = end;
    }
  }
  return segments;
}

}  // namespace

TEST_CASE("an svg file draws every edge once, with y up") {
  ScratchFolder folder;
  const std::string svg = written(folder, "o.svg", Square());
  auto segments = drawn(svg);
  CHECK(segments.size() == 5);
  for (auto& s : segments)
    if (std::array<long, 2>{s[2], s[3]} < std::array<long, 2>{s[0], s[1]}) s = {s[2], s[3], s[0], s[1]};
  std::sort(segments.begin(), segments.end());
  const long e = 100000;
  // Vertex (0, 0) is at the lower left of the canvas, which is (0, e).
  CHECK(segments ==
        std::vector<std::array<long, 4>>{{0, 0, 0, e}, {0, 0, e, 0}, {0, e, e, 0}, {0, e, e, e}, {e, 0, e, e}});
  CHECK(svg.find("viewBox=\"-2000 -2000 104000 107000\"") != std::string::npos);
}

TEST_CASE("an svg file of an empty result is a picture all the same") {
  ScratchFolder folder;
  io::Input input;
  Triangulation mesh;
  CHECK(written(folder, "none.svg", input, mesh).find("</svg>") != std::string::npos);
  input.vertices = {{1, 1}};
  CHECK(written(folder, "one.svg", input, mesh).find("M0 0h0") != std::string::npos);
  input.vertices = {{-1.7976931348623157e308, 5}, {1.7976931348623157e308, 5}};
  mesh.pieces = {{0, 1}};
  CHECK(drawn(written(folder, "line.svg", input, mesh)).front() == std::array<long, 4>{0, 0, 100000, 0});
}

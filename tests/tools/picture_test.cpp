// SPDX-License-Identifier: Apache-2.0
// Pictures: where what has which colour, however many edges there are.
#include <png.h>

#include <cmath>

#include "format_cases.hpp"
#include "io/shade.hpp"

using namespace gcdt;
using namespace gcdt::testing;

namespace {

/// A picture as libpng reads it.
struct Picture {
  int width = 0, height = 0;
  std::vector<png_byte> bytes;

  explicit Picture(const std::string& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_file(&image, path.c_str()));
    image.format = PNG_FORMAT_RGB;
    bytes.resize(PNG_IMAGE_SIZE(image));
    width = static_cast<int>(image.width);
    height = static_cast<int>(image.height);
    REQUIRE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr));
  }
  std::array<int, 3> at(double x, double y) const {
    const auto i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    return {bytes[i], bytes[i + 1], bytes[i + 2]};
  }
  bool dark(double x, double y) const {
    const auto rgb = at(x, y);
    return rgb[0] + rgb[1] + rgb[2] < 200;
  }
};

constexpr std::array<int, 3> white{255, 255, 255};
constexpr double margin = 40, side = 2000;  // in pixels

}  // namespace

TEST_CASE("a picture has the constraints dark, other edges lighter, regions in colours and the rest white") {
  ScratchFolder folder;
  Square square;
  written(folder, "plain.png", square);
  const Picture plain(folder / "plain.png");
  CHECK(plain.width == side + 2 * margin);
  CHECK(plain.height > plain.width);
  CHECK(plain.at(5, 5) == white);
  CHECK(plain.at(margin + side / 4, margin + side / 4) == white);
  CHECK(plain.dark(margin + side / 2, margin + side / 2));
  const auto edge = plain.at(margin + side / 3, margin);  // of the hull, no constraint
  CHECK(edge != white);
  CHECK(!plain.dark(margin + side / 3, margin));
  CHECK(plain.dark(margin + 50, side + 2 * margin + 10));  // the bar

  square.mesh.region = {0, 1};
  written(folder, "regions.png", square);
  const Picture regions(folder / "regions.png");
  const auto upper = regions.at(margin + side / 4, margin + side / 4),
             lower = regions.at(margin + side * .75, side * .75);
  CHECK(upper == std::array<int, 3>{0xf6, 0xe2, 0xb3});
  CHECK(lower == std::array<int, 3>{0xcf, 0xe3, 0xc8});
}

TEST_CASE("the bar below a picture is as long as its number says") {
  ScratchFolder folder;
  Square square;  // of 7 units, of which the bar may take a fourth: 1
  for (auto& vertex : square.input.vertices)
    for (double& coordinate : vertex) coordinate *= 7;
  written(folder, "bar.png", square);
  const Picture picture(folder / "bar.png");
  const double y = side + 2 * margin + 10;
  for (double x = 0; x < side / 2; x += 1) {
    const double end = side / 7, number = end + 30, after = number + 30;
    if (x < end) CHECK(picture.dark(margin + x, y));
    if ((x > end + 4 && x < number) || x > after) CHECK(picture.at(margin + x, y) == white);
  }
  const std::string svg = written(folder, "bar.svg", square);
  CHECK(svg.find("width=\"14286\"") != std::string::npos);  // 10^5 / 7
  CHECK(svg.find(">1</text>") != std::string::npos);
}

TEST_CASE("triangles have the colours of their least angles, and the histogram has a bar for each degree") {
  ScratchFolder folder;
  Square square;
  square.input.vertices = {{0, 0}, {1, 0.8}, {1, 1}, {0.1, 1}};  // 6.34 and 39.29 degrees
  const auto by_angle = [&](const std::string& name) {
    io::OutputFiles files;
    io::Result result(square.input, square.mesh);
    result.coloured_by_angle = true;
    io::writer_for(io::lower_extension(name))(files.add(folder / name), result);
    files.commit();
    return folder.read(name);
  };
  by_angle("angle.png");
  const Picture picture(folder / "angle.png");
  const std::array<int, 3> red{0xb2, 0x18, 0x2b}, green{0xdc, 0xec, 0xd5};
  CHECK(picture.at(margin + side * 2 / 3, margin + side * .4) == red);
  CHECK(picture.at(margin + side * 1.1 / 3, margin + side / 3) == green);
  const double bars = side + 2 * margin + 80, degree = side / 60;
  CHECK(picture.at(margin + 6.5 * degree, bars) == red);
  CHECK(picture.at(margin + 39.5 * degree, bars) == green);
  for (const double other : {5.5, 7.5, 20.5, 38.5, 40.5}) CHECK(picture.at(margin + other * degree, bars) == white);
  const std::string svg = by_angle("angle.svg"), plain = written(folder, "plain.svg", square);
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  };
  CHECK(count(svg, "fill=\"#b2182b\"") == 2);  // a triangle and its bar
  CHECK(count(svg, "fill=\"#dcecd5\"") == 2);
  CHECK(count(svg, "</text>") == 1 + 7);  // of the scale, 0 to 60
  CHECK(count(plain, "#b2182b") == 0);
  CHECK(count(plain, "</text>") == 1);
  CHECK(by_angle("angle.pdf").substr(0, 5) == "%PDF-");
  square.mesh = {};  // nothing has an angle
  CHECK(count(by_angle("none.svg"), "</text>") == 1);
  by_angle("none.png");
}

TEST_CASE("a picture of nothing, of a point and of a line is one") {
  ScratchFolder folder;
  for (const auto& vertices : {std::vector<std::array<double, 2>>{}, {{3, 4}}, {{0, 0}, {1e308, 0}, {-1e308, 0}}}) {
    io::Input input;
    input.vertices = vertices;
    written(folder, "p.png", input, Triangulation{});
    CHECK(Picture(folder / "p.png").width >= 2 * margin);
    CHECK(written(folder, "p.pdf", input, Triangulation{}).substr(0, 5) == "%PDF-");
  }
}

TEST_CASE("short strokes leave the ink that they have, where they are") {
  const io::Canvas canvas({{0, 0}, {1, 1}});
  const double pixel = 1000;  // of the canvas's units
  io::Shade shade(canvas, pixel);
  CHECK(shade.width() == 102);
  shade.add({10500, 20500}, {14500, 20500}, 0.25);  // along the middles of row 20
  const std::vector<std::uint8_t> covered = shade.coverage();
  const auto at = [&](std::size_t x, std::size_t y) { return covered[y * 102 + x]; };
  const int inside = static_cast<int>(std::lround(255 * (1 - std::exp(-0.25))));
  for (const std::size_t x : {11u, 12u, 13u}) CHECK(at(x, 20) == inside);
  for (const std::size_t x : {8u, 9u, 15u, 16u}) CHECK(at(x, 20) == 0);
  for (const std::size_t y : {18u, 19u, 21u, 22u}) CHECK(at(12, y) == 0);
}

TEST_CASE("where edges are many, short ones are seen as the shade that they give, and long ones as lines") {
  constexpr std::uint32_t rows = 9, in_a_row = 12000;
  io::Input input;
  Triangulation mesh;
  Array<Constraint> pieces;
  for (std::uint32_t y = 0; y < rows; ++y)
    for (std::uint32_t x = 0; x <= in_a_row; ++x) {
      input.vertices.push_back({x / double(in_a_row), y / double(rows - 1)});
      const std::uint32_t v = y * (in_a_row + 1) + x;
      if (x > 0) pieces.push_back({v - 1, v});
    }
  REQUIRE(pieces.size() > 100000);
  const std::uint32_t last = (in_a_row + 1) * rows - 1;
  pieces.push_back({0, last - in_a_row});  // a side
  mesh.pieces = pieces;
  mesh.triangles = {{0, 1, last}};
  mesh.neighbours = {{-1, -1, -1}};
  mesh.constrained = {0};
  ScratchFolder folder;
  written(folder, "p.png", input, mesh);
  const Picture picture(folder / "p.png");
  for (std::uint32_t y = 0; y < rows; ++y) {
    const double row = margin + side * y / (rows - 1);
    CHECK(picture.at(margin + 777, row) != white);
    CHECK(picture.at(margin + 777, row + 6) == white);
  }
  CHECK(picture.at(margin, margin + 777) != white);
}

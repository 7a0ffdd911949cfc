// SPDX-License-Identifier: Apache-2.0
// gcdt triangulate in tiles: the same files as without.
#include "command_session.hpp"

using namespace gcdt::testing;

namespace {

// 900 vertices of a square grid, and a zigzag of constraints through it that meets many of them.
std::string grid_poly() {
  std::ostringstream out;
  out << "900 2 0 0\n";
  for (int i = 0; i < 900; ++i) out << i << ' ' << i % 30 << ' ' << i / 30 << '\n';
  out << "20 0\n";
  for (int i = 0; i < 20; ++i)
    out << i << ' ' << 30 * i + (i % 2) * 29 << ' ' << 30 * (i + 5) + (1 - i % 2) * 29 << '\n';
  out << "0\n";
  return out.str();
}

}  // namespace

TEST_CASE("an input in tiles, or on several devices, gives the same files") {
  Session session;
  session.write("in.poly", grid_poly());
  session.good("triangulate in.poly --crossing split -o whole.ele -o whole.neigh -o whole.poly --quiet");
  for (const std::string how : {"--tiles 2", "--tiles 7", "--device Portable,Portable", "--tiles 3 --memory 512MB"}) {
    CAPTURE(how);
    session.good("triangulate in.poly --crossing split --verify --quiet -o cut.ele -o cut.neigh -o cut.poly " + how);
    session.run("for kind in ele neigh poly node; do cmp whole.$kind cut.$kind; done");
  }
}

TEST_CASE("statistics in tiles say into how many, and count what the arrays show") {
  Session session;
  session.write("in.poly", grid_poly());
  session.good("triangulate in.poly --crossing drop --tiles 4 --stats cut.json --quiet");
  session.good("triangulate in.poly --crossing drop --stats whole.json --quiet");
  const auto cut = nlohmann::json::parse(session.read("cut.json")),
             whole = nlohmann::json::parse(session.read("whole.json"));
  CHECK(cut.at("tiles").at("count") == 4);
  CHECK(cut.at("tiles").at("seam_vertices") > 0);
  CHECK(!whole.contains("tiles"));
  CHECK(cut.at("quality").is_null());
  for (const char* name : {"n", "m", "vertices_merged", "constraints_zero", "constraints_pieces",
                           "constraints_overlapping", "constraints_dropped", "triangles", "grid"}) {
    CAPTURE(name);
    CHECK(cut.at(name) == whole.at(name));
  }
  CHECK(contains(session.good("triangulate in.poly --crossing drop --tiles 4"), "tiles         4, "));
}

TEST_CASE("an input that is too large for the device's memory is cut by itself; too many tiles are refused") {
  Session session;
  std::ostringstream out;
  out << "160000 2 0 0\n";
  for (int i = 0; i < 160000; ++i)
    out << i << ' ' << (i * 7919L) % 400 * 3 + i / 997 << ' ' << i / 400 * 5 + i % 3 << '\n';
  session.write("in.node", out.str());
  session.good("triangulate in.node -o whole.ele --quiet");
  session.good("triangulate in.node -o cut.ele --memory 64MB --stats cut.json --quiet");
  session.run("cmp whole.ele cut.ele");
  CHECK(nlohmann::json::parse(session.read("cut.json")).at("tiles").at("count") > 1);
  session.bad(2, "triangulate in.node --tiles 0");
  session.bad(2, "triangulate in.node --tiles 65535");
  session.bad(2, "triangulate in.node --memory much");
}

TEST_CASE("hole and region points of the file mean the same in tiles") {
  Session session;
  std::ostringstream out;
  out << "400 2 0 0\n";
  for (int i = 0; i < 400; ++i) out << i << ' ' << i % 20 << ' ' << i / 20 << '\n';
  out << "40 0\n";  // two lines across: four regions
  for (int i = 0; i < 19; ++i) out << i << ' ' << 20 * i + 7 << ' ' << 20 * i + 27 << '\n';
  for (int i = 19; i < 38; ++i) out << i << ' ' << 161 + i << ' ' << 162 + i << '\n';
  out << "38 0 19\n39 380 399\n2\n0 2 2\n1 7 9\n2\n0 2 15 5 0\n1 15 2 6 0\n";
  session.write("in.poly", out.str());
  for (const std::string domain : {"holes", "outer-holes", "hull --regions"}) {
    CAPTURE(domain);
    session.good("triangulate in.poly -o whole.ele -o whole.vtu --quiet --domain " + domain);
    for (const std::string how : {"--tiles 2", "--tiles 3", "--tiles 7", "--device Portable,Portable"}) {
      CAPTURE(how);
      session.good("triangulate in.poly --verify --quiet -o cut.ele -o cut.vtu --domain " + domain + " " + how);
      session.run("cmp whole.ele cut.ele && cmp whole.vtu cut.vtu");
    }
  }
}

// SPDX-License-Identifier: Apache-2.0
// A small mesh, files written and read, and failures to read, for the tests of formats.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "io/outputs.hpp"
#include "io/paths.hpp"
#include "io/svg.hpp"
#include "io/vtu.hpp"
#include "scratch_folder.hpp"

namespace gcdt::testing {

using io::Exit;
using io::Failure;

/// A unit square, cut by the constraint 0 2.
///   3---2
///   |1 /|
///   | /0|
///   0---1
struct Square {
  io::Input input;
  Triangulation mesh;

  explicit Square(std::uint32_t first = 0) {
    input.vertices = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    input.constraints = {{0, 2}};
    input.first = first;
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.neighbours = {{-1, 1, -1}, {-1, -1, 0}};
    mesh.constrained = {2, 4};
    mesh.pieces = {{0, 2}};
    mesh.statistics.grid.cell_exponent = -30;
  }
};

inline std::string written(const ScratchFolder& folder, const std::string& name, const io::Input& input,
                           const io::MeshArrays& mesh) {
  io::OutputFiles files;
  io::writer_for(io::lower_extension(name))(files.add(folder / name), {input, mesh});
  files.commit();
  return folder.read(name);
}
inline std::string written(const ScratchFolder& folder, const std::string& name, const Square& square) {
  return written(folder, name, square.input, square.mesh);
}

/// "LINE: what" of the failure that `action` must end in, with `path` taken off.
template <class Action>
std::string failure(const std::string& path, Exit exit, Action&& action) {
  try {
    action();
  } catch (const Failure& failed) {
    CHECK(failed.exit() == exit);
    const std::string what = failed.what();
    CHECK(what.compare(0, path.size() + 1, path + ":") == 0);
    return what.substr(std::min(what.size(), path.size() + 1));
  }
  FAIL("accepted");
  return {};
}

inline io::Input poly(const std::string& text) {
  ScratchFolder folder;
  return io::read_input(folder.write("in.poly", text));
}

inline bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

struct Malformed {
  const char *text, *expected;
};

}  // namespace gcdt::testing

// SPDX-License-Identifier: Apache-2.0
// Output files come into being all together or not at all; and those of empty results.
#include "format_cases.hpp"

using namespace gcdt;
using namespace gcdt::testing;

TEST_CASE("every format writes an empty result, and what can be read back is empty") {
  ScratchFolder folder;
  const io::Input input;
  const Triangulation mesh;
  for (const char* name : {"o.ele", "o.node", "o.neigh", "o.edge", "o.poly", "o.vtu", "o.svg"})
    CHECK(!written(folder, name, input, mesh).empty());
  CHECK(io::read_input(folder / "o.poly").vertices.empty());
  CHECK(io::read_mesh(folder / "o.neigh", 0, 0).triangles.empty());
  CHECK(io::read_vtu(folder / "o.vtu").triangles.empty());
}

TEST_CASE("output files appear only at commit, and nothing is left without it") {
  ScratchFolder folder;
  folder.write("old.ele", "before");
  {
    io::OutputFiles files;
    files.add(folder / "old.ele").write("after");
    files.add(folder / "new.ele").write("after");
    CHECK(folder.read("old.ele") == "before");
  }
  CHECK(folder.names() == std::vector<std::string>{"old.ele"});
  CHECK(folder.read("old.ele") == "before");
  io::OutputFiles files;
  files.add(folder / "old.ele").write("after");
  files.add(folder / "new.ele").write("after");
  files.commit();
  CHECK(folder.names() == std::vector<std::string>{"new.ele", "old.ele"});
  CHECK(folder.read("old.ele") == "after");
}

TEST_CASE("if one output cannot take its place, all others get back what they were") {
  ScratchFolder folder;
  folder.write("a.ele", "before");
  {
    io::OutputFiles files;
    files.add(folder / "a.ele").write("after");
    files.add(folder / "b.ele").write("after");
    files.add(folder / "c.ele").write("after");
    std::filesystem::create_directory(folder / "c.ele");
    folder.write("c.ele/inside", "");
    CHECK(!failure(folder / "c.ele", Exit::output, [&] { files.commit(); }).empty());
  }
  CHECK(folder.read("a.ele") == "before");
  CHECK(folder.names() == std::vector<std::string>{"a.ele", "c.ele"});
}

TEST_CASE("an output is written through a link, and keeps the permissions that were there") {
  ScratchFolder folder;
  folder.write("real.ele", "before");
  std::filesystem::permissions(folder / "real.ele", std::filesystem::perms(0640));
  std::filesystem::create_symlink("real.ele", folder / "link.ele");
  io::OutputFiles files;
  files.add(folder / "link.ele").write("after");
  files.commit();
  CHECK(std::filesystem::is_symlink(folder / "link.ele"));
  CHECK(folder.read("real.ele") == "after");
  CHECK(std::filesystem::status(folder / "real.ele").permissions() == std::filesystem::perms(0640));
}

TEST_CASE("an output in no folder, or in the place of a folder, is refused at once") {
  ScratchFolder folder;
  io::OutputFiles files;
  CHECK(!failure(folder / "no/o.ele", Exit::output, [&] { files.add(folder / "no/o.ele"); }).empty());
  CHECK(!failure(folder / "", Exit::output, [&] { files.add(folder / ""); }).empty());
}

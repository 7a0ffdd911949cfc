// SPDX-License-Identifier: Apache-2.0
// Output files come into being all together or not at all; and those of empty results.
#include "format_cases.hpp"
#include "solver_fixture.hpp"

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

TEST_CASE("a batch's arrays are written from where the batch has them") {
  Batch two;
  two.add({{0, 0}, {1, 0}, {0, 1}});
  two.add({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}}, {{0, 2}, {1, 3}});
  Pool pool(test::test_device());
  Options options;
  options.crossing = Crossing::split;
  options.regions = true;
  const BatchResult batch = pool.triangulate(two.view(), options);
  REQUIRE(!batch.error(1));
  const Triangulation copy = detail::triangulation(batch, 1);
  Triangulation rest;
  rest.statistics = copy.statistics, rest.added = copy.added;
  const io::MeshArrays arrays(batch, 1, rest), copied(copy);
#define GCDT_ARRAY(number, name, ...)                                                            \
  CHECK(arrays.name.data() == batch.name(1).data());                                             \
  CHECK(copied.name.data() == copy.name.data());                                                 \
  CHECK(std::equal(arrays.name.begin(), arrays.name.end(), copy.name.begin(), copy.name.end())); \
  CHECK(copied.name.size() == arrays.name.size());
#include <gcdt/arrays.def>
  CHECK(arrays.added.data() == rest.added.data());
  CHECK(arrays.added.size() == 1);

  ScratchFolder folder;
  io::Input input;
  input.vertices = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}};
  input.constraints = {{0, 2}, {1, 3}};
  for (const char* name : {"o.ele", "o.node", "o.poly", "o.vtu", "o.npz", "o.ply", "o.svg"})
    CHECK(written(folder, name, input, arrays) == written(folder, name, input, copied));
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

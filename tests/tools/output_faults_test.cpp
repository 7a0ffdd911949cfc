// SPDX-License-Identifier: Apache-2.0
// Each call that writes an output fails, the disk is full from there on, or the process is killed there: no file is
// half written, what stood there before is kept, and an error names the file.
#include "file_faults.hpp"
#include "format_cases.hpp"

using namespace gcdt;
using namespace gcdt::testing;

namespace {

/// The bytes of each target, before or after; one that is not there has none.
using Contents = std::vector<std::optional<std::string>>;

struct Targets {
  const ScratchFolder& folder;
  std::vector<std::string> names;

  Contents read() const {
    Contents all;
    for (const std::string& name : names) {
      all.emplace_back();
      if (std::filesystem::exists(folder / name)) all.back() = folder.read(name);
    }
    return all;
  }
  /// Nothing else is in the folder.
  void restore(const Contents& contents) const {
    for (const std::string& name : folder.names()) std::filesystem::remove_all(folder / name);
    for (std::size_t i = 0; i < names.size(); ++i)
      if (contents[i]) folder.write(names[i], *contents[i]);
  }
  /// What is in the folder but the targets.
  std::vector<std::string> others() const {
    std::vector<std::string> found;
    for (const std::string& name : folder.names())
      if (std::find(names.begin(), names.end(), name) == names.end()) found.push_back(name);
    return found;
  }
  bool are_named(const std::string& error) const {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return error.find(folder / name) != std::string::npos; });
  }
};

/// Writes targets in every way that can go wrong. Returns how many calls need room on the disk.
unsigned break_each_call(const Targets& targets, const Contents& before, const std::function<void()>& use) {
  targets.restore(before);
  use();
  const Contents after = targets.read();
  CHECK(targets.others().empty());
  unsigned calls = 0;
  for (const char* fault : {"fail", "full"})
    calls = for_each_call(
        targets.folder, fault, [&] { targets.restore(before); }, use,
        [&](const Ended& ended) {
          CHECK((ended.error.empty() || targets.are_named(ended.error)));
          CHECK(targets.read() == (ended.error.empty() ? after : before));
          CHECK(targets.others() == std::vector<std::string>());
        });
  for_each_call(
      targets.folder, "kill", [&] { targets.restore(before); }, use,
      [&](const Ended&) {
        const Contents now = targets.read();
        for (std::size_t i = 0; i < now.size(); ++i) CHECK((now[i] == before[i] || now[i] == after[i]));
        for (const std::string& name : targets.others()) CHECK(name.compare(0, 6, ".gcdt-") == 0);
        use();
        CHECK(targets.read() == after);
      });
  return calls;
}

}  // namespace

TEST_CASE("every format: an output is as it was before, or whole") {
  const Square square;
  for (const io::OutputFormat& format : io::output_formats()) {
    const ScratchFolder folder;
    const std::string name = std::string("o") + format.extension;
    CAPTURE(name);
    const auto use = [&] { written(folder, name, square); };
    CHECK(break_each_call({folder, {name}}, {std::nullopt}, use) == 5);
    CHECK(break_each_call({folder, {name}}, {"what was there"}, use) == 8);
  }
}

TEST_CASE("an output of many blocks") {
  const ScratchFolder folder;
  const std::string line(100000, 'x');
  CHECK(break_each_call({folder, {"o.txt"}}, {"what was there"}, [&] {
          io::OutputFiles files;
          io::OutputFile& file = files.add(folder / "o.txt");
          for (int i = 0; i < 35; ++i) file.write(line);
          files.commit();
        }) == 17);
}

TEST_CASE("several outputs: all are as they were, or all are whole; if the process is killed, each is") {
  const ScratchFolder folder;
  const Square square;
  CHECK(break_each_call({folder, {"a.ele", "b.vtu", "c.npz"}}, {"before", std::nullopt, "too"}, [&] {
          io::OutputFiles files;
          for (const char* name : {"a.ele", "b.vtu", "c.npz"})
            io::writer_for(io::lower_extension(name))(files.add(folder / name), {square.input, square.mesh});
          files.commit();
        }) == 21);
}

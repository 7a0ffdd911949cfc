// SPDX-License-Identifier: Apache-2.0
// ZIP archives, of which .npz is a kind: read by libzip, written without compression and with a fixed date.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "npy.hpp"
#include "output_files.hpp"

struct zip;

namespace gcdt::io {

/// An archive to be read. Failures are Exit::input and name the archive and the entry.
class ZipArchive {
 public:
  explicit ZipArchive(const std::string& path);
  bool has(const std::string& entry) const;
  /// The bytes of an entry, unpacked; at most one is read at a time, and the archive outlives it.
  ByteSource open(const std::string& entry) const;

 private:
  std::string path_;
  std::unique_ptr<zip, void (*)(zip*)> archive_;
};

/// An archive that is written entry by entry. Sizes and sums are known before an entry's bytes: what() is called twice.
class ZipWriter {
 public:
  using Sink = std::function<void(std::string_view bytes)>;
  explicit ZipWriter(OutputFile& file) : file_(file) {}
  /// Adds what `write` gives its sink, the same at each of two calls.
  void add(const std::string& name, const std::function<void(const Sink&)>& write);
  /// Writes the directory. Nothing may be added after it.
  void finish();

 private:
  struct Entry {
    std::string name;
    std::uint32_t sum;
    std::uint64_t size, offset;
  };
  void put(std::initializer_list<std::pair<std::uint64_t, int>> fields);

  OutputFile& file_;
  std::uint64_t at_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace gcdt::io

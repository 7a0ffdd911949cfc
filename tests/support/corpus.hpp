// SPDX-License-Identifier: Apache-2.0
// Readers of the test data: corpus/*.poly with corpus/manifest.txt, and corpus/minimal/*.txt.
#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "workloads.hpp"

namespace gcdt::test {

/// The words of a file, comments (# to the end of the line) gone.
std::vector<std::string> words(const std::string& path);

/// Triangle's .poly with its vertices inside; vertex and segment numbers start at 0 or 1. Knows just
/// what the corpus uses: attributes and markers are skipped, nan and inf are read, nothing is checked.
Workload read_poly(const std::string& path);

struct CorpusEntry {
  std::string name;
  std::string status;  ///< ok, crossing or invalid
  long triangles;      ///< derived by hand, or -1
  long crossings;
};

std::vector<CorpusEntry> read_manifest(const std::string& folder);

/// A file of corpus/minimal: nV nT nC, then vertices, triangles of a starting mesh, constraints.
struct Minimal {
  Workload input;
  std::vector<std::array<std::uint32_t, 3>> start;
};

Minimal read_minimal(const std::string& path);

}  // namespace gcdt::test

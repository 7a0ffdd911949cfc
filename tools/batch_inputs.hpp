// SPDX-License-Identifier: Apache-2.0
// The inputs of a batch: which files and lines they are, where their outputs go, and what is read of them.
#pragma once

#include <filesystem>
#include <gcdt/gcdt_pool.hpp>
#include <memory>

#include "command.hpp"
#include "io/geojson.hpp"
#include "io/outputs.hpp"

namespace gcdt::command {

/// The format that has many problems in one file.
inline constexpr const char* collected = ".jsonl";

/// One problem on its way: read, triangulated or failed, written.
struct Problem {
  std::string path, name;            ///< name: in messages
  std::optional<io::TextLine> line;  ///< of a file with many problems
  io::Input input;
  std::optional<io::Failure> failure;
  std::size_t number = 0;  ///< in the batch
  bool single = false;     ///< not in the batch, which has no seeds, but triangulated by itself
  /// What it is to be refined to.
  std::shared_ptr<const InputRefinement> refinement;

  /// The file of that format for this problem alone.
  std::filesystem::path output(const std::string& folder, const std::string& format) const;
  /// The file for all problems of the input.
  std::filesystem::path collection(const std::string& folder) const;
};

/// One for each input, or each line of a file with many, not yet read. Throws if two have the same outputs.
std::vector<Problem> problems_of(const BatchArguments& arguments);

/// Those of --format, as file extensions.
std::vector<std::string> formats_of(const BatchArguments& arguments);

/// No file is an input and an output, nor two outputs, but for the files of one problem, which have different formats.
void check_outputs(const std::vector<Problem>& problems, const BatchArguments& arguments,
                   const std::vector<std::string>& formats);

/// Reads all, and makes a batch of those that are not single; `sizes` get the lengths wanted at its vertices, if any
/// are. What cannot be read has a failure.
Batch read(std::vector<Problem>& problems, const RefineArguments& refine, const Options& options,
           std::vector<double>& sizes);

}  // namespace gcdt::command

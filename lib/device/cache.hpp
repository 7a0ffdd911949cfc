// SPDX-License-Identifier: Apache-2.0
// Small files that survive the process: built programs and the self-test's verdicts. A cache never
// fails: what cannot be read is built again, what cannot be written is not kept.
//
// Folder: $GCDT_CACHE_DIR, else $XDG_CACHE_HOME/gcdt, else ~/.cache/gcdt (macOS: ~/Library/Caches/gcdt,
// Windows: %LOCALAPPDATA%\gcdt). GCDT_DISABLE_CACHE=1 turns it off.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gcdt::cache {

/// MurmurHash3 of `bytes` (x64, 128 bits, seed 0; words in the machine's order) as 32 hexadecimal digits. It finds what
/// is damaged. It is no proof against forgery: whoever may write to the cache may replace any program in it.
std::string digest(const std::string& bytes);

/// The folder; empty if the cache is off or no place is known.
std::filesystem::path folder();

/// A file name for what `parts` determine. Other parts give another name, but for equal digests.
std::string entry(const char* kind, const std::vector<std::string>& parts);

/// Whether there is something under `entry`, whole or not.
bool has(const std::string& entry);

/// The content stored under `entry`, if it is there and whole. A damaged file is deleted.
std::optional<std::string> load(const std::string& entry);

/// Stores `content`; readers see the old file or the new one, never a part.
void store(const std::string& entry, const std::string& content);

void remove(const std::string& entry);

}  // namespace gcdt::cache

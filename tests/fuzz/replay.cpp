// SPDX-License-Identifier: Apache-2.0
// A main() for a fuzzer without libFuzzer: runs the corpus, then what it makes of that for some seconds, from a seed
// that is the same unless another is given. So tests, under any compiler and sanitizer, have a short form of
// scripts/fuzz.sh.
//
// Bytes that end the process are left in the file "finding".
// Usage: NAME_replay FOLDER SECONDS [SEED]
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" {
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
__attribute__((weak)) std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                                          unsigned seed);
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
}

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes running;  ///< what runs now

extern "C" void keep_finding(int signal) {
  std::signal(signal, SIG_DFL);
  if (std::FILE* const file = std::fopen("finding", "wb")) {
    std::fwrite(running.data(), 1, running.size(), file);
    std::fclose(file);
  }
  std::raise(signal);
}

void run(Bytes bytes) {
  running = std::move(bytes);
  LLVMFuzzerTestOneInput(running.data(), running.size());
}

std::minstd_rand random_bytes(22);
std::size_t below(std::size_t end) { return end == 0 ? 0 : random_bytes() % end; }

std::vector<Bytes> files_of(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().string());
  std::sort(names.begin(), names.end());
  std::vector<Bytes> files;
  for (const std::string& name : names) {
    std::ifstream file(name, std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return files;
}

}  // namespace

/// A byte that becomes another, one that goes, one that comes, or a part that comes twice.
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most) {
  const std::size_t at = below(size), part = 1 + below(std::min<std::size_t>(8, size - at));
  switch (below(4)) {
    case 0:
      if (size > 0) data[at] = static_cast<std::uint8_t>(below(256));
      return size;
    case 1:
      if (size == 0) return 0;
      std::copy(data + at + 1, data + size, data + at);
      return size - 1;
    case 2:
      if (size == most) return size;
      std::copy_backward(data + at, data + size, data + size + 1);
      data[at] = static_cast<std::uint8_t>(below(256));
      return size + 1;
    default:
      if (size == 0 || size + part > most) return size;
      std::copy_backward(data + at, data + size, data + size + part);
      return size + part;
  }
}

int main(int count, char** arguments) {
  if (count < 3 || count > 4) return std::fprintf(stderr, "usage: %s FOLDER SECONDS [SEED]\n", arguments[0]), 2;
  if (count == 4) random_bytes.seed(static_cast<unsigned>(std::atoi(arguments[3])));
  constexpr std::size_t most = 4096;
  const std::vector<Bytes> corpus = files_of(arguments[1]);
  if (corpus.empty()) return std::fprintf(stderr, "%s: no file there\n", arguments[1]), 1;
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS}) std::signal(signal, keep_finding);
  for (const Bytes& bytes : corpus) run(bytes);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(std::atoi(arguments[2]));
  unsigned long executions = corpus.size();
  for (; std::chrono::steady_clock::now() < end; ++executions) {
    Bytes bytes = corpus[below(corpus.size())];
    std::size_t size = bytes.size();
    bytes.resize(most);
    size = std::min(size, most);
    for (std::size_t i = 1 + below(8); i > 0; --i)
      size = LLVMFuzzerCustomMutator
                 ? LLVMFuzzerCustomMutator(bytes.data(), size, most, static_cast<unsigned>(random_bytes()))
                 : LLVMFuzzerMutate(bytes.data(), size, most);
    bytes.resize(size);
    run(bytes);
  }
  std::printf("%lu executions\n", executions);
}

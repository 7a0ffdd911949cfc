// SPDX-License-Identifier: Apache-2.0
#include "job.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <random>
#include <thread>

namespace gcdt::ranks {

namespace fs = std::filesystem;
using io::Exit;
using io::Failure;

namespace {

std::mutex job_mutex;                ///< held while the first rank renames, so that it is not ended then
OutputJob* job_under_way = nullptr;  ///< under job_mutex

[[noreturn]] void cannot_write(const fs::path& path, const std::string& why) {
  throw Failure(Exit::output, fmt::format("{}: cannot be written: {}", path.string(), why));
}

}  // namespace

void all_or_none(tiles::Team& team, const std::function<void()>& use) {
  std::string text;
  auto exit = Exit::done;
  try {
    use();
  } catch (const Failure& failure) {
    text = failure.what(), exit = failure.exit();
  }
  // The least rank that failed, as a complement, so that 0 is none.
  const std::uint64_t first = team.greatest(text.empty() ? 0 : team.size() - team.rank());
  if (first == 0) return;
  const std::size_t failed = team.size() - static_cast<std::size_t>(first);
  std::vector<std::uint64_t> words(1 + 256,
                                   0);  // the status, then characters: all ranks learn them as greatest numbers
  if (team.rank() == failed) {
    words[0] = static_cast<std::uint64_t>(exit);
    for (std::size_t i = 0; i < std::min<std::size_t>(text.size(), 8 * 256); ++i)
      words[1 + i / 8] |= std::uint64_t{static_cast<unsigned char>(text[i])} << (8 * (i % 8));
  }
  team.raise(words.data(), words.size());
  text.clear();
  for (std::size_t i = 0; i < 8 * 256; ++i)
    if (const char c = static_cast<char>(words[1 + i / 8] >> (8 * (i % 8)) & 255); c != 0) text += c;
  throw Failure(static_cast<Exit>(words[0]), text);
}

OutputJob::OutputJob(tiles::Team& team, std::vector<std::string> targets)
    : team_(team), targets_(targets.begin(), targets.end()) {
  std::vector<std::uint64_t> number(1, 0);
  if (team_.is_first()) {
    std::random_device random;
    number[0] = std::uint64_t{random()} << 32 | random();
  }
  broadcast(team_, number);
  folder_ = fs::absolute(targets_.back()).parent_path() / fmt::format(".gcdt-mpi-{:016x}", number[0]);
  {
    const std::lock_guard<std::mutex> lock(job_mutex);
    job_under_way = this;
  }
  try {
    all_or_none(team_, [&] {
      if (!team_.is_first()) return;
      for (const fs::path& target : targets_) {
        std::error_code ignored;
        const fs::file_status status = fs::status(target, ignored);
        if (fs::exists(status) && !fs::is_regular_file(status)) cannot_write(target, "is not a regular file");
      }
      std::error_code error;
      if (!fs::create_directory(folder_, error)) cannot_write(targets_.back(), error.message());
    });
  } catch (...) {
    const std::lock_guard<std::mutex> lock(job_mutex);
    job_under_way = nullptr;
    throw;
  }
}

OutputJob::~OutputJob() {
  const std::lock_guard<std::mutex> lock(job_mutex);
  abandon();
  job_under_way = nullptr;
}

void OutputJob::commit() {
  all_or_none(team_, [&] {  // all have come here, and nothing is renamed before
    std::error_code ignored;
    for (std::size_t i = 0; i < targets_.size() && team_.is_first(); ++i)
      if (!fs::exists(temporary(i), ignored)) cannot_write(targets_[i], "the ranks do not share a folder");
  });
  all_or_none(team_, [&] {
    if (!team_.is_first()) return;
    const std::lock_guard<std::mutex> lock(job_mutex);
    rename_all();
  });
}

void OutputJob::rename_all() {
  std::error_code error;
  std::ofstream(mark()).put('\n');
  const auto restore = [&](std::size_t renamed) {
    std::error_code ignored;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      if (i < renamed) fs::remove(targets_[i], ignored);
      if (fs::exists(kept(i), ignored)) fs::rename(kept(i), targets_[i], ignored);
    }
    fs::remove(mark(), ignored);
  };
  for (std::size_t i = targets_.size(); i-- > 0 && !error;)  // the last one first: it names the others
    if (fs::exists(targets_[i])) fs::rename(targets_[i], kept(i), error);
  if (error) {
    restore(0);
    cannot_write(targets_.back(), error.message());
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    fs::rename(temporary(i), targets_[i], error);
    if (!error) continue;
    restore(i);
    cannot_write(targets_[i], error.message());
  }
  fs::remove(mark(), error);
}

void OutputJob::abandon() noexcept {
  std::error_code ignored;
  // Ends: another rank that still writes there is told to end, too.
  for (int tries = 0; tries < 40 && fs::exists(folder_, ignored); ++tries) {
    if (fs::exists(mark(), ignored) && !team_.is_first()) {
      std::fprintf(stderr, "gcdt_mpi: the first rank was lost while it renamed; what stood there is in %s\n",
                   folder_.c_str());
      return;
    }
    fs::remove_all(folder_, ignored);
    if (fs::exists(folder_, ignored)) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void watch_end() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // threads that come later inherit it
  std::thread([signals] {
    int signal = 0;
    sigwait(&signals, &signal);
    const std::lock_guard<std::mutex> lock(job_mutex);
    if (job_under_way) job_under_way->abandon();
    _exit(static_cast<int>(Exit::interrupted));
  }).detach();
}

}  // namespace gcdt::ranks

// SPDX-License-Identifier: Apache-2.0
#include "job.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
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

/// For the sake of a target.
void make_empty(const fs::path& path, const fs::path& target) {
  std::ofstream file(path);
  file.close();
  if (!file) cannot_write(target, std::strerror(errno));
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
      make_empty(is_open(), targets_.back());
    });
  } catch (...) {
    const std::lock_guard<std::mutex> lock(job_mutex);
    abandon();
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
  std::error_code error, ignored;
  for (std::size_t i = 0; i < targets_.size(); ++i)
    if (!fs::exists(fs::symlink_status(targets_[i], ignored)))
      make_empty(none(i), targets_[i]);
    else
      fs::create_hard_link(targets_[i], kept(i), ignored);  // so that the name is never without a file
  fs::rename(is_open(), is_committing(), error);
  if (error) cannot_write(targets_.back(), "another rank has ended");
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    // Where the file system has no hard links it is moved away.
    const bool moves = !fs::exists(none(i), ignored) && !fs::exists(kept(i), ignored);
    if (moves) fs::rename(targets_[i], kept(i), error);
    if (!error) fs::rename(temporary(i), targets_[i], error);
    if (!error) continue;
    if (moves) fs::rename(kept(i), targets_[i], ignored);
    take_back();
    cannot_write(targets_[i], error.message());
  }
}

// The last new file decides. With its name all are there; and whoever takes it away before, alone takes back what has
// been named. The other new files go first, so that a rank that still gives names does not get on.
void OutputJob::take_back() noexcept {
  const std::size_t last = targets_.size() - 1;
  std::error_code error, ignored;
  fs::rename(temporary(last), is_taken_back(), error);
  if (error) return;
  has_taken_back_ = true;
  for (std::size_t i = 0; i < last; ++i) fs::remove(temporary(i), ignored);
  for (std::size_t i = 0; i <= last; ++i)
    if (fs::exists(fs::symlink_status(kept(i), ignored))) {
      fs::rename(kept(i), targets_[i], ignored);
      fs::remove(kept(i), ignored);  // renaming a file to another of its own names keeps both
    } else if (i < last && fs::exists(none(i), ignored)) {
      fs::remove(targets_[i], ignored);
    }
}

void OutputJob::abandon() noexcept {
  std::error_code error, ignored;
  fs::rename(is_open(), is_ended(), error);  // from then on no file can get its name
  if (error && fs::exists(is_committing(), ignored)) take_back();
  // Ends: another rank that still writes there is told to end, too, and one that takes back is soon done.
  for (int tries = 0; tries < 40 && fs::exists(folder_, ignored); ++tries) {
    if (has_taken_back_ || !fs::exists(is_taken_back(), ignored)) fs::remove_all(folder_, ignored);
    if (fs::exists(folder_, ignored)) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (!has_taken_back_ && fs::exists(is_taken_back(), ignored))
    std::fprintf(stderr, "gcdt_mpi: a rank was lost while it took files back; what stood there is in %s\n",
                 folder_.c_str());
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

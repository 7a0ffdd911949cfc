// SPDX-License-Identifier: Apache-2.0
#include "peer.hpp"

#include <csignal>
#include <cstdlib>
#include <sstream>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gcdt::bench {

namespace {
constexpr double seconds_to_start = 60, seconds_to_answer = 120;
}

Peer::Peer(std::string command) : command_(std::move(command)) { start(); }

Peer::Peer(Peer&& other) noexcept
    : command_(std::move(other.command_)),
      name_(std::move(other.name_)),
      rest_(std::move(other.rest_)),
      constraints_(other.constraints_),
      process_(other.process_),
      to_(other.to_),
      from_(other.from_) {
  other.process_ = -1;
  other.to_ = other.from_ = -1;
}

Peer::~Peer() { stop(); }

void Peer::start() {
  std::signal(SIGPIPE, SIG_IGN);
  int request[2], answer[2];
  if (pipe(request) != 0) return;
  if (pipe(answer) != 0) {
    close(request[0]);
    close(request[1]);
    return;
  }
  process_ = fork();
  if (process_ == 0) {
    dup2(request[0], 0);
    dup2(answer[1], 1);
    for (const int end : {request[0], request[1], answer[0], answer[1]}) close(end);
    const std::string shell = "exec " + command_;
    execl("/bin/sh", "sh", "-c", shell.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  close(request[0]);
  close(answer[1]);
  to_ = request[1];
  from_ = answer[0];
  rest_.clear();
  std::string line, kind;
  if (process_ < 0 || !read_line(line, seconds_to_start)) return stop();
  std::istringstream words(line);
  words >> name_ >> kind;
  constraints_ = kind == "constraints";
}

void Peer::stop() {
  if (to_ >= 0) close(to_);
  if (from_ >= 0) close(from_);
  to_ = from_ = -1;
  if (process_ > 0) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  process_ = -1;
}

bool Peer::read_line(std::string& line, double seconds) {
  for (;;) {
    const std::size_t end = rest_.find('\n');
    if (end != std::string::npos) {
      line = rest_.substr(0, end);
      rest_.erase(0, end + 1);
      return true;
    }
    pollfd wait{from_, POLLIN, 0};
    if (poll(&wait, 1, static_cast<int>(seconds * 1000)) <= 0) return false;
    char bytes[4096];
    const ssize_t count = read(from_, bytes, sizeof bytes);
    if (count <= 0) return false;
    rest_.append(bytes, static_cast<std::size_t>(count));
  }
}

PeerTimes Peer::time(const std::string& file, int runs, double seconds) {
  if (process_ < 0) start();  // it may have died of the input before
  if (process_ < 0) return {"did not start", 0, {}, 0, 0};
  const std::string request = file + ' ' + std::to_string(runs) + ' ' + std::to_string(seconds) + '\n';
  std::string line;
  if (write(to_, request.data(), request.size()) != static_cast<ssize_t>(request.size()) ||
      !read_line(line, seconds_to_answer)) {
    stop();
    return {"died or did not answer", 0, {}, 0, 0};
  }
  std::istringstream words(line);
  std::string outcome;
  words >> outcome;
  PeerTimes times;
  if (outcome != "ok") {
    std::getline(words >> std::ws, times.error);
    if (times.error.empty()) times.error = "failed";
    return times;
  }
  words >> times.triangles;
  for (std::string word; words >> word;) {
    if (word == "mesh") {
      words >> times.vertices >> times.least_angle;
      break;
    }
    times.ms.push_back(std::strtod(word.c_str(), nullptr));
  }
  if (times.ms.empty()) times.error = "gave no times";
  return times;
}

}  // namespace gcdt::bench

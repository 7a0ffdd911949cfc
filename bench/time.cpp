// SPDX-License-Identifier: Apache-2.0
// The timer: for each input of the list, makes it, warms up, times at least ten calls, times the peers on the same
// points, verifies a timed result once outside the timing, and writes a row (bench/README.md).
#include <algorithm>
#include <cctype>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>

#include <gcdt/gcdt.hpp>
#include <gcdt/verify.hpp>

#include "device_caller.hpp"
#include "pinned.hpp"
#include "rates.hpp"
#include "results.hpp"
#include "row.hpp"
#include "sampled_check.hpp"

namespace {

using namespace gcdt;
using namespace gcdt::bench;

struct Arguments {
  std::string device, list, only, out, suffix, anchors, scratch = "/tmp", command, commit;
  std::vector<std::string> maps, peers;
  bool quick = false, force = false, first_call = false, first_constrained = false, context_only = false;
};

constexpr std::size_t quick_vertices = 20000, quick_located = 20000;
constexpr std::size_t samples = 1000000, located = 1000000, few_located = 1000;
constexpr double locating_seconds = 3;  // of one run
constexpr double warm_seconds = 0.3;    // a GPU raises its clocks only under load
constexpr double long_call_ms = 2000;   // one such call has warmed up
constexpr double least_seconds = 0.3;   // short calls are repeated until so much time is measured
constexpr int most_runs = 101;
constexpr double short_call_ms = 20;  // such calls and those of peers are timed by turns, since a host's speed varies
constexpr int turns = 5;
constexpr double peer_seconds = 10;  // after three runs

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double middle(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

std::uint64_t hash(const Triangulation& mesh) {
  std::uint64_t h = 0;
  const auto mix = [&h](std::uint64_t word) {
    h = (h ^ word) * 0x9e3779b97f4a7c15u;
    h ^= h >> 29;
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    mix(std::uint64_t{t[0]} << 32 | t[1]);
    mix(std::uint64_t{t[2]} << 32 | mesh.constrained[i]);
  }
  return h;
}

class Benchmark {
 public:
  Benchmark(const Arguments& arguments)
      : arguments_(arguments),
        peers_(start_peers()),
        solver_(arguments.device),
        pinned_(solver_.device()),
        device_(solver_.device()),
        results_(file()) {}

  bool run() {
    const DeviceInfo& device = solver_.device();
    std::fprintf(stderr, "%s (%s, %s)\n", device.name.c_str(), device.platform.c_str(), device.driver.c_str());
    describe_machine();
    const std::string list = arguments_.list.empty() ? device.is_gpu ? "gpu" : "cpu" : arguments_.list;
    std::vector<Input> rows;
    for (const Input& input : inputs(list == "gpu"       ? List::gpu
                                     : list == "cpu"     ? List::cpu
                                     : list == "scaling" ? List::scaling
                                                         : List::shapes,
                                     arguments_.maps))
      if (selected(input, arguments_.only)) rows.push_back(input);
    if (rows.empty()) throw std::runtime_error("no workload of the list is called " + arguments_.only);
    if (arguments_.quick) rows = quick(rows, quick_vertices);
    const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
    for (const Input& input : rows) {
      if (!arguments_.force && results_.has(input.name, input.size, device.name)) {
        std::fprintf(stderr, "%s %zu: there already\n", input.name.c_str(), input.size);
        continue;
      }
      time(input);
      // verification has one thread an input: keep some back where there are cores, but lose little if stopped
      std::size_t vertices = 0;
      for (const auto& row : waiting_) vertices += row->work.points.size();
      if (2 * waiting_.size() >= threads || vertices > 1000000 * std::size_t{threads}) verify_waiting();
    }
    verify_waiting();
    return good_;
  }

 private:
  /// Named after the device, in the folder --out; said on standard output.
  std::string file() const {
    const DeviceInfo& d = solver_.device();
    std::string name;
    for (const char c : d.is_cpu ? d.name + " x" + std::to_string(d.compute_units) : d.name) {
      if (std::isalnum(static_cast<unsigned char>(c)))
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      else if (!name.empty() && name.back() != '-')
        name += '-';
    }
    const std::string path = arguments_.out + '/' + name + arguments_.suffix + ".json";
    std::printf("%s\n", path.c_str());
    std::fflush(stdout);
    return path;
  }

  std::vector<Peer> start_peers() const {
    std::vector<Peer> peers;
    for (const std::string& command : arguments_.peers) {
      Peer peer(command);
      if (peer.name().empty())
        std::fprintf(stderr, "no peer by: %s\n", command.c_str());
      else
        peers.push_back(std::move(peer));
    }
    return peers;
  }

  void describe_machine() {
    const DeviceInfo& d = solver_.device();
    Object machine;
    machine.add("device", d.name).add("kind", d.is_gpu ? "gpu" : "cpu").add("platform", d.platform);
    machine.add("driver", d.driver).add("opencl", d.version);
    machine.add("compute_units", static_cast<unsigned long long>(d.compute_units));
    machine.add("host_threads", static_cast<unsigned long long>(std::thread::hardware_concurrency()));
    machine.add("command", arguments_.command).add("commit", arguments_.commit).add("date", date());
    try {
      const std::uint64_t mebibytes = arguments_.quick ? 1 : d.is_gpu ? 1024 : 128;
      const std::size_t bytes = std::min<std::uint64_t>(d.largest_buffer_bytes / 4, mebibytes << 20);
      const Rates r = measure_rates(d, bytes / 16 * 16);
      machine.add("copy_gb_s", r.copy_gb_s).add("buffer_copy_gb_s", r.buffer_copy_gb_s);
      machine.add("write_gb_s", r.write_gb_s).add("read_gb_s", r.read_gb_s);
      machine.add("pinned_write_gb_s", r.pinned_write_gb_s).add("pinned_read_gb_s", r.pinned_read_gb_s);
      machine.add("launch_us", r.launch_us).add("launch_read_us", r.launch_read_us);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "rates of the device: %s\n", error.what());
    }
    results_.set_machine(machine.text());
    std::fprintf(stderr, "%s\n", machine.text().c_str());
  }

  void time(const Input& input) try {
    auto row = std::make_unique<Row>();
    row->input = input;
    double start = seconds_now();
    row->work = make(input, [&](const std::vector<Point>& points) { return solver_.triangulate(points).triangles; });
    const double made = seconds_now() - start;
    if (!input.path.empty()) row->options.crossing = Crossing::drop;
    start = seconds_now();
    time_calls(*row);
    const double timed = seconds_now() - start;
    trace_kernels(*row);
    ask_besides(*row);
    row->pinned_ms = pinned_.time(row->work.points, row->work.constraints, row->options, least_runs());
    start = seconds_now();
    time_peers(*row);
    std::fprintf(stderr, "%-18s %9zu core %9.3f call %9.3f ms (made in %.1f s, timed %.1f s, peers %.1f s)\n",
                 input.name.c_str(), row->work.points.size(), median(*row, &Statistics::Milliseconds::core),
                 middle(row->call_ms), made, timed, seconds_now() - start);
    waiting_.push_back(std::move(row));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s %zu: %s\n", input.name.c_str(), input.size, error.what());
    good_ = false;
  }

  int least_runs() const { return arguments_.quick ? 3 : 11; }

  double call(Row& row) {
    row.mesh = {};
    const double from = seconds_now();
    row.mesh = solver_.triangulate(row.work.points, row.work.constraints, row.options);
    return 1000 * (seconds_now() - from) - row.mesh.statistics.ms.build;
  }

  // Adds to the times of calls that are there, whose bytes these must have.
  void time_calls(Row& row) {
    const bool first = row.call_ms.empty();
    const std::uint64_t before = first ? 0 : hash(row.mesh);
    const double start = seconds_now();
    double ms = call(row);  // builds the kernels, at first
    const double enough = arguments_.quick ? 0 : least_seconds, warm = arguments_.quick ? 0 : warm_seconds;
    for (int i = 1; (i < 2 && ms < long_call_ms) || seconds_now() - start < warm; ++i) ms = call(row);
    const std::uint64_t bytes = hash(row.mesh);
    row.same_bytes &= first || bytes == before;
    double measured = 0;
    for (int i = 0; i < least_runs() || (i < most_runs && measured < enough); ++i) {
      row.call_ms.push_back(call(row));
      row.ms.push_back(row.mesh.statistics.ms);
      measured += row.call_ms.back() / 1000;
      row.same_bytes &= hash(row.mesh) == bytes;
    }
  }

  // The second of two calls by a solver of its own: the queue has profiling.
  void trace_kernels(Row& row) {
    std::map<std::string, std::pair<double, int>>& kernels = row.kernels;
    Solver traced(arguments_.device, {}, [&](const TraceSpan& span) {
      if (!span.on_device) return;
      auto& [ms, launches] = kernels[span.name];
      ms += static_cast<double>(span.end_ns - span.begin_ns) / 1e6;
      ++launches;
    });
    traced.solve(row.work.points, row.work.constraints, row.options);
    kernels.clear();
    traced.solve(row.work.points, row.work.constraints, row.options);
  }

  // How many of the points are located in some seconds: all, a tenth of them, and so on. Where no vertex is near a
  // point walks are long (two rows far apart: linear in n).
  static std::size_t affordable(const Result& result, const std::vector<Point>& points) {
    const std::vector<Point> few(points.begin(), points.begin() + few_located);
    Array<std::array<double, 3>> weights;
    double each = HUGE_VAL;
    for (int i = 0; i < 3; ++i) {  // the first one makes room
      const double from = seconds_now();
      result.locate(few, &weights);
      each = std::min(each, (seconds_now() - from) / few_located);
    }
    std::size_t count = points.size();
    while (count > few_located && each * static_cast<double>(count) > locating_seconds) count /= 10;
    return count;
  }

  // Medians of five after one that builds.
  void ask_besides(Row& row) {
    Options options = row.options;
    options.regions = true;
    std::vector<Point> inside = test::uniform(arguments_.quick ? quick_located : located).points;
    std::array<double, 2> low = row.work.points.at(0), high = low;
    for (const Point& p : row.work.points)
      for (int axis = 0; axis < 2; ++axis) {
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
    for (Point& p : inside)
      for (int axis = 0; axis < 2; ++axis) p[axis] = low[axis] + p[axis] * (high[axis] - low[axis]);
    std::vector<double> regions, locating;
    for (int i = -1; i < 5; ++i) {
      const Result result = solver_.solve(row.work.points, row.work.constraints, options);
      const double order_ms = result.statistics().ms.output;  // without the copy to the host
      Array<std::array<double, 3>> weights;
      result.locate(std::vector<Point>{inside[0]}, &weights);  // makes what all later queries use
      if (i < 0) inside.resize(affordable(result, inside));
      const double from = seconds_now();
      result.locate(inside, &weights);
      if (i < 0) continue;
      row.order_ms.push_back(order_ms);
      locating.push_back(1000 * (seconds_now() - from));
      regions.push_back(result.statistics().ms.domain);
    }
    row.located = inside.size();
    row.regions_ms = middle(regions);
    row.locate_ms = middle(locating);
    row.device_locate_ms = middle(device_.time_locate(row.work.points, row.work.constraints, row.options, inside, 5));
  }

  /// As calls are timed: a short one is repeated until so much time is measured.
  static PeerTimes time_peer(Peer& peer, const std::string& file) {
    PeerTimes times = peer.time(file, 11, peer_seconds);
    if (!times.error.empty()) return times;
    const double wanted = 1000 * least_seconds / std::max(middle(times.ms), 1e-3);
    const int runs = static_cast<int>(std::min<double>(most_runs, wanted));
    return runs > 11 ? peer.time(file, runs, peer_seconds) : times;
  }

  static void add_turn(Peer& peer, const std::string& file, PeerTimes& times) {
    const PeerTimes more = time_peer(peer, file);
    times.ms.insert(times.ms.end(), more.ms.begin(), more.ms.end());
    if (!more.error.empty()) times.error = more.error;
  }

  void time_peers(Row& row) {
    std::vector<Peer*> able;
    for (Peer& peer : peers_)
      if (row.work.constraints.empty() || peer.takes_constraints()) able.push_back(&peer);
    if (able.empty()) return;
    const std::string file = arguments_.scratch + "/gcdt_bench_" + std::to_string(getpid()) + ".pslg";
    write_pslg(row.work, file);
    for (Peer* peer : able)
      row.peers.push_back({peer->name(), arguments_.quick ? peer->time(file, 3, 0) : time_peer(*peer, file)});
    const bool by_turns = !arguments_.quick && middle(row.call_ms) < short_call_ms;
    for (int turn = 1; by_turns && turn < turns; ++turn) {
      time_calls(row);
      for (std::size_t i = 0; i < able.size(); ++i) {
        PeerTimes& times = row.peers[i].second;
        if (times.error.empty() && middle(times.ms) < short_call_ms) add_turn(*able[i], file, times);
      }
    }
    std::remove(file.c_str());
  }

  /// "" or what is wrong with the row's mesh.
  static std::string fault(Row& row) {
    if (row.work.points.size() > largest_verified) return sampled_check(row.work.points, row.mesh, samples);
    const MeshView view{row.mesh.triangles, row.mesh.neighbours.data(), row.mesh.constrained.data()};
    const double from = seconds_now();
    const Verification v =
        verify(row.work.points, row.work.constraints, view, row.mesh.statistics.grid, row.options.crossing);
    row.verify_ms = 1000 * (seconds_now() - from);
    return v.valid ? "" : v.reason;
  }

  void verify_waiting() {
    const double start = seconds_now();
    std::vector<std::future<std::string>> faults;
    for (const auto& row : waiting_)
      faults.push_back(std::async(std::launch::async, [&row] {
        try {
          return fault(*row);
        } catch (const std::exception& error) {
          return std::string(error.what());
        }
      }));
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      const std::string why = faults[i].get();
      if (!why.empty() || !waiting_[i]->same_bytes) {
        good_ = false;
        std::fprintf(stderr, "%s %zu: %s\n", waiting_[i]->input.name.c_str(), waiting_[i]->input.size,
                     why.empty() ? "runs differ" : why.c_str());
      }
      results_.put(describe(*waiting_[i], solver_.device(), why, arguments_.anchors, arguments_.commit));
    }
    if (!waiting_.empty()) std::fprintf(stderr, "verified %zu in %.1f s\n", waiting_.size(), seconds_now() - start);
    waiting_.clear();
  }

  const Arguments& arguments_;
  std::vector<Peer> peers_;  // started before there are threads of an OpenCL driver
  Solver solver_;
  PinnedCaller pinned_;
  DeviceCaller device_;
  Results results_;
  std::vector<std::unique_ptr<Row>> waiting_;  ///< to be verified
  bool good_ = true;
};

const char* const usage =
    "usage: gcdt_bench --out FOLDER [--suffix TEXT] [--device SPEC] [--list gpu|cpu|scaling|shapes] [--only "
    "NAME[:SIZE],...]\n"
    "                  [--quick] [--force] [--map FILE.poly]... [--peer COMMAND]... [--anchors FILE]\n"
    "                  [--scratch FOLDER] [--command TEXT] [--commit TEXT]\n"
    "       gcdt_bench --first-call [--device SPEC]   triangulates 1000 points and ends: to be timed from outside\n"
    "       gcdt_bench --first-constrained [--device SPEC]   the same with letters of 98,000 vertices and constraints\n"
    "       gcdt_bench --context-only [--device SPEC] the same without triangulating\n";

bool parse(int count, char** words, Arguments& a) {
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    bool known = true;
    const auto flag = [&](const char* name, bool& value) { return word == name && (value = true); };
    const auto option = [&](const char* name, std::string& value) {
      if (word != name) return false;
      if (i + 1 < count)
        value = words[++i];
      else
        known = false;
      return true;
    };
    std::string map, peer;
    const bool taken = flag("--quick", a.quick) || flag("--force", a.force) || flag("--first-call", a.first_call) ||
                       flag("--first-constrained", a.first_constrained) || flag("--context-only", a.context_only) ||
                       option("--out", a.out) || option("--suffix", a.suffix) || option("--device", a.device) ||
                       option("--list", a.list) || option("--only", a.only) || option("--map", map) ||
                       option("--peer", peer) || option("--anchors", a.anchors) || option("--scratch", a.scratch) ||
                       option("--command", a.command) || option("--commit", a.commit);
    if (!taken || !known) return false;
    if (!map.empty()) a.maps.push_back(map);
    if (!peer.empty()) a.peers.push_back(peer);
  }
  const bool list = a.list.empty() || a.list == "gpu" || a.list == "cpu" || a.list == "scaling" || a.list == "shapes";
  return list && (a.first_call || a.first_constrained || a.context_only || !a.out.empty());
}

}  // namespace

int main(int count, char** words) try {
  Arguments arguments;
  if (!parse(count, words, arguments)) {
    std::fputs(usage, stderr);
    return 2;
  }
  if (arguments.context_only) {
    const std::vector<DeviceInfo> all = devices();
    context_and_queue(all.at(select_device(arguments.device)));
    return 0;
  }
  if (arguments.first_call) return triangulate(test::uniform(1000).points, {}, {}, arguments.device).triangles.empty();
  if (arguments.first_constrained) {
    const Workload work = test::workload("letters", 98000);
    return triangulate(work.points, work.constraints, {}, arguments.device).triangles.empty();
  }
  return Benchmark(arguments).run() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "gcdt_bench: %s\n", error.what());
  return 1;
}

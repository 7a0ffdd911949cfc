// SPDX-License-Identifier: Apache-2.0
// Times quality refinement beyond the triangulation, beside Triangle if it is there, proves what comes out, and prints
// a row of JSON for each input (bench/README.md, "Refinement").
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <unistd.h>

#include <gcdt/verify.hpp>

#include "results.hpp"
#include "row.hpp"

namespace {

using namespace gcdt;
using namespace gcdt::bench;

constexpr char usage[] =
    "gcdt_bench_refine [--device SPEC] [--runs R] [--only NAME[:N],...] [--most N] [--no-check]\n"
    "                  [--map FILE.poly]... [--peer COMMAND] [--cgal COMMAND]\n"
    "                  [--scratch FOLDER]\n"
    "  --most N     no input that is made has more vertices or triangles: shows that all works\n"
    "  --no-check   without the device's proof, of the triangulation and of what it is refined to\n"
    "  --peer       such as 'python3 bench/peers/triangle_refine.py'; gets Triangle's switches as its argument\n"
    "  --cgal       another peer, such as gcdt_bench_cgal_refine, with the same argument\n"
    "  R: timed calls, 11\n";

struct Arguments {
  std::string device, only, peer, cgal, scratch = "/tmp";
  std::vector<std::string> maps;
  std::size_t most = SIZE_MAX;
  int runs = 11;
  bool check = true;
};

// Meshes of up to so many vertices are proved on the host.
constexpr std::size_t largest_proved = 2000000;
constexpr double peer_seconds = 10;  // after three runs
// Above 26 degrees nobody promises that refinement ends.
constexpr std::uint64_t added_per_vertex = 20;

/// What is refined to what.
struct Task {
  Input input;
  double angle = 20, most_area = HUGE_VAL;
  Domain domain = Domain::hull;

  /// Triangle's for the same; `plain`: without refinement.
  std::string switches(bool constrained, bool plain) const {
    std::string text = constrained ? domain == Domain::hull ? "pc" : "p" : "";
    if (plain) return text;
    char number[64];
    std::snprintf(number, sizeof number, "q%.10g", angle);
    text += number;
    if (most_area < HUGE_VAL) {
      std::snprintf(number, sizeof number, "a%.15f", most_area);
      text += number;
    }
    return text;
  }
};

/// The square of side 1 in about so many triangles: their mean area is 0.56 of the largest.
Task square(std::size_t triangles) {
  return {{"square", triangles, {}}, 20, 1 / (0.56 * static_cast<double>(triangles)), Domain::outer};
}

std::vector<Task> tasks(const Arguments& arguments) {
  std::vector<Task> all;
  for (const std::size_t triangles : {1000, 10000, 100000, 1000000, 10000000}) all.push_back(square(triangles));
  for (const double angle : {20.0, 30.0})
    for (const std::size_t n : {10000, 20000, 100000})
      all.push_back({{"uniform", n, {}}, angle, HUGE_VAL, Domain::hull});
  all.push_back({{"letters", 10000, {}}, 20, HUGE_VAL, Domain::outer});
  for (const std::string& path : arguments.maps) {
    std::string name = path.substr(path.find_last_of('/') + 1);
    name = name.substr(0, name.find_last_of('.'));
    for (const Domain domain : {Domain::hull, Domain::outer})
      all.push_back({{name + (domain == Domain::hull ? "" : "-within"), 0, path}, 25, HUGE_VAL, domain});
  }
  const auto out = [&](const Task& task) {
    return task.input.size > arguments.most || !selected(task.input, arguments.only);
  };
  all.erase(std::remove_if(all.begin(), all.end(), out), all.end());
  return all;
}

Workload work_of(const Task& task) {
  if (task.input.name != "square") return make(task.input, {});
  Workload work;
  work.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  work.constraints = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  return work;
}

Options options_of(const Task& task, std::size_t n, bool check) {
  Options options;
  options.check = check;
  options.domain = task.domain;
  if (!task.input.path.empty()) options.crossing = Crossing::drop;
  options.refine = Refinement{};
  options.refine->least_angle = task.angle;
  options.refine->most_area = task.most_area;
  if (task.angle > 26) options.refine->most_added = added_per_vertex * n;
  return options;
}

double milliseconds_of(const std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Times of one input, in ms.
struct Times {
  std::vector<double> refine;  ///< the phase, of a call with refinement
  std::vector<double> call;    ///< that call, on the caller's clock, without building
  std::vector<double> plain;   ///< the call without refinement
  std::vector<double> result;  ///< Result::refine of that call's result
  double least_angle = 0;
};

/// `mesh`: of the last call; `again`: triangles of the last result that was refined.
Times time(Solver& solver, const Workload& work, const Options& options, int runs, Triangulation& mesh,
           Array<std::array<std::uint32_t, 3>>& again) {
  Times times;
  Options plain = options, own;
  plain.refine.reset();
  own.check = options.check;
  for (int i = -2; i < runs; ++i) {  // two that build and warm up
    const auto call = std::chrono::steady_clock::now();
    mesh = solver.triangulate(work.points, work.constraints, options);
    const double call_ms = milliseconds_of(call) - mesh.statistics.ms.build;
    const auto unrefined = std::chrono::steady_clock::now();
    const Result result = solver.solve(work.points, work.constraints, plain);
    const double plain_ms = milliseconds_of(unrefined);
    const auto refining = std::chrono::steady_clock::now();
    const Result refined = result.refine(*options.refine, own);
    const double result_ms = milliseconds_of(refining);
    if (i == runs - 1) again = refined.triangles(), times.least_angle = refined.quality().least_angle;
    if (i < 0) continue;
    times.refine.push_back(mesh.statistics.ms.refine);
    times.call.push_back(call_ms);
    times.plain.push_back(plain_ms);
    times.result.push_back(result_ms);
  }
  return times;
}

/// "" or what is wrong.
std::string fault(const Workload& work, const Options& options, const Triangulation& mesh,
                  const Array<std::array<std::uint32_t, 3>>& again) {
  if (again != mesh.triangles) return "the refined result has other bytes";
  if (mesh.representative.size() > largest_proved) return "";
  MeshView view;
  view.triangles = mesh.triangles;
  view.neighbours = mesh.neighbours.data();
  view.constrained = mesh.constrained.data();
  view.added = mesh.added_on_grid;
  return verify_refined(work.points, work.constraints, view, mesh.statistics.grid, options).reason;
}

/// Triangle's time for the switches, and its triangles.
void add_peer(Object& row, const std::string& name, const std::string& command, const std::string& switches,
              const std::string& file, int runs) {
  Peer peer(command + " '" + switches + "'");
  if (peer.name().empty()) {
    std::fprintf(stderr, "no peer by: %s\n", command.c_str());
    return;
  }
  const PeerTimes times = peer.time(file, runs, peer_seconds);
  if (!times.error.empty()) {
    row.add(name + "_error", times.error);
    return;
  }
  row.add(name, peer.name()).add(name + "_switches", switches).add(name + "_ms", median(times.ms));
  row.add(name + "_triangles", times.triangles);
  if (times.vertices == 0) return;
  row.add(name + "_vertices", times.vertices).add(name + "_least_angle", times.least_angle);
}

bool run(Solver& solver, const Task& task, const Arguments& arguments) {
  const Workload work = work_of(task);
  const Options options = options_of(task, work.points.size(), arguments.check);
  Triangulation mesh;
  Array<std::array<std::uint32_t, 3>> again;
  const Times times = time(solver, work, options, arguments.runs, mesh, again);
  const std::string found = fault(work, options, mesh, again);
  const Statistics& s = mesh.statistics;
  const auto count = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  Object row;
  row.add("workload", task.input.name).add("size", count(task.input.size)).add("device", s.device);
  row.add("angle", task.angle);
  if (task.most_area < HUGE_VAL)  // of a square with sides of 1
    row.add("most_area", task.most_area).add("length_ratio", 1 / std::sqrt(task.most_area));
  row.add("least_angle", times.least_angle);
  row.add("n", count(s.n)).add("m", count(s.m)).add("added", count(s.refine.added));
  row.add("triangles", count(s.triangles)).add("rounds", count(s.refine.rounds)).add("complete", s.refine.complete);
  const auto& r = s.refine;
  row.add("left",
          count(r.left_input_angle + r.left_beside_angle + r.left_grid + r.left_fixed + r.left_refused + r.left_limit));
  row.add("refine_ms", median(times.refine));
  row.add("least_refine_ms", *std::min_element(times.refine.begin(), times.refine.end()));
  row.add("result_ms", median(times.result)).add("call_ms", median(times.call)).add("plain_ms", median(times.plain));
  row.add("launches", count(s.launches)).add("read_backs", count(s.read_backs));
  row.add("peak_device_bytes", count(s.peak_device_bytes)).add("checked", options.check);
  if (!arguments.peer.empty() || !arguments.cgal.empty()) {
    const std::string file = arguments.scratch + "/gcdt_bench_refine_" + std::to_string(getpid()) + ".pslg";
    write_pslg(work, file);
    const bool constrained = !work.constraints.empty();
    const std::string switches = task.switches(constrained, false);
    if (!arguments.peer.empty()) {
      add_peer(row, "peer", arguments.peer, switches, file, arguments.runs);
      add_peer(row, "plain_peer", arguments.peer, task.switches(constrained, true), file, arguments.runs);
    }
    if (!arguments.cgal.empty() && task.most_area == HUGE_VAL)  // Mesh_2 has no bound of areas
      add_peer(row, "cgal", arguments.cgal, switches, file, arguments.runs);
    std::remove(file.c_str());
  }
  row.add("verified_by", mesh.representative.size() > largest_proved ? "device check" : "verify_refined");
  row.add("verified", found.empty()).add("fault", found).add("date", date());
  std::printf("%s\n", row.text().c_str());
  std::fflush(stdout);
  return found.empty();
}

bool parse(int count, char** words, Arguments& a) {
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--no-check") {
      a.check = false;
      continue;
    }
    if (i + 1 == count) return false;
    const std::string value = words[++i];
    if (word == "--device")
      a.device = value;
    else if (word == "--only")
      a.only = value;
    else if (word == "--peer")
      a.peer = value;
    else if (word == "--cgal")
      a.cgal = value;
    else if (word == "--scratch")
      a.scratch = value;
    else if (word == "--map")
      a.maps.push_back(value);
    else if (word == "--most")
      a.most = std::strtoull(value.c_str(), nullptr, 10);
    else if (word == "--runs")
      a.runs = std::atoi(value.c_str());
    else
      return false;
  }
  return a.runs > 0;
}

}  // namespace

int main(int count, char** words) {
  Arguments arguments;
  if (!parse(count, words, arguments)) return std::fputs(usage, stderr), 2;
  try {
    Solver solver(arguments.device);
    bool right = true;
    for (const Task& task : tasks(arguments)) right = run(solver, task, arguments) && right;
    return right ? 0 : 1;
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "gcdt_bench_refine: %s\n", error.what()), 4;
  }
}

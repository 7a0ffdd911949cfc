// SPDX-License-Identifier: Apache-2.0
// Times one problem in tiles, step by step, beside one call on one device, compares all arrays, and counts what the
// host needs beside input and result. Prints a row of JSON for each input and number of tiles (bench/README.md,
// "Tiles"). Reaches the internals through the static library.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "api/state.hpp"
#include "host_heap.hpp"
#include "inputs.hpp"
#include "pinned.hpp"
#include "tiles/join.hpp"
#include "tiles/tiled.hpp"

namespace {

using namespace gcdt;

constexpr char usage[] =
    "gcdt_bench_tiles [--device SPEC,...] [--parts P] [--tiles K,...] [--memory MB] [--spill FOLDER]\n"
    "                 [--crossing reject|drop|split] [--runs R] [--alone yes|no] [--most-host-bytes B]\n"
    "                 [--spans yes|no] [--pinned yes|no] [--copy-threads T] INPUT...\n"
    "  INPUT     NAME:SIZE of a recipe (bench/README.md), or a .poly file\n"
    "  --parts   each device is divided into P of as many compute units\n"
    "  --tiles   0: as many as memory asks for; default: the number of devices\n"
    "  --alone   no: without the one call that times and arrays are compared with\n"
    "  --most-host-bytes\n"
    "            a vertex, beside input and result; more is a fault\n"
    "  --spans   yes: after each row, where the time of one more call goes, by span (gcdt_trace_span)\n"
    "  --pinned  yes: between arrays that the driver pinned; one_ms stays what it is, from vectors\n"
    "  --copy-threads\n"
    "            to and from each device of the pool (Tuning::copy_threads)\n"
    "  R: timed calls, 3, after one more if there are several\n";

struct Arguments {
  std::string devices = "auto", spill;
  std::vector<bench::Input> inputs;
  std::vector<std::uint32_t> tiles;
  std::uint32_t parts = 1;
  std::uint64_t memory = 0;
  Options options;
  int runs = 3;
  bool alone = true, spans = false, pinned = false;
  double most_host_bytes = 0;
  std::optional<std::uint32_t> copy_threads;
};

std::vector<std::uint32_t> numbers_of(const std::string& text) {
  std::vector<std::uint32_t> all;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');) all.push_back(static_cast<std::uint32_t>(std::stoul(word)));
  return all;
}

bench::Input input_of(const std::string& word) {
  const std::size_t colon = word.rfind(':');
  if (colon == std::string::npos) return {word, 0, word};
  return {word.substr(0, colon), std::stoul(word.substr(colon + 1)), ""};
}

Arguments read(int count, char** words) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word.rfind("--", 0) != 0) {
      arguments.inputs.push_back(input_of(word));
      continue;
    }
    if (i + 1 == count) throw std::invalid_argument(word);
    const std::string value = words[++i];
    if (word == "--device")
      arguments.devices = value;
    else if (word == "--parts")
      arguments.parts = std::max(numbers_of(value).at(0), 1u);
    else if (word == "--tiles")
      arguments.tiles = numbers_of(value);
    else if (word == "--memory")
      arguments.memory = std::stoull(value) << 20;
    else if (word == "--spill")
      arguments.spill = value;
    else if (word == "--runs")
      arguments.runs = std::max(std::stoi(value), 1);
    else if (word == "--alone")
      arguments.alone = value != "no";
    else if (word == "--spans")
      arguments.spans = value == "yes";
    else if (word == "--pinned")
      arguments.pinned = value == "yes";
    else if (word == "--copy-threads")
      arguments.copy_threads = numbers_of(value).at(0);
    else if (word == "--most-host-bytes")
      arguments.most_host_bytes = std::stod(value);
    else if (word == "--crossing")
      arguments.options.crossing = value == "split"  ? Crossing::split
                                   : value == "drop" ? Crossing::drop
                                                     : Crossing::reject;
    else
      throw std::invalid_argument(word);
  }
  if (arguments.inputs.empty()) throw std::invalid_argument("no input");
  return arguments;
}

std::vector<cl::Device> devices_of(const Arguments& arguments) {
  const std::vector<cl::Device> all = runtime::all_devices();
  static std::vector<cl::Device> chosen;  // for good: PoCL's contexts do not keep their sub-devices
  for (const std::size_t number : runtime::choose_devices(arguments.devices)) {
    cl::Device device = all.at(number);
    if (arguments.parts == 1) {
      chosen.push_back(device);
      continue;
    }
    const cl_uint units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>() / arguments.parts;
    const cl_device_partition_property equally[] = {CL_DEVICE_PARTITION_EQUALLY,
                                                    static_cast<cl_device_partition_property>(units), 0};
    std::vector<cl::Device> parts;
    if (units == 0 || device.createSubDevices(equally, &parts) != CL_SUCCESS || parts.size() < arguments.parts)
      throw std::runtime_error("a device cannot be divided into " + std::to_string(arguments.parts));
    parts.resize(arguments.parts);
    chosen.insert(chosen.end(), parts.begin(), parts.end());
  }
  return chosen;
}

/// The names of the arrays that differ, each with a blank before it.
std::string difference(const ForestResult& made, const Triangulation& expected) {
  std::string names;
#define GCDT_ARRAY(number, name, ...)                                                                                 \
  {                                                                                                                   \
    using Element = decltype(expected.name)::value_type;                                                              \
    const Span<Element> own = made.begins[number].empty() ? Span<Element>() : tiles::array_of<Element>(made, number); \
    if (own.size() != expected.name.size() ||                                                                         \
        (!own.empty() && std::memcmp(own.data(), expected.name.data(), own.size() * sizeof(Element)) != 0))           \
      names += " " #name;                                                                                             \
  }
#include <gcdt/arrays.def>
  return names;
}

std::int64_t result_bytes(const ForestResult& made) {
  std::uint64_t bytes = 0;
#define GCDT_ARRAY(number, name, ...)                                                  \
  if (!made.begins[number].empty() && !made.arrays[number].bytes.get_deleter().source) \
    bytes += made.begins[number].back() * sizeof(decltype(Triangulation::name)::value_type);
#include <gcdt/arrays.def>
  return static_cast<std::int64_t>(bytes);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

double milliseconds_of(const std::function<void()>& use) {
  const auto begin = std::chrono::steady_clock::now();
  use();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// A pool of all devices, and a solver on the first one: one of each for all inputs, since programs take long to load.
class Devices {
 public:
  Devices(const Arguments& arguments, const std::vector<cl::Device>& devices)
      : arguments_(arguments), devices_(devices) {
    auto handle = std::make_unique<gcdt_solver>();
    handle->state =
        std::make_shared<api::State>(cl::Context(), devices[0], runtime::Log(), Trace(), runtime::CallHook());
    solver = std::make_unique<Solver>(handle.release());
    pool = pool_with({});
  }

  std::unique_ptr<DevicePool> pool_with(Trace trace) const {
    std::vector<DevicePool::Member> members;
    for (const cl::Device& device : devices_) {
      members.push_back({cl::Context(), device, {}});
      Tuning& tuning = members.back().hook.tuning;
      if (arguments_.memory > 0) tuning.memory_bytes = arguments_.memory;
      tuning.copy_threads = arguments_.copy_threads.value_or(tuning.copy_threads);
    }
    auto made = std::make_unique<DevicePool>(std::move(members), runtime::Log(), std::move(trace));
    made->spill_to(arguments_.spill);
    if (arguments_.pinned) made->pin_results();
    return made;
  }
  std::size_t size() const { return devices_.size(); }
  /// The first GPU, whose driver pins memory; else the first one.
  DeviceInfo that_pins() const {
    for (const cl::Device& device : devices_)
      if (const DeviceInfo info = runtime::describe(device, {}); info.is_gpu) return info;
    return runtime::describe(devices_[0], {});
  }

  std::unique_ptr<Solver> solver;
  std::unique_ptr<DevicePool> pool;

 private:
  const Arguments& arguments_;
  const std::vector<cl::Device>& devices_;
};

/// One input: the pool's calls and, by turns with them, those of one device.
class Row {
 public:
  Row(const Arguments& arguments, Devices& devices, const bench::Input& input)
      : arguments_(arguments),
        devices_(devices),
        input_(input),
        work_(bench::make(input, [&](const std::vector<bench::Point>& points) {
          return devices.solver->triangulate(points).triangles;
        })) {
    if (!arguments.pinned) return;
    pinned_.emplace(devices.that_pins());
    pinned_->take(work_.points, work_.constraints);
  }

  /// Returns whether there was no fault.
  bool measure(std::uint32_t tiles) {
    std::vector<double> one, one_pinned, all;
    std::array<std::vector<double>, 5> steps;
    std::string fault;
    for (int run = arguments_.runs > 1 ? -1 : 0; run < arguments_.runs && fault.empty(); ++run) {
      double ms_one = 0, ms_all = 0;
      const double ms_one_pinned = pinned_ ? pinned_->call(arguments_.options, true) : 0;
      if (arguments_.alone) ms_one = milliseconds_of([&] { expected_ = alone(); });
      fault = call(tiles, ms_all);
      if (run < 0 || !fault.empty()) continue;
      one.push_back(ms_one), one_pinned.push_back(ms_one_pinned), all.push_back(ms_all);
      for (std::size_t i = 0; i < steps.size(); ++i)
        steps[i].push_back(
            std::array{report_.ms_share, report_.ms_tiles, report_.ms_seam, report_.ms_write, report_.ms_join}[i]);
    }
    if (fault.empty() && arguments_.most_host_bytes > 0 && host_bytes_ > arguments_.most_host_bytes)
      fault = "the host needs more bytes a vertex than it may";
    std::array<double, 5> medians{};
    for (std::size_t i = 0; i < steps.size(); ++i) medians[i] = median(steps[i]);
    print(median(one), median(one_pinned), median(all), medians, fault);
    if (arguments_.spans && fault.empty()) print_spans(tiles);
    return fault.empty();
  }

 private:
  /// Of the second call of a pool that has profiling: phases as the host saw them, and in each what the device did.
  void print_spans(std::uint32_t tiles) {
    struct Sum {
      double host_ms = 0, device_ms = 0;
      int times = 0;
    };
    std::map<std::string, Sum> sums;
    std::unique_ptr<DevicePool> pool = devices_.pool_with([&](const TraceSpan& span) {
      if (span.phase == "plan") return;  // no span, but a word
      const double ms = static_cast<double>(span.end_ns - span.begin_ns) / 1e6;
      Sum& phase = sums[std::to_string(span.device_number) + " " + span.phase];
      if (span.on_device) {
        phase.device_ms += ms;
      } else if (span.name == span.phase) {
        phase.host_ms += ms, ++phase.times;
      } else {
        Sum& step = sums[std::to_string(span.device_number) + " " + span.phase + " / " + span.name];
        step.host_ms += ms, ++step.times;
      }
    });
    devices_.pool.swap(pool);
    double ms = 0;
    call(tiles, ms);
    sums.clear();
    call(tiles, ms);
    devices_.pool.swap(pool);
    std::printf("%.1f ms with a trace\n", ms);
    for (const auto& [name, sum] : sums)
      std::printf("  %-40s %4d times %9.1f ms, device %9.1f\n", name.c_str(), sum.times, sum.host_ms, sum.device_ms);
    std::fflush(stdout);
  }

  std::unique_ptr<Triangulation> alone() {
    expected_.reset();
    return std::make_unique<Triangulation>(
        devices_.solver->triangulate(work_.points, work_.constraints, arguments_.options));
  }

  /// What is wrong with it, if anything is.
  std::string call(std::uint32_t tiles, double& ms) {
    const std::array<std::uint64_t, 2> n{0, work_.points.size()}, m{0, work_.constraints.size()};
    BatchInput batch{1, Points::Type::float64, work_.points.data(), n.data(), work_.constraints.data(), m.data()};
    Options options = arguments_.options;
    options.pinned = arguments_.pinned;
    if (pinned_) batch.vertices = pinned_->points().data(), batch.constraints = pinned_->constraints().data();
    options.tiles = tiles;
    PoolResult made;
    const std::int64_t before = bench::heap_in_use();
    bench::take_heap_peak();
    ms = milliseconds_of([&] { made = tiles::triangulate(*devices_.pool, batch, options); });
    const std::int64_t peak = bench::take_heap_peak();
    if (!made.errors.empty()) return made.errors.begin()->second.what();
    const ForestResult& result = *made.at(0).first;
    report_ = result.tiles;
    host_bytes_ = static_cast<double>(peak - before - result_bytes(result)) / static_cast<double>(n[1]);
    const std::string differing = expected_ ? difference(result, *expected_) : "";
    return differing.empty() ? "" : "other bytes:" + differing;
  }

  void print(double one, double one_pinned, double all, const std::array<double, 5>& steps,
             const std::string& fault) const {
    std::printf("{\"name\": \"%s\", \"n\": %zu, \"m\": %zu, \"devices\": %zu, \"tiles\": %u, \"call_ms\": %.1f",
                input_.name.c_str(), work_.points.size(), work_.constraints.size(), devices_.size(), report_.tiles,
                all);
    if (arguments_.alone)
      std::printf(", \"one_ms\": %.1f, \"speedup\": %.3f, \"same_bytes\": %s", one, one / all,
                  fault.empty() ? "true" : "false");
    if (pinned_) std::printf(", \"one_pinned_ms\": %.1f, \"pinned_speedup\": %.3f", one_pinned, one_pinned / all);
    const char* const names[] = {"share", "tiles", "seam", "write", "join"};
    for (std::size_t i = 0; i < steps.size(); ++i) std::printf(", \"%s_ms\": %.1f", names[i], steps[i]);
    std::printf(", \"seam_vertices\": %llu, \"seam_constraints\": %llu, \"seam_fraction\": %.5f",
                static_cast<unsigned long long>(report_.seam_vertices),
                static_cast<unsigned long long>(report_.seam_constraints),
                static_cast<double>(report_.seam_vertices) / static_cast<double>(work_.points.size()));
    if (bench::counts_heap()) std::printf(", \"host_bytes_per_vertex\": %.1f", host_bytes_);
    if (!fault.empty()) std::printf(", \"fault\": \"%s\"", fault.c_str());
    std::printf("}\n");
    std::fflush(stdout);
  }

  const Arguments& arguments_;
  Devices& devices_;
  const bench::Input& input_;
  const bench::Workload work_;
  std::unique_ptr<Triangulation> expected_;
  TiledReport report_;
  double host_bytes_ = 0;
  std::optional<bench::PinnedCaller> pinned_;
};

}  // namespace

int main(int count, char** words) try {
  Arguments arguments = read(count, words);
  const std::vector<cl::Device> chosen = devices_of(arguments);
  if (arguments.tiles.empty()) arguments.tiles.push_back(static_cast<std::uint32_t>(chosen.size()));
  Devices devices(arguments, chosen);
  bool right = true;
  for (const bench::Input& input : arguments.inputs) {
    Row row(arguments, devices, input);
    for (const std::uint32_t tiles : arguments.tiles) right = row.measure(tiles) && right;
  }
  return right ? 0 : 1;
} catch (const std::logic_error& error) {  // of words that are no arguments
  std::fprintf(stderr, "gcdt_bench_tiles: %s\n%s", error.what(), usage);
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "gcdt_bench_tiles: %s\n", error.what());
  return 1;
}

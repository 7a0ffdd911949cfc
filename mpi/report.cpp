// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "statistics.hpp"

namespace gcdt::ranks {

namespace {

template <std::size_t N>
void copy_name(const std::string& from, std::array<char, N>& to) {
  std::copy_n(from.begin(), std::min(from.size(), N - 1), to.begin());
}

command::Measured measured(const std::vector<RankReport>& ranks) {
  command::Measured made;
  made.tiles.tiles = static_cast<std::uint32_t>(ranks[0].tiles);
  made.tiles.seam_vertices = ranks[0].seam_vertices;
  return made;
}

}  // namespace

Report::Report(MpiTeam& team) : team_(team) {
  char name[MPI_MAX_PROCESSOR_NAME + 1] = {};
  int length = 0;
  MPI_Get_processor_name(name, &length);
  copy_name(name, own_.host);
}

double& Report::step(const std::string& name) {
  const auto found = std::find(step_names.begin(), step_names.end(), name);
  return own_.milliseconds.at(static_cast<std::size_t>(found - step_names.begin()));
}

void Report::add(const tiles::RankResult& made, const DevicePool& pool, double milliseconds) {
  const ForestResult& result = made.part.result;
  const TiledReport& tiles = result.tiles;
  step("share") = tiles.ms_share, step("exchange") = made.ms_exchange, step("tiles") = tiles.ms_tiles;
  step("seam") = tiles.ms_seam, step("final") = tiles.ms_write, step("join") = tiles.ms_join;
  step("solve") = milliseconds;
  own_.vertices = made.own.numbers.size();
  own_.triangles = result.begins[GCDT_TRIANGLES].back();
  own_.seam_vertices = tiles.seam_vertices, own_.seam_constraints = tiles.seam_constraints;
  own_.tiles = tiles.tiles;
  copy_name(pool.report(0).info.name, own_.device);
  own_.sent = team_.sent() - sent_before_, own_.received = team_.received() - received_before_;
  sent_before_ = team_.sent(), received_before_ = team_.received();
}

std::vector<RankReport> Report::gathered() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  own_.peak_host_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  std::vector<RankReport> all = {own_};
  gather(team_, all);
  return all;
}

void describe(const std::vector<RankReport>& ranks, Statistics& statistics) {
  const auto slowest = [&](const std::string& name) {
    const auto at =
        static_cast<std::size_t>(std::find(step_names.begin(), step_names.end(), name) - step_names.begin());
    double most = 0;
    for (const RankReport& rank : ranks) most = std::max(most, rank.milliseconds[at]);
    return most;
  };
  statistics.ms.read = slowest("read"), statistics.ms.call = slowest("solve"), statistics.ms.write = slowest("write");
  statistics.version = version();
  for (const RankReport& rank : ranks)
    statistics.device += (statistics.device.empty() ? "" : ", ") + std::string(rank.device.data());
}

std::string report_json(const Statistics& statistics, const std::vector<RankReport>& ranks) {
  auto json = nlohmann::ordered_json::parse(command::statistics_json(statistics, measured(ranks)));
  for (const RankReport& rank : ranks) {
    nlohmann::ordered_json one = {{"host", rank.host.data()},
                                  {"device", rank.device.data()},
                                  {"vertices", rank.vertices},
                                  {"triangles", rank.triangles},
                                  {"bytes_sent", rank.sent},
                                  {"bytes_received", rank.received},
                                  {"peak_host_bytes", rank.peak_host_bytes}};
    for (std::size_t i = 0; i < step_names.size(); ++i) one["ms"][step_names[i]] = rank.milliseconds[i];
    json["ranks"].push_back(one);
  }
  json["tiles"]["seam_constraints"] = ranks[0].seam_constraints;
  return json.dump(2) + "\n";
}

std::string report_table(const Statistics& statistics, const std::vector<RankReport>& ranks) {
  std::string table = command::statistics_table(statistics, measured(ranks));
  table += "rank     vertices    triangles    MB sent     MB host";
  for (const char* name : step_names) table += fmt::format("{:>10}", name);
  table += " (ms)  device\n";
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    const RankReport& rank = ranks[i];
    table += fmt::format("{:<4} {:>12} {:>12} {:>10.1f} {:>11.1f}", i, rank.vertices, rank.triangles,
                         static_cast<double>(rank.sent) / 1e6, static_cast<double>(rank.peak_host_bytes) / 1e6);
    for (const double ms : rank.milliseconds) table += fmt::format("{:>10.1f}", ms);
    table += fmt::format("       {} ({})\n", rank.device.data(), rank.host.data());
  }
  return table;
}

}  // namespace gcdt::ranks

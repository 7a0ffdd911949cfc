// SPDX-License-Identifier: Apache-2.0
// Options, grids, devices and statistics.
#include <array>
#include <utility>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include "options.hpp"

namespace gcdt::python {

namespace {

template <class Enum, std::size_t n>
Enum named(const std::string& name, const char* what, const std::array<std::pair<const char*, Enum>, n>& names) {
  std::string known;
  for (const auto& [word, value] : names) {
    if (name == word) return value;
    known += std::string(known.empty() ? "" : ", ") + word;
  }
  throw Error(Status::invalid_argument, std::string(what) + " is one of " + known + ", not " + name);
}

Crossing crossing_named(const std::string& name) {
  static const std::array<std::pair<const char*, Crossing>, 3> names = {
      {{"reject", Crossing::reject}, {"drop", Crossing::drop}, {"split", Crossing::split}}};
  return named(name, "crossing", names);
}

Domain domain_named(const std::string& name) {
  static const std::array<std::pair<const char*, Domain>, 6> names = {{{"hull", Domain::hull},
                                                                       {"even-odd", Domain::even_odd},
                                                                       {"nonzero", Domain::nonzero},
                                                                       {"holes", Domain::holes},
                                                                       {"outer", Domain::outer},
                                                                       {"outer-holes", Domain::outer_holes}}};
  return named(name, "domain", names);
}

Splits splits_named(const std::string& name) {
  static const std::array<std::pair<const char*, Splits>, 3> names = {
      {{"all", Splits::all}, {"inner", Splits::inner}, {"none", Splits::none}}};
  return named(name, "splits", names);
}

std::vector<double> numbers(const Row<double>& row) {
  const auto all = span(row);
  return {all.begin(), all.end()};
}

constexpr const char* grid_kinds[] = {"binary", "decimal", "rounded", "fixed"};

std::vector<std::array<double, 2>> seeds(const Rows<double, 2>& rows) {
  const auto all = span(rows);
  return {all.begin(), all.end()};
}

/// Puts `value` to the place that a name such as "ms.call" has.
template <class T>
void put(nb::dict& all, const std::string& name, const T& value) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) {
    all[name.c_str()] = value;
    return;
  }
  const std::string group = name.substr(0, dot);
  if (!all.contains(group.c_str())) all[group.c_str()] = nb::dict();
  nb::cast<nb::dict>(all[group.c_str()])[name.substr(dot + 1).c_str()] = value;
}

}  // namespace

nb::dict grid_dict(const Grid& grid) {
  nb::dict d;
  d["kind"] = grid_kinds[static_cast<int>(grid.kind)];
  d["origin"] = nb::make_tuple(grid.origin[0], grid.origin[1]);
  d["cell"] = grid.cell();
  d["cell_units"] = grid.cell_units;
  d["cell_decimals"] = grid.cell_decimals;
  d["cell_exponent"] = grid.cell_exponent;
  d["largest_move"] = grid.largest_move;
  return d;
}

Grid grid_of(const nb::dict& d) {
  Grid grid;
  const auto kind = nb::cast<std::string>(d["kind"]);
  for (int k = 0; k < 4; ++k)
    if (kind == grid_kinds[k]) grid.kind = static_cast<Grid::Kind>(k);
  const auto origin = nb::cast<std::pair<double, double>>(d["origin"]);
  grid.origin = {origin.first, origin.second};
  grid.cell_units = nb::cast<std::uint64_t>(d["cell_units"]);
  grid.cell_decimals = nb::cast<int>(d["cell_decimals"]);
  grid.cell_exponent = nb::cast<int>(d["cell_exponent"]);
  grid.largest_move = nb::cast<double>(d["largest_move"]);
  return grid;
}

nb::dict device_dict(const DeviceInfo& info) {
  nb::dict d;
  d["name"] = info.name, d["vendor"] = info.vendor, d["platform"] = info.platform;
  d["driver"] = info.driver, d["version"] = info.version;
  d["is_gpu"] = info.is_gpu, d["is_cpu"] = info.is_cpu;
  d["memory_bytes"] = info.memory_bytes, d["largest_buffer_bytes"] = info.largest_buffer_bytes;
  d["local_bytes"] = info.local_bytes, d["compute_units"] = info.compute_units;
  d["largest_work_group"] = info.largest_work_group;
  d["atomics64"] = info.atomics64, d["fp64"] = info.fp64, d["subgroups"] = info.subgroups;
  return d;
}

nb::dict statistics_dict(const Statistics& s) {
  nb::dict d;
#define GCDT_STATISTIC(c, name) put(d, #name, s.name);
#define GCDT_STATISTIC_HIDDEN GCDT_STATISTIC
#define GCDT_STATISTIC_TEXT GCDT_STATISTIC
#include <gcdt/statistics.def>
  d["grid"] = grid_dict(s.grid);
  d["rounded_pair"] = nb::make_tuple(s.rounded_pair[0], s.rounded_pair[1]);
  d["notes"] = s.notes;
  return d;
}

void bind_options(nb::module_& m) {
  nb::class_<GivenRefinement>(m, "Refinement", "What is to be refined to; see gcdt.Refinement.")
      .def(
          "__init__",
          [](GivenRefinement* self, double least_angle, double most_area, const Row<double>& region_areas,
             const Row<double>& sizes, bool conforming, const std::string& splits, double least_length,
             const std::optional<std::uint64_t>& most_added) {
            new (self) GivenRefinement{{}, numbers(region_areas), numbers(sizes)};
            Refinement& r = self->wanted;
            r.least_angle = least_angle, r.most_area = most_area, r.least_length = least_length;
            r.conforming = conforming, r.splits = splits_named(splits);
            if (most_added) r.most_added = *most_added;
          },
          nb::arg("least_angle"), nb::arg("most_area"), nb::arg("region_areas"), nb::arg("sizes"),
          nb::arg("conforming"), nb::arg("splits"), nb::arg("least_length"), nb::arg("most_added").none());
  nb::class_<CallOptions>(m, "Options", "What a call is to do; see gcdt.triangulate_pslg.")
      .def(
          "__init__",
          [](CallOptions* self, const std::string& crossing, const std::string& domain, const Rows<double, 2>& holes,
             const Rows<double, 2>& regions, bool label_regions,
             const std::optional<std::pair<std::pair<double, double>, std::string>>& grid, bool check, bool canonical,
             bool distinct, nb::object progress, const std::optional<GivenRefinement>& refine) {
            new (self) CallOptions{{}, std::move(progress), refine};
            Options& o = self->options;
            o.crossing = crossing_named(crossing), o.domain = domain_named(domain);
            o.hole_seeds = seeds(holes), o.region_seeds = seeds(regions), o.regions = label_regions;
            if (grid) o.grid = FixedGrid{grid->first.first, grid->first.second, grid->second};
            o.check = check, o.canonical = canonical, o.distinct = distinct;
          },
          nb::arg("crossing"), nb::arg("domain"), nb::arg("holes"), nb::arg("regions"), nb::arg("label_regions"),
          nb::arg("grid").none(), nb::arg("check"), nb::arg("canonical"), nb::arg("distinct"),
          nb::arg("progress").none(), nb::arg("refine").none())
      .def(
          "refined",
          [](const CallOptions& self, const GivenRefinement& refine) {
            CallOptions made = self;
            made.refine = refine;
            return made;
          },
          nb::arg("refine"), "The same with another refinement.");
  m.def(
      "devices",
      [] {
        std::vector<DeviceInfo> found;
        {
          nb::gil_scoped_release release;
          found = devices();
        }
        nb::list all;
        for (const DeviceInfo& info : found) all.append(device_dict(info));
        return all;
      },
      "All OpenCL devices that the library can use, as dictionaries.");
  m.def(
      "required_bytes",
      [](std::uint64_t n, std::uint64_t constraints, std::optional<std::uint64_t> crossed) {
        return required_bytes(n, constraints, crossed.value_or(~std::uint64_t(0)));
      },
      nb::arg("vertices"), nb::arg("constraints"), nb::arg("crossed").none() = nb::none());
  m.def("version", &version);
}

}  // namespace gcdt::python

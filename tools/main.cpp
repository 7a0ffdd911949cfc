// SPDX-License-Identifier: Apache-2.0
// The command gcdt: arguments in, status out.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <new>

#include "command.hpp"
#include "completion.hpp"
#include "minimise.hpp"
#include "progress.hpp"
#include "triangle_switches.hpp"

namespace {

using namespace gcdt;

constexpr const char* triangulate_help =
    "Inputs by extension: .poly .node of Triangle; .geojson .wkt .wkb geometries; .json also bare rings; .csv points;\n"
    ".npz .npy arrays of NumPy; .pslg binary; .txt of CDT; .obj .off .ply edges of surfaces; .shp .gpkg .fgb .dxf by\n"
    "GDAL, if built with it.\n"
    "Outputs by extension: .ele triangles, .neigh neighbours, .edge edges (marker 1: constrained, 0: not),\n"
    ".node vertices, .poly .pslg vertices and cleaned constraints, .vtu for ParaView, .npz all arrays, .npy "
    "triangles,\n"
    ".ply .obj .off surfaces, .msh for gmsh, .geojson polygons; .svg .png .pdf pictures. All files appear together or\n"
    "not at all. Without -o the statistics are printed.\n\n";

constexpr const char* verify_help =
    "OUTPUT is an .ele file, a .neigh file with the .ele beside it, or a .vtu file. The grid is taken from\n"
    "OUTPUT if it holds one, else from --grid, else chosen as triangulate does.\n\n";

constexpr const char* batch_help =
    "Inputs that fail are listed, and the others are written; the status is then that of the first that failed.\n"
    "Without -o the statistics are printed. The outputs of line 17 of NAME.geojsonl are NAME-17.ele and so on; "
    "NAME.jsonl "
    "has a\nline for each of its problems, {\"line\": 17, \"triangles\": [[0, 1, 2]], \"constrained\": [7]}, whose "
    "vertices "
    "are the\nline's positions in their order (a ring's last one excepted), or {\"line\": 17, \"error\": ...}.\n\n";

constexpr const char* locate_help =
    "One line a point: its number, the triangle (as triangulate numbers them, or as a mesh file does; the least of\n"
    "several; -1 outside), the barycentric weights of the triangle's corners, and each attribute of the vertices "
    "there\n"
    "(nan outside). A mesh file is refused with status 5 if its triangles overlap or are not counter-clockwise.\n\n";

constexpr const char* raster_help =
    "The cells begin at the least x and y. .asc is the Arc/Info ASCII grid; .flt has float32 with a .hdr; .png is "
    "grey\n"
    "from the least value to the largest, and transparent outside. Each has a world file beside it (.acw .ftw "
    ".pgw).\n\n";

constexpr const char* view_help =
    "PAGE.html is one file that a browser opens without a server and without a network. It shows up to some millions "
    "of\n"
    "triangles with WebGL 2, by region, smallest angle or attribute, and of the triangle under the pointer its "
    "corners\n"
    "and the input's constraints along its edges. What stands after # in its address (x, y, scale, colour,\n"
    "pick=X,Y) says what is shown at first.\n\n";

constexpr const char* minimise_help =
    "COMMAND is one for a shell, in which {} is the name of a .poly file, or which has that name as its last word. "
    "The\n"
    "check fails where the command's status is not 0. Whatever is left out or made smaller, it goes on failing with "
    "the\n"
    "status that it has for INPUT: constraints and vertices are left out, then coordinates made smaller.\n\n";

constexpr const char* status_help =
    "Status: 0 done; 2 wrong usage; 3 the input cannot be read or is invalid; 4 no device, or it failed or\n"
    "ran out of memory; 5 a check failed; 6 an output cannot be written, or nothing spilled; 130 interrupted.";

constexpr const char* grid_help =
    "Round the vertices to this grid: its least corner X,Y and the edge CELL of a cell, a decimal number; "
    "default: the finest that fits the input";

constexpr const char* device_help =
    "auto (a GPU if there is one, else a CPU), cpu, gpu, a number from \"gcdt devices\", or a part of a name; "
    "default: the variable GCDT_DEVICE, else auto";

void add_crossing(CLI::App& app, std::string& crossing) {
  app.add_option("--crossing", crossing,
                 "What happens to constraints that cross: reject (an error that lists them), drop (all that cross an "
                 "earlier one) or split (crossings become vertices, rounded to the grid)")
      ->check(CLI::IsMember({"reject", "drop", "split"}).description(""))
      ->type_name("reject|drop|split")
      ->capture_default_str();
}

void add_domain(CLI::App& app, std::string& domain) {
  app.add_option("--domain", domain,
                 "Which triangles are kept: hull (all), even-odd or nonzero (by how often the constraints wind around "
                 "them), holes (all but the regions with a hole point of the input), outer (all but what is open to "
                 "the outside), outer-holes (both)")
      ->check(CLI::IsMember({"hull", "even-odd", "nonzero", "holes", "outer", "outer-holes"}).description(""))
      ->type_name("hull|even-odd|nonzero|holes|outer|outer-holes")
      ->capture_default_str();
}

void add_colour(CLI::App& app, std::string& colour) {
  app.add_option("--colour", colour,
                 "What the triangles of pictures (.svg, .png, .pdf) are coloured by: region, where there are any, or "
                 "angle, the least one of each, with the histogram below")
      ->check(CLI::IsMember({"region", "angle"}).description(""))
      ->type_name("region|angle")
      ->capture_default_str();
}

void add_distinct(CLI::App& app, bool& distinct) {
  app.add_flag("--distinct", distinct, "Refuse input of which rounding to the grid makes vertices one that differ");
}

void add_triangle(CLI::App& app, command::TriangulateArguments& arguments) {
  CLI::Option* triangle =
      app.add_option("--triangle", arguments.triangle,
                     "Switches of Triangle, such as pq30a0.1A, say what is done: p q a A D Y YY S e n c j z Q; without "
                     "-o files are named as Triangle's: NAME.1.node, .ele and so on")
          ->type_name("SWITCHES");
  for (const char* other : {"--crossing", "--domain", "--regions", "--refine", "--tiles", "--memory", "--spill"})
    triangle->excludes(app.get_option(other));
}

/// CLI11 takes -5 for 2^64 - 5. What is transformed last is looked at first.
CLI::Validator starts_with_digit() {
  const auto check = [](std::string& text) {
    return !text.empty() && text[0] >= '0' && text[0] <= '9' ? std::string() : text + " is no size";
  };
  return CLI::Validator(check, "");
}

void add_triangulate(CLI::App& gcdt, command::TriangulateArguments& arguments) {
  CLI::App* app = gcdt.add_subcommand("triangulate", "Make the exact constrained Delaunay triangulation of INPUT");
  app->add_option("INPUT", arguments.input, "A file in one of the formats below, or - for a .poly on standard input")
      ->required()
      ->type_name("");
  app->add_option("-o,--output", arguments.outputs, "A file to write; may be given several times")
      ->allow_extra_args(false)
      ->type_name("OUTPUT");
  add_crossing(*app, arguments.crossing);
  add_domain(*app, arguments.domain);
  app->add_flag("--regions", arguments.regions,
                "Find region, depth and winding number of each triangle (in .vtu; region attributes in .ele too) where "
                "the domain is hull; other domains have them anyway");
  app->add_option("--grid", arguments.grid, grid_help)->type_name("X,Y,CELL");
  add_distinct(*app, arguments.distinct);
  command::add_refinement(*app, arguments.refine);
  add_colour(*app, arguments.colour);
  app->add_option("--device", arguments.device,
                  std::string(device_help) + "; several, separated by commas, or all, share the work in tiles")
      ->type_name("SPEC,...");
  app->add_option("--tiles", arguments.tiles,
                  "Cut the input into so many tiles, which the devices share; default: into as many as there must be "
                  "for the devices' memory, mostly one")
      ->check(CLI::Range(1u, GCDT_MAX_TILES).description(""))
      ->type_name("K");
  app->add_option("--memory", arguments.memory, "Use no more memory of each device than this, such as 512MB")
      ->transform(CLI::AsSizeValue(false).description(""))
      ->transform(starts_with_digit())
      ->type_name("SIZE");
  app->add_option("--spill", arguments.spill,
                  "Directory for files to which tiles go that devices have no room for; default: to memory")
      ->type_name("DIRECTORY");
  app->add_flag(
      "--assess", arguments.assess,
      "Say in the statistics whether the mesh is valid at the coordinates as they are given, before rounding");
  app->add_flag("--verify", arguments.verify,
                "Prove the result by exact arithmetic on the host before anything is written");
  app->add_option("--stats", arguments.statistics, "Write the statistics as JSON")->type_name("FILE.json");
  app->add_option("--trace", arguments.trace,
                  "Write where the time went, phase by phase and launch by launch, in Chrome's trace-event format")
      ->type_name("FILE.json");
  app->add_flag("--quiet", arguments.quiet, "Print errors only");
  app->footer(std::string(triangulate_help) + status_help);
  add_triangle(*app, arguments);
  app->callback([&arguments] {
    command::apply_triangle_switches(arguments);
    command::triangulate(arguments);
  });
}

void add_batch(CLI::App& gcdt, command::BatchArguments& arguments) {
  CLI::App* app = gcdt.add_subcommand("batch", "Triangulate many inputs in one call, on any number of devices");
  app->add_option("INPUT", arguments.inputs,
                  "What triangulate takes, a file with a GeoJSON text, so a problem, in each line (.geojsonl, .ndjson, "
                  ".geojsons), or a folder of them")
      ->required()
      ->type_name("");
  app->add_option("-o,--output", arguments.folder,
                  "The folder for the outputs, which have the inputs' names; made if "
                  "missing")
      ->type_name("DIR");
  app->add_option("--format", arguments.formats,
                  "What triangulate writes, such as ele, node, vtu, npz or svg, or jsonl (one file for an input with "
                  "many problems); may be given several times")
      ->allow_extra_args(false)
      ->type_name("FORMAT")
      ->capture_default_str();
  add_crossing(*app, arguments.crossing);
  add_domain(*app, arguments.domain);
  app->add_flag("--regions", arguments.regions,
                "Label the regions that constraints bound (.vtu; region attributes in .ele too)");
  app->add_option("--grid", arguments.grid, grid_help)->type_name("X,Y,CELL");
  add_distinct(*app, arguments.distinct);
  command::add_refinement(*app, arguments.refine);
  add_colour(*app, arguments.colour);
  app->add_option("--device", arguments.device,
                  "Devices, separated by commas: all, gpu, cpu, auto (all GPUs if there are any, else a CPU), numbers "
                  "from \"gcdt devices\", parts of names; default: the variable GCDT_DEVICE, else auto")
      ->type_name("SPEC,...");
  app->add_flag("--verify", arguments.verify, "Prove the results by exact arithmetic on the host");
  app->add_option("--stats", arguments.statistics, "Write counts, and the devices' shares, as JSON")
      ->type_name("FILE.json");
  app->add_option("--trace", arguments.trace,
                  "Write where the time went, device by device, in Chrome's trace-event format")
      ->type_name("FILE.json");
  app->add_flag("--quiet", arguments.quiet, "Print errors only");
  app->footer(std::string(batch_help) + status_help);
  app->callback([&arguments] { command::triangulate_batch(arguments); });
}

void add_verify(CLI::App& gcdt, command::VerifyArguments& arguments) {
  CLI::App* app =
      gcdt.add_subcommand("verify", "Prove that OUTPUT is the triangulation of INPUT, by exact arithmetic on the host");
  app->add_option("INPUT", arguments.input, "The file that was triangulated, or - for a .poly on standard input")
      ->required()
      ->type_name("");
  app->add_option("OUTPUT", arguments.output, "What was made of it: .ele, .neigh or .vtu")->required()->type_name("");
  add_crossing(*app, arguments.crossing);
  add_domain(*app, arguments.domain);
  command::add_refinement(*app, arguments.refine);
  app->add_option("--grid", arguments.grid, "The grid, where OUTPUT holds none")->type_name("X,Y,CELL");
  app->add_flag("--quiet", arguments.quiet, "Print errors only");
  app->footer(std::string(verify_help) + status_help);
  app->callback([&arguments] { command::verify(arguments); });
}

void add_mesh(CLI::App& app, command::MeshArguments& mesh) {
  app.add_option("INPUT", mesh.input,
                 "What triangulate takes, and is triangulated; or a mesh, which is taken as it is: an .ele file with "
                 "the .node beside it, an .npz file with triangles, or a .vtu file, of gcdt, Triangle or others")
      ->required()
      ->type_name("");
  add_crossing(app, mesh.crossing);
  add_domain(app, mesh.domain);
  app.add_option("--grid", mesh.grid, grid_help)->type_name("X,Y,CELL");
  app.add_option("--device", mesh.device, device_help)->type_name("SPEC");
  app.add_flag("--quiet", mesh.quiet, "Print errors only");
}

void add_locate(CLI::App& gcdt, command::LocateArguments& arguments) {
  CLI::App* app = gcdt.add_subcommand("locate", "Say in which triangles of the mesh of INPUT the points of POINTS are");
  add_mesh(*app, arguments.mesh);
  app->add_option("POINTS", arguments.points, "A .node file with the points")->required()->type_name("");
  app->add_option("-o,--output", arguments.output, "The file to write; default: standard output")->type_name("FILE");
  app->footer(std::string(locate_help) + status_help);
  app->callback([&arguments] { command::locate(arguments); });
}

void add_raster(CLI::App& gcdt, command::RasterArguments& arguments) {
  CLI::App* app =
      gcdt.add_subcommand("raster", "Interpolate an attribute of the vertices of INPUT in the middles of square cells");
  add_mesh(*app, arguments.mesh);
  app->add_option("-o,--output", arguments.outputs, "A .asc, .flt or .png file; may be given several times")
      ->required()
      ->allow_extra_args(false)
      ->type_name("OUTPUT");
  app->add_option("--attribute", arguments.attribute, "Which attribute, from 1")->capture_default_str();
  app->add_option("--cell", arguments.cell, "The edge of a cell; default: the longer side has 1024")->type_name("SIZE");
  app->add_option("--no-data", arguments.no_data, "The value outside of all triangles")->capture_default_str();
  app->footer(std::string(raster_help) + status_help);
  app->callback([&arguments] { command::raster(arguments); });
}

void add_view(CLI::App& gcdt, command::ViewArguments& arguments) {
  CLI::App* app = gcdt.add_subcommand("view", "Write a page that shows the mesh of INPUT in a browser");
  add_mesh(*app, arguments.mesh);
  app->add_option("-o,--output", arguments.output, "The page to write")->required()->type_name("PAGE.html");
  app->add_option("--title", arguments.title, "What stands above it; default: the name of INPUT")->type_name("TEXT");
  app->footer(std::string(view_help) + status_help);
  app->callback([&arguments] { command::view(arguments); });
}

void add_bench(CLI::App& gcdt, command::BenchArguments& arguments) {
  CLI::App* app = gcdt.add_subcommand("bench", "Measure how fast each device is, and say which one auto picks");
  app->add_option("--device", arguments.device, "Measure this one only")->type_name("SPEC");
  app->add_option("--seconds", arguments.seconds, "For how long, on each device")
      ->check(CLI::Range(0.0, 3600.0).description(""))
      ->type_name("SECONDS")
      ->capture_default_str();
  app->add_option("--vertices", arguments.vertices, "How many vertices a call has, about")
      ->check(CLI::Range(4u, 500000000u).description(""))
      ->type_name("COUNT")
      ->capture_default_str();
  app->footer(status_help);
  app->callback([&arguments] { command::bench(arguments); });
}

void add_minimise(CLI::App& gcdt, command::MinimiseArguments& arguments) {
  CLI::App* app = gcdt.add_subcommand("minimise", "Make an INPUT for which a check fails as small as can be");
  app->add_option("INPUT", arguments.input, "What triangulate takes")->required()->type_name("");
  app->add_option("-o,--output", arguments.output, "The .poly file to write")->required()->type_name("OUTPUT.poly");
  CLI::Option* check = app->add_option("--check", arguments.check,
                                       "What is run for every smaller input; default: gcdt triangulate --verify, with "
                                       "the options below")
                           ->type_name("COMMAND");
  add_crossing(*app, arguments.crossing);
  add_domain(*app, arguments.domain);
  app->add_option("--grid", arguments.grid, grid_help)->type_name("X,Y,CELL");
  app->add_option("--device", arguments.device, device_help)->type_name("SPEC");
  for (const char* other : {"--crossing", "--domain", "--grid", "--device"}) check->excludes(app->get_option(other));
  app->add_option("--seconds", arguments.seconds, "A check that takes longer is killed, and has failed")
      ->check(CLI::Range(0.001, 86400.0).description(""))
      ->type_name("SECONDS")
      ->capture_default_str();
  app->add_option("--checks", arguments.most_checks, "How many checks are made at most")
      ->check(CLI::Range(1.0, 1e15).description(""))
      ->type_name("COUNT")
      ->capture_default_str();
  app->add_flag("--quiet", arguments.quiet, "Print errors only");
  app->footer(std::string(minimise_help) + status_help);
  app->callback([&arguments] { command::minimise(arguments); });
}

void add_completion(CLI::App& gcdt, std::string& what) {
  CLI::App* app =
      gcdt.add_subcommand("completion", "Print what a shell needs to complete this command, or its man page");
  app->add_option("SHELL", what, "bash, zsh, fish or man")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish", "man"}).description(""))
      ->type_name("");
  app->callback([&gcdt, &what] { command::print(command::completion(gcdt, what, version())); });
}

int leave(io::Exit exit, const std::string& what) {
  if (command::interrupted()) {
    std::fputs("gcdt: interrupted\n", stderr);
    return static_cast<int>(io::Exit::interrupted);
  }
  command::complain(what);
  return static_cast<int>(exit);
}

int wrong_usage(const CLI::App& app, const CLI::ParseError& error, const char* first) {
  const auto used = app.get_subcommands();
  const std::string command = used.empty() ? "gcdt" : "gcdt " + used.front()->get_name();
  const std::string what = used.empty() && first ? fmt::format("{} is no subcommand", first) : error.what();
  return leave(io::Exit::usage, fmt::format("{} (see {} --help)", what, command));
}

}  // namespace

int main(int argc, char** argv) {
  command::watch_interrupts();
  CLI::App app("Exact constrained Delaunay triangulation on OpenCL devices", "gcdt");
  command::TriangulateArguments triangulate;
  command::BatchArguments batch;
  command::VerifyArguments verify;
  command::LocateArguments locate;
  command::RasterArguments raster;
  command::ViewArguments view;
  command::BenchArguments bench;
  command::MinimiseArguments minimise;
  std::string shell;
  app.set_version_flag("--version", std::string("gcdt ") + version());
  app.require_subcommand(1);
  add_triangulate(app, triangulate);
  add_batch(app, batch);
  add_verify(app, verify);
  add_locate(app, locate);
  add_raster(app, raster);
  add_view(app, view);
  app.add_subcommand("devices", "List the OpenCL devices of this machine")->callback(command::list_devices);
  add_bench(app, bench);
  add_minimise(app, minimise);
  add_completion(app, shell);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return wrong_usage(app, error, argc > 1 && argv[1][0] != '-' ? argv[1] : nullptr);
  } catch (const io::Failure& failure) {
    return leave(failure.exit(), failure.what());
  } catch (const Error& error) {
    return leave(command::exit_for(error.status()), error.what());
  } catch (const std::bad_alloc&) {
    return leave(io::Exit::device, "out of memory");
  } catch (const std::exception& error) {
    return leave(io::Exit::device, error.what());
  }
}

// SPDX-License-Identifier: Apache-2.0
// The subcommands of gcdt and what they share.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>

#include "io/failure.hpp"
#include "io/triangle_files.hpp"
#include "refinement.hpp"

namespace gcdt::command {

struct TriangulateArguments {
  std::string input;
  std::vector<std::string> outputs;
  std::string crossing = "reject", domain = "hull", colour = "region", grid, device, statistics, trace;
  bool verify = false, assess = false, quiet = false, regions = false, distinct = false;
  std::uint32_t tiles = 0;   ///< 0: as memory asks for
  std::uint64_t memory = 0;  ///< bytes of each device at most; 0: all
  std::string spill;         ///< a directory for what has no room on a device; empty: to memory
  RefineArguments refine;
  std::optional<std::string> triangle;  ///< switches of Triangle (triangle_switches.hpp)
  bool jettison = false;                ///< vertices without triangles are left out
};

/// A mesh that is made of INPUT, or read, to be asked something.
struct MeshArguments {
  std::string input;
  std::string crossing = "reject", domain = "hull", grid, device;
  bool quiet = false;
};

struct LocateArguments {
  MeshArguments mesh;
  std::string points, output;
};

struct RasterArguments {
  MeshArguments mesh;
  std::vector<std::string> outputs;
  std::uint32_t attribute = 1;
  std::optional<double> cell;  ///< none: 1024 on the longer side
  double no_data = -9999;
};

struct ViewArguments {
  MeshArguments mesh;
  std::string output, title;
};

struct BenchArguments {
  std::string device;  ///< empty: all
  double seconds = 10;
  std::uint32_t vertices = 200000;
};

struct VerifyArguments {
  std::string input, output;
  std::string crossing = "reject", domain = "hull", grid;
  bool quiet = false;
  RefineArguments refine;
};

struct BatchArguments {
  std::vector<std::string> inputs, formats = {"ele"};
  std::string colour = "region", folder, crossing = "reject", domain = "hull", grid, device, statistics, trace;
  bool verify = false, quiet = false, regions = false, distinct = false;
  RefineArguments refine;
};

/// Each returns when all is done and throws io::Failure or gcdt::Error otherwise.
void triangulate(const TriangulateArguments& arguments);
void verify(const VerifyArguments& arguments);
/// Inputs that fail spoil no others: what is right is written first.
void triangulate_batch(const BatchArguments& arguments);
void locate(const LocateArguments& arguments);
void raster(const RasterArguments& arguments);
/// Writes a page that shows the mesh in a browser.
void view(const ViewArguments& arguments);
void list_devices();
/// Measures devices one after the other, prints what it finds as it does, and which one `auto` is.
void bench(const BenchArguments& arguments);

Crossing crossing_named(const std::string& name);

/// Sets the domain of that name, and the seeds that the input has.
void set_domain(const std::string& name, const io::Input& input, Options& options);

/// "X,Y,CELL" as a grid; nothing if the text is empty. Throws io::Failure (Exit::usage).
std::optional<FixedGrid> grid_from_option(const std::string& text);

/// Turns what the library threw about `input` into one line (crossings: more) in the input's own
/// numbers, with the status to leave with.
io::Failure explained(const Error& error, const io::Input& input, const Options& options);

/// Adds what the input has and the options do not use.
void add_unused(const io::Input& input, const Options& options, std::vector<std::string>& notes);

/// What is to be said of vertices that rounding made one, the first two named; empty if there are none.
std::string together_note(const io::Input& input, std::uint64_t count, const std::array<std::uint32_t, 2>& first);

/// What is to be said of added vertices that files cannot hold; empty if they can.
std::string rounding_note(const io::MeshArrays& mesh);

/// Of a file that is no output in one of the formats: - would be a file of that name. Throws if it is.
void check_is_file_name(const std::string& path);

/// The status for an error that is not about one input.
io::Exit exit_for(Status status);

/// A failure that is not the last, on standard error.
void complain(std::string text);

/// A line on standard error that is no failure.
void note(const std::string& text);

/// Prints text on standard output. Throws io::Failure (Exit::output) if it cannot be written.
void print(const std::string& text);

}  // namespace gcdt::command

// SPDX-License-Identifier: Apache-2.0
// The vocabulary of the C++ interface: plain types without any call of the library but gcdt_grid_cell.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gcdt/gcdt.h>
#include <gcdt/array.hpp>

namespace gcdt {

/// A view of elements that the caller owns, read only: what std::span<const T> is in C++20.
template <class T>
class Span {
 public:
  Span() = default;
  Span(const T* first, std::size_t count) : data_(first), size_(count) {}
  Span(const std::vector<T>& values) : Span(values.data(), values.size()) {}
  template <class Allocator>
  Span(const std::vector<T, Allocator>& values) : Span(values.data(), values.size()) {}
  template <std::size_t N>
  Span(const std::array<T, N>& values) : Span(values.data(), N) {}

  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

 private:
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

/// A view of the input vertices: `count` pairs (x, y) of one number type, tightly packed.
/// Every coordinate must be finite, an int64 up to 2^53 in magnitude; -0 counts as 0. Owned by the caller, read only
/// during the call.
class Points {
 public:
  enum class Type { float64, float32, int32, int64 };

  Points() = default;
  Points(Span<std::array<double, 2>> p) : Points(Type::float64, p.data(), p.size()) {}
  Points(Span<std::array<float, 2>> p) : Points(Type::float32, p.data(), p.size()) {}
  Points(Span<std::array<std::int32_t, 2>> p) : Points(Type::int32, p.data(), p.size()) {}
  Points(Span<std::array<std::int64_t, 2>> p) : Points(Type::int64, p.data(), p.size()) {}
  Points(const std::vector<std::array<double, 2>>& p) : Points(Span<std::array<double, 2>>(p)) {}
  Points(const std::vector<std::array<float, 2>>& p) : Points(Span<std::array<float, 2>>(p)) {}
  Points(const std::vector<std::array<std::int32_t, 2>>& p) : Points(Span<std::array<std::int32_t, 2>>(p)) {}
  Points(const std::vector<std::array<std::int64_t, 2>>& p) : Points(Span<std::array<std::int64_t, 2>>(p)) {}
  template <class Number, class Allocator>
  Points(const std::vector<std::array<Number, 2>, Allocator>& p) : Points(Span<std::array<Number, 2>>(p)) {}
  /// `count` pairs at `xy`: 2 * count numbers.
  static Points pairs(const double* xy, std::size_t count) { return Points(Type::float64, xy, count); }
  static Points pairs(const float* xy, std::size_t count) { return Points(Type::float32, xy, count); }
  static Points pairs(const std::int32_t* xy, std::size_t count) { return Points(Type::int32, xy, count); }
  static Points pairs(const std::int64_t* xy, std::size_t count) { return Points(Type::int64, xy, count); }

  Type type() const { return type_; }
  const void* data() const { return data_; }
  std::size_t size() const { return size_; }
  /// Coordinate `axis` (0: x, 1: y) of vertex `i`, exact; infinite for an int64 beyond 2^53 in magnitude.
  double coordinate(std::size_t i, std::size_t axis) const {
    switch (type_) {
      case Type::float32: return static_cast<const float*>(data_)[2 * i + axis];
      case Type::int32: return static_cast<const std::int32_t*>(data_)[2 * i + axis];
      case Type::int64: {
        const std::int64_t v = static_cast<const std::int64_t*>(data_)[2 * i + axis], most = std::int64_t{1} << 53;
        if (v < -most || v > most) return v < 0 ? -HUGE_VAL : HUGE_VAL;
        return static_cast<double>(v);
      }
      default: return static_cast<const double*>(data_)[2 * i + axis];
    }
  }

 private:
  Points(Type type, const void* data, std::size_t size) : type_(type), data_(data), size_(size) {}
  Type type_ = Type::float64;
  const void* data_ = nullptr;
  std::size_t size_ = 0;
};

/// A constraint: the numbers of its two end vertices. Which end comes first does not matter.
using Constraint = std::array<std::uint32_t, 2>;
using Constraints = Span<Constraint>;

/// What went wrong. The names are the sentences.
enum class Status {
  ok,
  invalid_argument,         ///< an option or a view that makes no sense
  coordinate_not_finite,    ///< indices: {vertex, axis}
  coordinate_outside_grid,  ///< of a fixed grid, or an int64 beyond 2^53; indices: {vertex, axis}
  index_out_of_range,       ///< indices: {constraint, end (0 or 1)}
  too_many_vertices,        ///< more than the 32-bit numbering holds (max_vertices)
  constraints_cross,        ///< indices: all pairs {c, d, c, d, ...}, ascending
  no_device,                ///< no OpenCL device fits the choice
  device_failed,            ///< an OpenCL call failed, or the device computes wrongly
  out_of_memory,            ///< the device's memory or largest buffer is too small
  round_limit,              ///< a loop did not end where theory says it must
  check_failed,             ///< the result failed the check of its own validity and is withheld
  cancelled,                ///< the progress callback asked to stop
  workspace_too_small,      ///< indices: {bytes needed, as far as is known}
  buffer_too_small,         ///< indices: {elements needed, elements there are}
  wrong_context,            ///< a buffer or queue is not of the solver's context and device
  buffer_access,            ///< an output that is read-only, or an input that is write-only
  buffers_overlap,          ///< two ranges of device memory that must be apart are not
  in_use,                   ///< the solver is in a call, or its results still hold memory
  vertices_coincide,  ///< Options::distinct: rounding made vertices one; indices: {vertex, vertex}, the first pair
  spill_failed,       ///< a file for what devices have no room for (gcdt_pool_options.spill_directory)
};

/// Everything this library throws, std::bad_alloc apart.
class Error : public std::runtime_error {
 public:
  Error(Status status, const std::string& what, std::vector<std::uint64_t> indices = {}, std::uint64_t pair_count = 0,
        std::int32_t opencl_code = 0)
      : std::runtime_error(what),
        status_(status),
        indices_(std::move(indices)),
        pair_count_(pair_count),
        opencl_code_(opencl_code) {}
  Status status() const { return status_; }
  /// The offending vertices, constraints or pairs, in input numbers from 0; see Status for the shape.
  const std::vector<std::uint64_t>& indices() const { return indices_; }
  /// constraints_cross: how many pairs of constraints cross in all.
  std::uint64_t pair_count() const { return pair_count_; }
  /// device_failed, out_of_memory: the code of the OpenCL call that failed; 0 if it was none.
  std::int32_t opencl_code() const { return opencl_code_; }

 private:
  Status status_;
  std::vector<std::uint64_t> indices_;
  std::uint64_t pair_count_ = 0;
  std::int32_t opencl_code_ = 0;
};

/// The integer grid on which everything is exact: vertex (x, y) stands at
/// (round((x - origin[0]) / cell), round((y - origin[1]) / cell)), half to even, in [0, 2^31 - 1]^2.
struct Grid {
  enum class Kind {
    binary,   ///< every coordinate is a multiple of one power of two: nothing moved
    decimal,  ///< every coordinate is the double nearest to a decimal: exact for the numbers as written
    rounded,  ///< otherwise: largest_move says how far a coordinate moved at most
    fixed,    ///< given by the caller; largest_move as for rounded
  };
  Kind kind = Kind::binary;
  std::array<double, 2> origin{0, 0};
  /// The cell's edge is cell_units / 10^cell_decimals if cell_units > 0, else 2^cell_exponent.
  std::uint64_t cell_units = 0;
  int cell_decimals = 0;
  int cell_exponent = 0;
  double largest_move = 0;

  /// The double nearest to the cell's edge.
  double cell() const { return gcdt_grid_cell(cell_units, cell_decimals, cell_exponent); }
};

/// A grid given by the caller: origin, and the cell's edge as a decimal number such as "0.001"
/// (at most 19 significant digits, exponent -22 to 22) or a power of two.
struct FixedGrid {
  double x = 0, y = 0;
  std::string cell = "1";
};

/// What happens to constraints whose interiors cross (docs/contract.md, 3: after duplicates are merged and
/// constraints are split at the vertices on them).
enum class Crossing {
  reject,  ///< throw constraints_cross
  drop,    ///< in input order, drop a constraint that crosses an earlier one that was kept
  split,   ///< crossings become vertices, rounded to the grid; see docs/splitting.md
};

/// Which triangles are returned. Borders are the constraints; a region is a set of triangles joined by other edges.
enum class Domain {
  hull,        ///< all, which cover the convex hull
  even_odd,    ///< regions around which the borders wind an odd number of times, every source of an edge counted
  nonzero,     ///< regions around which they wind, by the constraints' directions, a number of times that is not 0
  holes,       ///< all but the regions with a hole seed
  outer,       ///< all but what can be reached from outside without crossing a constraint
  outer_holes  ///< both, as Triangle's switch -p does
};

/// What refinement may split.
enum class Splits {
  all,    ///< every constraint, and the border of the domain
  inner,  ///< constraints with triangles of the domain on both sides
  none,   ///< nothing: vertices are added inside triangles only
};

/// What is wanted of a mesh, in units of the input (docs/refinement.md, gcdt_refinement).
struct Refinement {
  double least_angle = 20;                ///< degrees, 1 to 34; 0: angles do not matter
  double most_area = HUGE_VAL;            ///< of a triangle; above 0
  double least_length = 0;                ///< triangles with a shorter side are left as they are; at least 8 cells
  std::uint64_t most_added = UINT64_MAX;  ///< vertices
  Splits splits = Splits::all;
  bool conforming = false;    ///< edges beside constraints are Delaunay, too
  Span<double> sizes;         ///< empty, or one a vertex: the length wanted there, above 0; the caller's
  Span<double> region_areas;  ///< empty, or one for each of Options::region_seeds: most_area there; the caller's
};

/// Called between rounds with the phase's name and the share done of the whole in [0, 1].
/// Return false to stop: the call then throws Status::cancelled.
using Progress = std::function<bool(const char* phase, double done)>;

struct Options {
  Crossing crossing = Crossing::reject;
  std::optional<FixedGrid> grid;  ///< default: chosen from the input (Grid::Kind)
  bool check = true;              ///< prove the mesh on the device before it is returned
  bool canonical = true;          ///< triangles in canonical order; else in any, which costs less
  Progress progress;
  Domain domain = Domain::hull;  ///< what is returned of the mesh, after the check
  bool regions = false;          ///< region, depth, winding and seed of each triangle; always so unless `hull`
  /// Points in the input's coordinates, rounded to the grid; on an edge or vertex: in the least triangle there.
  std::vector<std::array<double, 2>> hole_seeds, region_seeds;
  bool distinct = false;  ///< vertices that differ as given must differ on the grid: else throw vertices_coincide
  /// Of Pool: how many tiles each problem is cut into; 0: as many as memory asks for. See gcdt_pool_triangulate.
  std::uint32_t tiles = 0;
  /// Refines the triangles of the domain. For Solver, and to verify what that made (verify_refined); others refuse it.
  std::optional<Refinement> refine = std::nullopt;
  bool pinned = false;  ///< the input lies in memory that the device's driver has pinned: see gcdt_options.pinned
};

/// Counts and times of one call; names as in the statistics file of the command.
struct Statistics {
  std::uint64_t n = 0, m = 0;  ///< input vertices and constraints
  std::uint64_t vertices_merged = 0;
  std::uint64_t constraints_zero = 0, constraints_pieces = 0, constraints_overlapping = 0;
  std::uint64_t crossings = 0, constraints_dropped = 0, vertices_added = 0;
  std::uint64_t constraints_split = 0;  ///< constraints that may have been moved by splitting
  double constraint_move = 0;           ///< the largest distance of one from its edges, in input units
  std::uint64_t triangles = 0;
  Grid grid;
  /// Milliseconds on the host's clock; docs/statistics.md defines each.
  struct Milliseconds {
    double read = 0, write = 0;  ///< files; 0 in the library
    double call = 0;             ///< the whole call on the caller's clock, building and new result arrays included
    double build = 0;            ///< programs; in call, and in no other
    /// The phases; output has the copies to the host. full is their sum.
    double order = 0, insert = 0, constrain = 0, flip = 0, check = 0, output = 0, domain = 0;
    double full = 0;
    /// From distinct vertices on the grid and clean constraints in device memory to triangles and neighbours there, in
    /// any order, unchecked: sorting the vertices, insert, constrain without clean but with walk, flip, and gather.
    double core = 0;
    double clean = 0;   ///< part of constrain: cleaning the constraints
    double walk = 0;    ///< part of clean: cutting them into parts and walking along them, as enforcing needs, too
    double gather = 0;  ///< part of output: finding the finite triangles, and writing them and their neighbours
    double refine = 0;  ///< a phase; ordering and checking what has new vertices are in it
  } ms;
  struct Rounds {
    std::uint64_t insert = 0, flip = 0;
  } rounds;
  std::uint64_t flips = 0;
  /// Longest path in the history tree of the last level; 0 on CPUs, where vertices go in one after the other.
  std::uint64_t history_depth = 0;
  std::uint64_t location_steps = 0;  ///< triangles visited by all point locations together
  std::uint64_t launches = 0, read_backs = 0;
  std::uint64_t crossed_pairs = 0;      ///< (triangle, constraint) pairs crossed by the first walk
  std::uint64_t peak_device_bytes = 0;  ///< in buffers at once; results of other calls are not counted
  std::uint64_t held_device_bytes = 0;  ///< what the solver held at most, in use or kept for later
  std::string device, driver, platform, version;
  /// How often each special case of the algorithm occurred; tests prove by it that cases are reached.
  struct Cases {
    std::uint64_t edge_splits = 0;              ///< vertices inserted on an edge (state OnEdge)
    std::uint64_t constraint_hits = 0;          ///< vertices found on the inside of a constraint
    std::uint64_t existing_edges = 0;           ///< pieces that were edges already
    std::uint64_t pieces_walked = 0;            ///< pieces that crossed at least one edge
    std::uint64_t chain_vertices = 0;           ///< triangles made by distance-ordered retriangulation
    std::uint64_t holes = 0;                    ///< triangles made by hole filling (paper 6.5)
    std::uint64_t symbolic_chain_vertices = 0;  ///< chain vertices that are vertices at infinity
    /// How two pieces lie in a triangle that they cross (paper, figure 6), counted once for each edge of it on which
    /// the piece nearest to the one end is not the nearest to the other: they cut off the same corner, come from the
    /// same corner, cut off one each, or one cuts off a corner and the other comes from another. Enforced problem by
    /// problem (batches on CPUs), pieces do not meet, and none are counted.
    std::uint64_t pairs_cut_one_corner = 0, pairs_from_one_corner = 0, pairs_cut_two_corners = 0,
                  pairs_cut_and_from = 0;
  } cases;
  std::uint64_t regions = 0;            ///< of the convex hull; 0 unless labelled
  std::uint64_t triangles_removed = 0;  ///< by Options::domain
  std::uint64_t deepest = 0;            ///< the largest depth of a region
  /// Constrained edges beside which the parity or the winding numbers are not what the edge says, since the
  /// borders are not closed there.
  std::uint64_t open_parity = 0, open_winding = 0;
  /// Of vertices_merged those that differ, as given, from the vertex that stands for them: rounding made them one. The
  /// first of them is the second of the pair, and that vertex the first.
  std::uint64_t vertices_rounded_together = 0;
  std::array<std::uint32_t, 2> rounded_pair{0, 0};
  /// Of Options::refine; see gcdt_statistics.
  struct Refined {
    bool complete = true;  ///< it did not end by the limit of vertices
    std::uint64_t rounds = 0, added = 0;
    std::uint64_t on_subsegments = 0, bent = 0, far = 0;  ///< of the added ones
    double move = 0;                                      ///< how far one is from its constraint at most
    std::uint64_t encroached = 0;
    /// Triangles that are not as wanted, by the reason.
    std::uint64_t left_input_angle = 0, left_beside_angle = 0, left_grid = 0, left_fixed = 0, left_refused = 0,
                  left_limit = 0, left_target = 0;
  } refine;
  std::vector<std::string> notes;  ///< e.g. that all vertices lie on one line
};

/// Areas and angles of a mesh; see gcdt_quality.
struct Quality {
  std::uint64_t triangles = 0;
  double least_angle = 0, largest_angle = 0;  ///< degrees
  std::int32_t least_angle_triangle = -1, largest_angle_triangle = -1;
  double least_area = 0, largest_area = 0, area = 0;                  ///< in units of the input, squared
  std::uint64_t least_doubled = 0, largest_doubled = 0, doubled = 0;  ///< twice the same in cells, exactly
};

namespace detail {

/// An element of an array: `width` numbers of a type.
template <class T, std::size_t width>
struct ElementOf {
  using Type = std::array<T, width>;
};
template <class T>
struct ElementOf<T, 1> {
  using Type = T;
};
template <class T, std::size_t width>
using Element = typename ElementOf<T, width>::Type;

}  // namespace detail

/// A constrained Delaunay triangulation. All vertex numbers are input numbers, from 0.
struct Triangulation {
  /// One Array (gcdt/array.hpp) for each of gcdt/arrays.def, which says what is in it: triangles, neighbours,
  /// constrained, representative, pieces, source_offsets, sources, dropped, added_on_grid, added_crossing,
  /// added_origin, region, depth, winding, region_seed and excuse.
#define GCDT_ARRAY(number, name, type, width, ...) Array<detail::Element<type, width>> name;
#include <gcdt/arrays.def>
  /// The vertices of added_on_grid, as the doubles nearest to that.
  Array<std::array<double, 2>> added;
  Statistics statistics;
};

/// What an OpenCL device is and has.
struct DeviceInfo {
  std::string name, vendor, platform, driver, version;
  bool is_gpu = false, is_cpu = false;
  std::uint64_t memory_bytes = 0, largest_buffer_bytes = 0, local_bytes = 0;
  std::uint32_t compute_units = 0, largest_work_group = 0;
  bool atomics64 = false, fp64 = false, subgroups = false;
};

/// Something that took time: a phase of a call, as the host saw it, or one launch on the device. Launches lie within
/// the phase and one after the other; inner phases lie within outer ones.
struct TraceSpan {
  std::string device;  ///< its name
  /// Its place among the devices of a pool (and workers: gcdt_pool.h); 0 for a solver.
  std::uint32_t device_number = 0;
  std::string phase;                       ///< the outermost phase: order, insert ... (gcdt_trace_span, gcdt.h)
  std::string name;                        ///< the phase's or the kernel's
  bool on_device = false;                  ///< a launch
  std::uint64_t begin_ns = 0, end_ns = 0;  ///< on the host's steady clock
};
using Trace = std::function<void(const TraceSpan& span)>;

/// The most vertices one call takes: triangle numbers are 30 bits wide.
constexpr std::uint64_t max_vertices = (1ull << 29) - 2;

/// A mesh to be verified; triangle order and first corners are free.
struct MeshView {
  Span<std::array<std::uint32_t, 3>> triangles;
  const std::array<std::int32_t, 3>* neighbours = nullptr;  ///< one per triangle, or null: not checked
  const std::uint8_t* constrained = nullptr;                ///< one per triangle, or null: not checked
  /// Crossing::split, Options::refine: the vertices after those of the input, on the grid.
  Span<std::array<std::int32_t, 2>> added = {};
  /// Options::refine: what each added vertex was put on, as in Triangulation; if not as many as `added`: not known.
  Span<std::array<std::uint32_t, 4>> added_origin = {};
};

/// See gcdt_assessment.
struct Assessment {
  bool valid = false, outline_simple = false;
  std::uint64_t triangles_inverted = 0, triangles_flat = 0, vertices_lost = 0, edges_not_delaunay = 0;
};

struct Verification {
  bool valid = false;
  std::string reason;  ///< of the first failure, naming vertices, triangles or constraints in input numbers
};

}  // namespace gcdt

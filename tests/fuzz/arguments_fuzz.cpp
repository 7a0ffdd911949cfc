// SPDX-License-Identifier: Apache-2.0
// The C interface with arguments of any kind: null pointers, sizes of structures, counts, numbers of vertices, options.
// Pointers that are not null have as many elements as the counts say, or counts are too large to be taken. Every call
// returns a status that its header names, and a solver goes on working after it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include <gcdt/gcdt.h>
#include <gcdt/gcdt_pool.h>

namespace {

constexpr const char* device = "Portable Computing Language";

[[noreturn]] void finding(const char* what, std::int32_t status) {
  gcdt_error error = GCDT_ERROR_INIT;
  gcdt_last_error(nullptr, &error);
  std::fprintf(stderr, "arguments_fuzz: %s: status %d, %s\n", what, status, error.message);
  std::abort();
}

/// No arguments make the library's own mistakes: what is left is about the arguments.
void check(const char* what, std::int32_t status) {
  for (const std::int32_t bad : {GCDT_ERROR_DEVICE_FAILED, GCDT_ERROR_ROUND_LIMIT, GCDT_ERROR_INTERNAL,
                                 GCDT_ERROR_HOST_MEMORY, GCDT_ERROR_IN_USE})
    if (status == bad) finding(what, status);
  if (status > 0 || (status < 0 && status > -20000) || status < GCDT_ERROR_VERTICES_COINCIDE) finding(what, status);
  if (!gcdt_strerror(status)) finding("gcdt_strerror is null", status);
  gcdt_error error = GCDT_ERROR_INIT;
  if (gcdt_last_error(nullptr, &error) != GCDT_OK || !error.message) finding("gcdt_last_error", status);
  if (status != GCDT_OK && error.status != status) finding("gcdt_last_error has another status", status);
}

gcdt_solver* solver() {
  static gcdt_solver* const one = [] {
    gcdt_solver_options options = GCDT_SOLVER_OPTIONS_INIT;
    options.device = device;
    gcdt_solver* made = nullptr;
    const std::int32_t status = gcdt_solver_create(&options, &made);
    if (status != GCDT_OK) finding("no solver", status);
    return made;
  }();
  return one;
}

gcdt_pool* pool() {
  static gcdt_pool* const one = [] {
    gcdt_pool_options options = GCDT_POOL_OPTIONS_INIT;
    options.devices = device;
    gcdt_pool* made = nullptr;
    const std::int32_t status = gcdt_pool_create(&options, &made);
    if (status != GCDT_OK) finding("no pool", status);
    return made;
  }();
  return one;
}

/// Arguments from bytes. Arrays live as long as this does.
class Arguments {
 public:
  Arguments(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

  /// 0 where there are no more.
  std::uint8_t byte() { return at_ < end_ ? *at_++ : std::uint8_t{0}; }
  /// One in 25; never where there are no more bytes.
  bool rarely() { return byte() > 245; }
  bool often() { return byte() % 2 == 1; }
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[byte() % values.size()];
  }
  std::string text() {
    const std::size_t size = std::min<std::size_t>(byte(), static_cast<std::size_t>(end_ - at_));
    at_ += size;
    return std::string(at_ - size, at_);
  }
  std::size_t size_of(std::size_t right) {
    return rarely() ? one_of<std::size_t>({0, 1, 8, right - 1, right + 1, right + 8, SIZE_MAX}) : right;
  }
  /// A count that nobody has the memory for, or what is there.
  std::uint64_t count(std::uint64_t there, std::uint64_t most) {
    return rarely()
               ? one_of<std::uint64_t>({0, most + 1, UINT32_MAX, UINT64_MAX, UINT64_MAX / 2 + 1, UINT64_MAX / 16 + 1})
               : there;
  }
  double number() {
    static constexpr double odd[] = {0,
                                     -0.0,
                                     1,
                                     3,
                                     20,
                                     34,
                                     35,
                                     5e-324,
                                     1e-300,
                                     1e300,
                                     1.7976931348623157e308,
                                     -1,
                                     0.5,
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::quiet_NaN(),
                                     9007199254740992.0,
                                     9007199254740994.0};
    if (often()) return byte() % 41 - 20;
    if (rarely()) return odd[byte() % std::size(odd)];
    const int high = byte();
    return (high * 8 + byte() % 8 - 1000) / 8.0;
  }
  template <class T>
  T* array(std::size_t count, T (Arguments::*each)()) {
    auto* values = new std::vector<T>(count);
    for (T& value : *values) value = (this->*each)();
    keep_.push_back({values, [](void* kept) { delete static_cast<std::vector<T>*>(kept); }});
    return rarely() ? nullptr : values->data();
  }
  std::uint32_t vertex() { return rarely() ? UINT32_MAX - byte() % 2u : byte() % 12u; }
  std::int32_t link() { return rarely() ? INT32_MIN : byte() % 16 - 2; }
  std::uint8_t flags() { return byte(); }
  std::uint64_t offset() { return rarely() ? UINT64_MAX : byte() % 12u; }
  float small_number() { return static_cast<float>(std::fmod(number(), 1e30)); }
  std::int64_t integer() { return rarely() ? INT64_MIN + byte() : byte() - 100; }
  std::int32_t small_integer() { return rarely() ? INT32_MAX : byte() - 100; }

  const void* coordinates(std::int32_t type, std::size_t pairs) {
    switch (type) {
      case GCDT_FLOAT32: return array(2 * pairs, &Arguments::small_number);
      case GCDT_INT32: return array(2 * pairs, &Arguments::small_integer);
      case GCDT_INT64: return array(2 * pairs, &Arguments::integer);
      default: return array(2 * pairs, &Arguments::number);
    }
  }
  std::int32_t type() { return rarely() ? static_cast<std::int8_t>(byte()) : byte() % 4; }
  std::int32_t choice(std::int32_t end) { return rarely() ? static_cast<std::int8_t>(byte()) : byte() % end; }

  gcdt_input input() {
    gcdt_input c = GCDT_INPUT_INIT;
    const std::size_t n = byte() % 16, m = byte() % 12;
    c.coordinate_type = type();
    c.vertices = coordinates(c.coordinate_type, n), c.vertex_count = count(n, GCDT_MAX_VERTICES);
    c.constraints = array(2 * m, &Arguments::vertex), c.constraint_count = count(m, GCDT_MAX_CONSTRAINTS);
    // A count beyond the memory that is there is the caller's lie, unless it is one that must be refused unread.
    if (c.vertex_count > n && c.vertex_count <= GCDT_MAX_VERTICES) c.vertex_count = n;
    if (c.constraint_count > m && c.constraint_count <= GCDT_MAX_CONSTRAINTS) c.constraint_count = m;
    c.struct_size = size_of(sizeof c);
    return c;
  }

  gcdt_options* options(bool plain = false) {
    options_ = GCDT_OPTIONS_INIT;
    if (often()) return nullptr;
    gcdt_options& c = options_;
    c.crossing = choice(3), c.check = choice(2), c.canonical = choice(2), c.distinct = choice(2);
    c.fixed_grid = choice(2), c.grid_x = number(), c.grid_y = number();
    cell_ = one_of<const char*>({"1", "0.001", "", "x", "-1", "1e400", "0", "2^-3", "2^99999", "nan", "123456789e-3"});
    c.grid_cell = rarely() ? nullptr : cell_.c_str();
    if (plain) return &c;
    c.domain = choice(6), c.regions = choice(2), c.tiles = rarely() ? byte() : 0u;
    c.hole_seed_count = byte() % 4, c.hole_seeds = array(2 * c.hole_seed_count, &Arguments::number);
    c.region_seed_count = byte() % 4, c.region_seeds = array(2 * c.region_seed_count, &Arguments::number);
    if (rarely()) c.hole_seed_count = UINT64_MAX - byte();
    if (often()) c.refine = refinement();
    c.struct_size = size_of(sizeof c);
    return &c;
  }

  gcdt_mesh mesh() {
    gcdt_mesh c = GCDT_MESH_INIT;
    const std::size_t count_there = byte() % 24, added = rarely() ? byte() % 8u : 0;
    c.triangles = array(3 * count_there, &Arguments::vertex), c.triangle_count = count_there;
    if (often()) c.neighbours = array(3 * count_there, &Arguments::link);
    if (often()) c.constrained = array(count_there, &Arguments::flags);
    c.added = array(2 * added, &Arguments::small_integer), c.added_count = added;
    c.struct_size = size_of(sizeof c);
    return c;
  }

  gcdt_grid grid() {
    gcdt_grid c = {};
    c.struct_size = size_of(sizeof c);
    c.kind = choice(4), c.origin[0] = number(), c.origin[1] = number();
    c.cell_units = rarely() ? UINT64_MAX : byte() % 3u;
    c.cell_decimals = rarely() ? INT32_MIN + byte() : choice(3), c.cell_exponent = rarely() ? INT32_MAX : choice(3);
    c.largest_move = number();
    return c;
  }

  ~Arguments() {
    for (const Kept& kept : keep_) kept.free(kept.memory);
  }

 private:
  const gcdt_refinement* refinement() {
    gcdt_refinement& c = refinement_ = GCDT_REFINEMENT_INIT;
    c.least_angle = number(), c.most_area = often() ? HUGE_VAL : number(), c.least_length = number();
    c.most_added = byte(), c.splits = choice(3), c.conforming = choice(2);
    if (rarely()) c.size_count = byte() % 16u, c.sizes = array(c.size_count, &Arguments::number);
    if (rarely()) c.region_area_count = byte() % 4u, c.region_areas = array(c.region_area_count, &Arguments::number);
    c.struct_size = size_of(sizeof c);
    return &c;
  }

  struct Kept {
    void* memory;
    void (*free)(void*);
  };
  const std::uint8_t *at_, *end_;
  std::vector<Kept> keep_;
  gcdt_options options_;
  gcdt_refinement refinement_;
  std::string cell_;
};

/// Everything that can be asked of a result.
void ask(Arguments& arguments, gcdt_result* result) {
  const std::int32_t array = arguments.choice(28);
  const std::uint64_t count = gcdt_result_count(result, array);
  std::vector<char> room(count * gcdt_element_bytes(array) + 1, 'x');
  const std::uint64_t capacity = arguments.rarely() ? count / 2 : count;
  char* const to = arguments.rarely() ? nullptr : room.data();
  check("gcdt_result_copy", gcdt_result_copy(result, array, to, capacity));
  if (room.back() != 'x') finding("gcdt_result_copy writes too much", 0);
  gcdt_quality quality = {};
  quality.struct_size = arguments.size_of(sizeof quality);
  check("gcdt_result_quality", gcdt_result_quality(result, &quality));
  gcdt_statistics statistics = {};
  statistics.struct_size = arguments.size_of(sizeof statistics);
  check("gcdt_result_statistics", gcdt_result_statistics(result, &statistics));
  gcdt_result_note(result, arguments.byte());
  const std::size_t points = arguments.byte() % 8;
  const std::int32_t type = arguments.type();
  const void* at = arguments.coordinates(type, points);
  std::vector<std::int32_t> triangles(points + 1);
  std::vector<double> weights(3 * points + 1), values(gcdt_result_count(result, GCDT_REPRESENTATIVES) + 1);
  std::int32_t* const into = arguments.rarely() ? nullptr : triangles.data();
  check("gcdt_locate", gcdt_locate(result, type, at, points, into, arguments.often() ? nullptr : weights.data()));
  check("gcdt_interpolate",
        gcdt_interpolate(result, type, at, points, values.data(), arguments.number(), weights.data()));
}

void triangulate(Arguments& arguments) {
  const gcdt_input input = arguments.input();
  gcdt_result* result = nullptr;
  gcdt_solver* const on = arguments.rarely() ? nullptr : solver();
  const gcdt_input* const given = arguments.rarely() ? nullptr : &input;
  const gcdt_options* const options = arguments.options();
  const std::int32_t status = gcdt_triangulate(on, given, options, arguments.rarely() ? nullptr : &result);
  if (status == GCDT_ERROR_CHECK_FAILED) finding("a result failed its check", status);
  check("gcdt_triangulate", status);
  if ((status == GCDT_OK) != (result != nullptr)) finding("a result with an error, or none without", status);
  if (result) ask(arguments, result);
  gcdt_result_release(result);
}

void take_mesh(Arguments& arguments) {
  const gcdt_input input = arguments.input();
  const gcdt_mesh mesh = arguments.mesh();
  gcdt_result* result = nullptr;
  const std::int32_t status = gcdt_adopt(solver(), &input, &mesh, arguments.options(true), &result);
  check("gcdt_adopt", status);
  if (result) ask(arguments, result);
  gcdt_result_release(result);
  check("gcdt_check", gcdt_check(solver(), &input, &mesh, arguments.options(true)));
}

void verify(Arguments& arguments) {
  const gcdt_input input = arguments.input();
  const gcdt_mesh mesh = arguments.mesh();
  const gcdt_grid grid = arguments.grid();
  const std::int32_t crossing = arguments.choice(3);
  check("gcdt_verify", gcdt_verify(&input, &mesh, arguments.rarely() ? nullptr : &grid, crossing));
  const std::size_t count = mesh.triangle_count;
  gcdt_regions regions = {arguments.size_of(sizeof regions), arguments.array(count, &Arguments::vertex),
                          arguments.array(count, &Arguments::vertex), arguments.array(count, &Arguments::link)};
  const gcdt_options* options = arguments.options();
  check("gcdt_verify_domain",
        gcdt_verify_domain(&input, &mesh, arguments.rarely() ? nullptr : &regions, &grid, options));
  gcdt_refined_report report = {};
  report.struct_size = arguments.size_of(sizeof report);
  std::vector<std::uint8_t> excuses(count + 1);
  check("gcdt_verify_refined", gcdt_verify_refined(&input, &mesh, &grid, options, &report, excuses.data()));
  gcdt_assessment assessment = {};
  assessment.struct_size = arguments.size_of(sizeof assessment);
  check("gcdt_assess", gcdt_assess(&input, &mesh, &grid, &assessment));
}

void on_the_host(Arguments& arguments) {
  const gcdt_input input = arguments.input();
  gcdt_grid grid = arguments.grid();
  const std::size_t count = arguments.byte() % 8;
  std::vector<double> numbers(2 * count + 1);
  std::vector<std::int32_t> points(2 * count + 1);
  check("gcdt_grid_coordinates",
        gcdt_grid_coordinates(&grid, arguments.array(2 * count, &Arguments::small_integer), count, numbers.data()));
  check("gcdt_grid_points",
        gcdt_grid_points(&grid, arguments.array(2 * count, &Arguments::number), count, points.data()));
  gcdt_grid_cell(grid.cell_units, grid.cell_decimals, grid.cell_exponent);
  check("gcdt_choose_grid", gcdt_choose_grid(&input, arguments.options(true), &grid));

  gcdt_rings rings = GCDT_RINGS_INIT;
  const std::size_t ring_count = arguments.byte() % 5, polygons = arguments.byte() % 4;
  rings.ring_offsets = arguments.array(ring_count + 1, &Arguments::offset), rings.ring_count = ring_count;
  rings.polygon_count = polygons;
  if (polygons > 0) rings.polygon_offsets = arguments.array(polygons + 1, &Arguments::offset);
  rings.struct_size = arguments.size_of(sizeof rings);
  std::vector<std::uint32_t> constraints(64);
  check("gcdt_ring_constraints",
        gcdt_ring_constraints(&input, &rings, constraints.data(), arguments.rarely() ? 1 : 32));

  const double* values = arguments.array(16, &Arguments::number);
  const double* added = arguments.array(2 * count, &Arguments::number);
  const std::uint32_t* crossings = arguments.array(2 * count, &Arguments::vertex);
  const std::uint32_t* origins = arguments.array(4 * count, &Arguments::vertex);
  check("gcdt_added_values", gcdt_added_values(&input, added, crossings, count, values, numbers.data()));
  check("gcdt_refined_values", gcdt_refined_values(&input, added, crossings, origins, count, values, numbers.data()));
  gcdt_required_bytes(arguments.offset(), arguments.offset(), arguments.offset());
  gcdt_required_bytes_refined(arguments.offset(), arguments.offset(), arguments.offset(), arguments.offset());
}

void ask_batch(Arguments& arguments, const gcdt_batch* batch) {
  const std::uint64_t number = arguments.offset();
  gcdt_problem problem = {};
  problem.struct_size = arguments.size_of(sizeof problem);
  check("gcdt_batch_problem", gcdt_batch_problem(batch, number, &problem));
  const std::int32_t array = arguments.choice(28);
  const void* data = nullptr;
  std::uint64_t count = 0;
  check("gcdt_batch_array", gcdt_batch_array(batch, number, array, &data, &count));
  std::vector<char> room(65536);
  std::vector<std::uint64_t> offsets(16);
  const std::size_t bytes = gcdt_element_bytes(array);
  check("gcdt_batch_copy",
        gcdt_batch_copy(batch, array, room.data(), bytes == 0 ? 0 : room.size() / bytes, offsets.data()));
  gcdt_batch_statistics statistics = {};
  statistics.struct_size = arguments.size_of(sizeof statistics);
  check("gcdt_batch_get_statistics", gcdt_batch_get_statistics(batch, &statistics));
}

/// Offsets stay within the memory.
void triangulate_batch(Arguments& arguments) {
  constexpr std::size_t vertices = 12, constraints = 12;
  gcdt_batch_input c = GCDT_BATCH_INPUT_INIT;
  const std::size_t problems = arguments.byte() % 6;
  const auto ascending = [&](std::size_t end) {
    std::uint64_t* offsets = arguments.array(problems + 1, &Arguments::offset);
    for (std::size_t i = 0; offsets && i <= problems; ++i) offsets[i] = std::min<std::uint64_t>(offsets[i], end);
    if (offsets && arguments.byte() > 20) std::sort(offsets, offsets + problems + 1);
    return offsets;
  };
  c.coordinate_type = arguments.type();
  c.vertices = arguments.coordinates(c.coordinate_type, vertices), c.vertex_offsets = ascending(vertices);
  c.constraints = arguments.array(2 * constraints, &Arguments::vertex), c.constraint_offsets = ascending(constraints);
  c.problem_count = arguments.rarely() ? (std::uint64_t{1} << 30) + 1 : problems;
  c.struct_size = arguments.size_of(sizeof c);
  gcdt_batch* batch = nullptr;
  const std::int32_t status = gcdt_pool_triangulate(pool(), &c, arguments.options(), &batch);
  check("gcdt_pool_triangulate", status);
  if (batch) ask_batch(arguments, batch);
  gcdt_batch_release(batch);
}

void select(Arguments& arguments) {
  const std::string spec = arguments.text();
  std::size_t number = 0;
  std::int32_t ambiguous = 0;
  const std::int32_t status = gcdt_device_select(spec.c_str(), &number, &ambiguous);
  check("gcdt_device_select", status);
  gcdt_device_info info = {};
  info.struct_size = arguments.size_of(sizeof info);
  check("gcdt_device_get", gcdt_device_get(status == GCDT_OK ? number : arguments.offset(), &info));
}

/// Whatever came before, a square is two triangles.
void square() {
  static constexpr double corners[] = {0, 0, 1, 0, 1, 1, 0, 1};
  gcdt_input input = GCDT_INPUT_INIT;
  input.vertices = corners, input.vertex_count = 4;
  gcdt_result* result = nullptr;
  const std::int32_t status = gcdt_triangulate(solver(), &input, nullptr, &result);
  if (status != GCDT_OK || gcdt_result_count(result, GCDT_TRIANGLES) != 2) finding("a square", status);
  gcdt_result_release(result);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Arguments arguments(data, size);
  constexpr void (*calls[])(Arguments&) = {triangulate, triangulate, take_mesh,         verify,
                                           on_the_host, on_the_host, triangulate_batch, select};
  calls[arguments.byte() % std::size(calls)](arguments);
  if (arguments.rarely()) square();
  return 0;
}

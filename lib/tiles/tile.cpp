// SPDX-License-Identifier: Apache-2.0
#include "tiles/tile.hpp"

#include "device/step.hpp"
#include "solve/triangulate.hpp"
#include "tiles/parts.hpp"
#include "tiles/passages.hpp"

namespace gcdt::tiles {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

namespace {

/// What a tile takes from the input.
struct Taken {
  InputPoints points;  ///< on the grid
  Buffer<cl_uint> ids;
  cl_uint own = 0, all = 0;
  std::uint64_t move_key = 0;
};

/// The input goes to the device chunk by chunk, which keeps what is the tile's.
class Taker {
 public:
  Taker(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile)
      : lent_(lent),
        runtime_(lent.runtime),
        primitives_(lent.primitives),
        input_(task.input),
        staged_(task.staged),
        share_(share),
        codes_(task.cuts.codes_of(tile)) {
    const std::size_t n = input_.n(), expected = n / task.cuts.tiles();
    taken_.points.coordinates = runtime_.allocate<cl_ulong>("coordinates of a tile", 0);
    taken_.ids = runtime_.allocate<cl_uint>("input numbers of a tile", 0);
    reserve(std::min(n, expected + expected / 8 + Tuning::least_tile_chunk));
  }

  Taken take() {
    staged_.for_chunks(lent_, [&](const InputPoints& points, std::size_t first) {
      const Codes codes = codes_on(runtime_, points, input_.chosen);
      taken_.move_key = std::max<std::uint64_t>(taken_.move_key, codes.maxima[GCDT_QUANTISE_MOVE]);
      note_outside(codes.maxima[GCDT_QUANTISE_OUTSIDE], first);
      take_chunk(points.n, codes, first);
    });
    check_outside(outside_);
    if (!input_.added.empty()) {
      const InputPoints added = stage(runtime_, Points::pairs(input_.added[0].data(), input_.added.size()));
      take_chunk(added.n, codes_on(runtime_, added, fixed_grid(FixedGrid{0, 0, "1"})), input_.given.size());
    }
    taken_.own = taken_.all;
    add_foreign();
    taken_.points.n = taken_.all;
    taken_.points.type = GCDT_COORDINATES_INT32;
    taken_.points.coordinates.shrink(taken_.all);
    taken_.ids.shrink(taken_.all);
    return std::move(taken_);
  }

 private:
  void take_chunk(cl_uint count, const Codes& codes, std::size_t first_id) {
    const auto before = runtime_.allocate<cl_uint>("own vertices before", std::size_t{count} + 1);
    runtime_.launch("tiles", "tile_own", over(count), count, cl_ulong{codes_[0]}, cl_ulong{codes_[1]}, codes.codes,
                    before);
    const cl_uint found = primitives_.scan_total(before, count);
    const std::size_t needed = std::size_t{taken_.all} + found;
    if (needed > taken_.ids.size()) reserve(std::min<std::size_t>(input_.n(), std::max(needed, 2 * taken_.ids.size())));
    runtime_.launch("tiles", "tile_take", over(count), count, static_cast<cl_uint>(first_id), taken_.all, codes.codes,
                    before, taken_.points.coordinates, taken_.ids);
    taken_.all += found;
  }

  /// The column of a chunk counts in it; it holds the complement of the least such coordinate.
  void note_outside(cl_ulong of_chunk, std::size_t first_id) {
    if (of_chunk != 0) outside_ = std::max<cl_ulong>(outside_, of_chunk - 2 * first_id);
  }

  /// Room for so many of its own vertices, and all foreign ones; what is there stays.
  void reserve(std::size_t own) {
    const std::size_t room = own + share_.foreign.size();
    auto coordinates = runtime_.allocate<cl_ulong>("coordinates of a tile", room);
    auto ids = runtime_.allocate<cl_uint>("input numbers of a tile", room);
    runtime_.copy(taken_.points.coordinates, coordinates, taken_.all);
    runtime_.copy(taken_.ids, ids, taken_.all);
    taken_.points.coordinates = std::move(coordinates);
    taken_.ids = std::move(ids);
  }

  void add_foreign() {
    if (share_.foreign.empty() || taken_.own == 0) return;
    std::vector<cl_ulong> points;
    for (const std::uint32_t v : share_.foreign) {
      const GridPoint p = input_.at(v);
      points.push_back(static_cast<std::uint32_t>(p[0]) | std::uint64_t{static_cast<std::uint32_t>(p[1])} << 32);
    }
    if (taken_.all + points.size() > taken_.ids.size()) reserve(taken_.all);
    runtime_.write(taken_.points.coordinates, points.data(), points.size(), taken_.all);
    runtime_.write(taken_.ids, share_.foreign.data(), points.size(), taken_.all);
    taken_.all += static_cast<cl_uint>(points.size());
  }

  DevicePool::Lent& lent_;
  Runtime& runtime_;
  Primitives& primitives_;
  const GridInput& input_;
  Staged& staged_;
  const Share& share_;
  const std::array<std::uint64_t, 2> codes_;
  Taken taken_;
  cl_ulong outside_ = 0;
};

template <class T, class From>
std::vector<T> read_all_of(Runtime& runtime, const Buffer<From>& from, std::size_t count) {
  static_assert(sizeof(T) == sizeof(From), "one is read as the other");
  std::vector<T> values(count);
  runtime.read_bytes(from.handle(), 0, values.data(), count * sizeof(T));
  return values;
}

template <class T, class From>
Array<T> read_array(Runtime& runtime, const Buffer<From>& from, std::size_t count) {
  static_assert(sizeof(T) == sizeof(From), "one is read as the other");
  Array<T> values(count);
  runtime.read_bytes(from.handle(), 0, values.data(), count * sizeof(T));
  return values;
}

/// From the input to a SolvedTile.
class TileRun {
 public:
  TileRun(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile)
      : runtime_(lent.runtime), primitives_(lent.primitives), task_(task), share_(share), tile_(tile) {
    Step taking(runtime_, "take");
    Taken taken = Taker(lent, task, share, tile).take();
    taking.end();
    solved_.own = taken.own;
    solved_.move_key = taken.move_key;
    solved_.device = lent.device;
    all_ = taken.all;
    solved_.final.ids = std::move(taken.ids);
    if (taken.own > 0) triangulate(std::move(taken.points));
  }

  SolvedTile finish() {
    if (solved_.own == 0) {
      solved_.final = {};
      return std::move(solved_);
    }
    Step finding(runtime_, "final");
    find_box();
    list_merged();
    find_ends();
    find_final();
    finding.end();
    Step giving(runtime_, "seam");
    give_to_seam();
    keep_final();
    giving.end();
    primitives_.release();
    runtime_.finish();
    return std::move(solved_);
  }

 private:
  const Buffer<cl_uint>& ids() const { return solved_.final.ids; }
  const Buffer<cl_int2>& points() const { return solved_.final.points; }
  cl_uint triangles() const { return made_.mesh.triangles; }

  void triangulate(InputPoints taken) {
    Options options;
    options.grid = FixedGrid{0, 0, "1"};  // vertices are in cells of the common grid
    options.crossing = Crossing::drop;
    options.check = task_.check;
    InputSource source = {all_, share_.constraints.size(), {}};
    source.load = [&] { return DeviceInput{std::move(taken), local_constraints()}; };
    made_ = gcdt::triangulate(runtime_, primitives_, source, options);
    solved_.final.points = runtime_.allocate<cl_int2>("points of a tile", all_);
    runtime_.launch("tiles", "tile_gather_points", over(all_), all_, made_.vertices.input_vertex, made_.vertices.points,
                    solved_.final.points);
  }

  Buffer<cl_uint2> local_constraints() {
    const std::size_t m = share_.constraints.size();
    auto local = runtime_.allocate<cl_uint2>("constraints of a tile", m);
    if (m == 0) return local;
    const auto given = stage(runtime_, Constraints(share_.constraints.data(), m));
    runtime_.launch("tiles", "tile_numbers", over(2 * m), static_cast<cl_uint>(2 * m), solved_.own, all_, ids(), given,
                    local);
    return local;
  }

  void find_box() {
    const auto box = runtime_.filled<cl_uint>("box of a tile", 4, 0);
    runtime_.launch("tiles", "tile_box", over(solved_.own), solved_.own, points(), box);
    cl_uint most[4];
    runtime_.read(box, most, 4);
    solved_.box = {{GCDT_TILE_LAST - most[2], GCDT_TILE_LAST - most[3]}, {most[0], most[1]}};
  }

  void list_merged() {
    const auto before = runtime_.allocate<cl_uint>("merged vertices before", std::size_t{solved_.own} + 1);
    runtime_.launch("tiles", "tile_merged_flags", over(solved_.own), solved_.own, made_.representatives, before);
    const cl_uint count = primitives_.scan_total(before, solved_.own);
    if (count == 0) return;
    const auto merged = runtime_.allocate<cl_uint2>("merged vertices", count);
    runtime_.launch("tiles", "tile_merged", over(solved_.own), solved_.own, before, made_.representatives, ids(),
                    merged);
    solved_.merged = read_all_of<Constraint>(runtime_, merged, count);
  }

  /// The tile's vertices that stand for those of these input numbers.
  std::vector<std::uint32_t> stand_ins(const std::vector<std::uint32_t>& wanted) {
    const auto count = static_cast<cl_uint>(wanted.size());
    if (count == 0) return {};
    const auto list = runtime_.upload("input numbers", wanted), found = runtime_.allocate<cl_uint>("vertices", count),
               standing = runtime_.allocate<cl_uint>("representatives", count);
    runtime_.launch("tiles", "tile_numbers", over(count), count, solved_.own, all_, ids(), list, found);
    runtime_.launch("tiles", "tile_gather", over(count), count, found, made_.representatives, standing);
    return read_all_of<std::uint32_t>(runtime_, standing, count);
  }

  // Of passages and of what was dropped, which passes from now on, too. All that are its own are open ends.
  void find_ends() {
    for (const std::uint32_t c : read_all_of<std::uint32_t>(runtime_, made_.dropped, made_.dropped.size()))
      solved_.dropped.push_back(share_.constraint_ids[c]);
    std::vector<std::uint32_t>& ends = solved_.ends = share_.open_ends;
    for (const std::uint32_t c : solved_.dropped)
      for (const std::uint32_t end : task_.input.constraints[c]) ends.push_back(end);
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    solved_.stand_ins = stand_ins(ends);
  }

  void find_final() {
    final_ = runtime_.allocate<cl_uint>("final triangles", std::size_t{triangles()} + 1);
    if (triangles() == 0) return runtime_.fill<cl_uint>(final_, 0, 1);
    const Box& all = task_.input.box;
    const cl_int4 box = {{static_cast<cl_int>(all.least[0]), static_cast<cl_int>(all.least[1]),
                          static_cast<cl_int>(all.most[0]), static_cast<cl_int>(all.most[1])}};
    const auto [first, last] = task_.cuts.codes_of(tile_);
    runtime_.launch("tiles", "tile_final", over(triangles()), triangles(), made_.mesh.corners, points(), box,
                    cl_ulong{first}, cl_ulong{last}, final_);
    const std::vector<std::uint32_t> passed = passed_triangles();
    if (passed.empty()) return;
    const auto count = static_cast<cl_uint>(passed.size());
    runtime_.launch("tiles", "tile_not_final", over(count), count, runtime_.upload("passed triangles", passed), final_);
  }

  std::vector<std::uint32_t> passed_triangles() {
    std::vector<Passage> passages = share_.passages;
    for (const std::uint32_t c : solved_.dropped)
      passages.push_back({task_.input.constraints[c][0], task_.input.constraints[c][1], false});
    if (passages.empty()) return {};
    std::vector<std::uint32_t> ends;
    for (const Passage& passage : passages) ends.push_back(passage.from), ends.push_back(passage.to);
    ends = stand_ins(ends);
    for (std::size_t i = 0; i < passages.size(); ++i) passages[i].from = ends[2 * i], passages[i].to = ends[2 * i + 1];
    Array<Triangle> corners(triangles());
    Array<Neighbours> neighbours(triangles());
    runtime_.read_bytes(made_.mesh.corners.handle(), 0, corners.data(), corners.size() * sizeof(Triangle));
    runtime_.read_bytes(made_.mesh.neighbours.handle(), 0, neighbours.data(), neighbours.size() * sizeof(Neighbours));
    const auto grid_points = read_array<GridPoint>(runtime_, points(), all_);
    return passed_by({corners, neighbours, grid_points}, passages);
  }

  void give_to_seam() {
    const cl_uint pieces = made_.pieces.count;
    auto wanted = runtime_.filled<cl_uint>("vertices of the seam", std::size_t{solved_.own} + 1, 0),
         kept = runtime_.filled<cl_uint>("kept pieces", pieces, 0);
    if (triangles() == 0)
      runtime_.launch("tiles", "tile_standing", over(solved_.own), solved_.own, made_.representatives, wanted);
    else
      runtime_.launch("tiles", "tile_mark", over(triangles()), triangles(), solved_.own, final_, made_.mesh.corners,
                      made_.mesh.constrained, made_.vertices.levels_buffer, made_.vertices.input_vertex, pieces,
                      pieces_as_vertices(), wanted, kept);
    solved_.kept = read_array<std::uint32_t>(runtime_, kept, pieces);
    const cl_uint count = primitives_.scan_total(wanted, solved_.own);
    const auto list = runtime_.allocate<cl_uint>("vertices of the seam", count);
    primitives_.compact_indices(wanted, list, solved_.own);
    solved_.vertices = seam_vertices(list, count);
    give_pieces();
  }

  Buffer<cl_uint2> pieces_as_vertices() {
    const cl_uint words = 2 * made_.pieces.count;
    auto ends = runtime_.allocate<cl_uint2>("pieces as vertices", made_.pieces.count);
    if (words > 0)
      runtime_.launch("tiles", "tile_gather", over(words), words, made_.pieces.ends, made_.vertices.input_vertex, ends);
    return ends;
  }

  void give_pieces() {
    const Pieces& pieces = made_.pieces;
    const cl_uint count = pieces.count, words = 2 * count;
    solved_.pieces = read_array<Constraint>(runtime_, pieces.ends, count);
    const auto numbered = runtime_.allocate<cl_uint2>("pieces as input numbers", count);
    if (words > 0) runtime_.launch("tiles", "tile_gather", over(words), words, pieces.ends, ids(), numbered);
    solved_.piece_ids = read_array<Constraint>(runtime_, numbered, count);
    solved_.source_offsets = read_array<std::uint32_t>(runtime_, pieces.source_offsets, std::size_t{count} + 1);
    solved_.sources = read_array<std::uint32_t>(runtime_, pieces.sources, pieces.source_count);
    for_each_in_threads(solved_.sources.size(),
                        [&](std::size_t i) { solved_.sources[i] = share_.constraint_ids[solved_.sources[i]]; });
  }

  std::vector<SeamVertex> seam_vertices(const Buffer<cl_uint>& list, cl_uint count) {
    if (count == 0) return {};
    const auto numbers = runtime_.allocate<cl_uint>("input numbers", count);
    const auto where = runtime_.allocate<cl_int2>("points", count);
    runtime_.launch("tiles", "tile_gather", over(count), count, list, ids(), numbers);
    runtime_.launch("tiles", "tile_gather_points", over(count), count, list, points(), where);
    const auto vertices = read_all_of<std::uint32_t>(runtime_, list, count),
               input_numbers = read_all_of<std::uint32_t>(runtime_, numbers, count);
    const auto grid_points = read_all_of<GridPoint>(runtime_, where, count);
    std::vector<SeamVertex> made(count);
    for (std::size_t i = 0; i < count; ++i) made[i] = {vertices[i], input_numbers[i], grid_points[i]};
    return made;
  }

  void keep_final() {
    FinalTriangles& final = solved_.final;
    final.count = primitives_.scan_total(final_, triangles());
    OrderedMesh mesh = std::move(made_.mesh);
    made_ = {};
    final.corners = runtime_.allocate<cl_uint>("final corners", 3 * std::size_t{final.count});
    final.neighbours = runtime_.allocate<cl_int>("final neighbours", 3 * std::size_t{final.count});
    final.constrained = runtime_.allocate<cl_uchar>("final flags", final.count);
    if (final.count == 0) return;
    auto sides = runtime_.allocate<cl_uint>("border edges before", std::size_t{final.count} + 1);
    runtime_.launch("tiles", "tile_finals", over(mesh.triangles), mesh.triangles, final_, mesh.corners, mesh.neighbours,
                    mesh.constrained, final.corners, final.neighbours, final.constrained, sides);
    mesh = {};
    const cl_uint count = primitives_.scan_total(sides, final.count);
    const auto border = runtime_.allocate<cl_uint4>("border", count);
    runtime_.launch("tiles", "tile_border", over(final.count), final.count, sides, final.corners, final.neighbours,
                    final.constrained, border);
    solved_.border = read_all_of<BorderEdge>(runtime_, border, count);
    std::vector<std::uint32_t> ends;
    for (const BorderEdge& edge : solved_.border)
      if (edge.is_on_hull()) ends.push_back(edge.from), ends.push_back(edge.to);
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    if (!ends.empty())
      solved_.hull_vertices =
          seam_vertices(runtime_.upload("vertices of the hull", ends), static_cast<cl_uint>(ends.size()));
  }

  Runtime& runtime_;
  Primitives& primitives_;
  const TileTask& task_;
  const Share& share_;
  const std::size_t tile_;
  cl_uint all_ = 0;  ///< vertices, foreign ones with them
  DeviceTriangulation made_;
  Buffer<cl_uint> final_;  ///< by triangle 1 or 0, then scanned
  SolvedTile solved_;
};

}  // namespace

template <class Use>
void FinalTriangles::for_arrays(Use&& use) {
  use(corners, 0), use(neighbours, 1), use(constrained, 2), use(ids, 3), use(points, 4);
}

template <class T>
void FinalTriangles::spill_one(Runtime& runtime, Buffer<T>& buffer, std::size_t slot) {
  counts_[slot] = buffer.size();
  runtime.read(buffer, spilled_[slot].make<T>(buffer.size()), buffer.size());
  buffer = {};
}

template <class T>
void FinalTriangles::load_one(Runtime& runtime, Buffer<T>& buffer, std::size_t slot) {
  buffer = runtime.upload("final triangles", reinterpret_cast<const T*>(spilled_[slot].bytes.get()), counts_[slot]);
  spilled_[slot] = {};
}

void FinalTriangles::spill(Runtime& runtime) {
  for_arrays([&](auto& buffer, std::size_t slot) { spill_one(runtime, buffer, slot); });
}

void FinalTriangles::release() {
  for_arrays([&](auto& buffer, std::size_t slot) { buffer = {}, spilled_[slot] = {}; });
}

void FinalTriangles::load(Runtime& runtime) {
  for_arrays([&](auto& buffer, std::size_t slot) { load_one(runtime, buffer, slot); });
}

SolvedTile solve_tile(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile) {
  lent.runtime.memory().begin_call();
  lent.runtime.use_programs(runtime::Meshes::one);
  return TileRun(lent, task, share, tile).finish();
}

std::vector<std::uint32_t> write_tile(DevicePool::Lent& lent, FinalTriangles& final, const TilePlaces& places,
                                      Triangle* triangles, Neighbours* neighbours, std::uint8_t* constrained) {
  const auto seam = static_cast<cl_uint>(places.keys.size());
  const std::size_t count = std::size_t{final.count} + seam;
  if (final.count == 0) return std::vector<std::uint32_t>(seam, 0);
  Runtime& runtime = lent.runtime;
  Step writing(runtime, "write");
  if (!final.on_device()) final.load(runtime);
  auto before = runtime.allocate<cl_uint>("final triangles before", seam);
  if (seam > 0) {
    auto keys = runtime.allocate<cl_ulong2>("keys of the seam's triangles", seam);
    runtime.write_bytes(keys.handle(), 0, places.keys.data(), seam * sizeof(places.keys[0]));
    runtime.launch("tiles", "tile_before", over(seam), seam, final.count, keys, final.corners, final.points, before);
  }
  auto at = runtime.allocate<cl_uint>("places of final triangles", final.count);
  runtime.launch("tiles", "tile_places", over(final.count), final.count, seam, before, at);
  const auto corners = runtime.allocate<cl_uint>("output corners", 3 * count);
  const auto others = runtime.allocate<cl_int>("output neighbours", 3 * count);
  const auto flags = runtime.allocate<cl_uchar>("output flags", count);
  runtime.launch("tiles", "tile_write", over(final.count), final.count, cl_uint{places.first}, at, final.ids,
                 final.corners, final.neighbours, final.constrained, corners, others, flags);
  runtime.read_all({{corners.handle(), triangles + places.first, count * sizeof(Triangle)},
                    {others.handle(), neighbours + places.first, count * sizeof(Neighbours)},
                    {flags.handle(), constrained + places.first, count}});
  std::vector<std::uint32_t> counts = read_all_of<std::uint32_t>(runtime, before, seam);
  writing.end();
  return counts;
}

}  // namespace gcdt::tiles

// SPDX-License-Identifier: Apache-2.0
#include "tiles/tile.hpp"

#include "device/parts.hpp"
#include "device/step.hpp"
#include "solve/triangulate.hpp"
#include "tiles/indices.hpp"
#include "tiles/near.hpp"
#include "tiles/passages.hpp"
#include "tiles/read_back.hpp"
#include "tiles/take.hpp"

namespace gcdt::tiles {

using runtime::Buffer;
using runtime::over;
using runtime::Runtime;

namespace {

/// From the input to a SolvedTile.
class TileRun {
 public:
  TileRun(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile)
      : runtime_(lent.runtime), primitives_(lent.primitives), task_(task), share_(share), tile_(tile) {
    Step taking(runtime_, "take");
    Taken taken = take(lent, task, share, tile);
    taking.end();
    solved_.own = taken.own;
    solved_.move_key = taken.move_key;
    solved_.device = lent.device;
    all_ = taken.all;
    solved_.final.ids = std::move(taken.ids);
    places_ = std::move(taken.constraint_places);
    if (taken.own > 0) triangulate(std::move(taken));
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

  // A constraint of the tile is known by its place in the share or, where devices share out constraints, among all of
  // the process.
  std::size_t known_constraints() const {
    return task_.constraints ? task_.input.constraints.size() : share_.constraints.size();
  }
  std::uint32_t number_of(std::uint32_t known) const {
    return task_.constraints ? task_.input.constraints.number_of(known) : share_.constraint_ids[known];
  }
  const Constraint& ends_of(std::uint32_t known) const {
    return task_.constraints ? task_.input.constraints.ends[known] : share_.constraints[known];
  }
  /// Makes a list of the tile's constraints one of what `by` has for them.
  void make_known(const Buffer<cl_uint>& by, const Buffer<cl_uint>& list, std::size_t count) {
    if (count == 0) return;
    runtime_.launch("tiles", "share_known", over(count), static_cast<cl_uint>(count), static_cast<cl_uint>(by.size()),
                    by, list);
  }
  /// Of the tile's constraints the input numbers.
  Buffer<cl_uint> numbers() {
    if (!task_.constraints)
      return runtime_.upload("numbers of constraints", share_.constraint_ids.data(), share_.constraint_ids.size());
    const Array<std::uint32_t>& given = task_.input.constraints.numbers;
    if (given.empty()) return std::move(places_);
    return numbers_at(runtime_, places_, {given.data(), given.size()}, task_.constraints->of_block());
  }

  void triangulate(Taken taken) {
    Options options;
    options.grid = FixedGrid{0, 0, "1"};  // vertices are in cells of the common grid
    options.crossing = Crossing::drop;
    options.check = task_.check;
    InputSource source = {all_, task_.constraints ? taken.constraint_count : share_.constraints.size(), {}};
    source.load = [&] {
      return DeviceInput{std::move(taken.points),
                         task_.constraints ? std::move(taken.constraints) : local_constraints()};
    };
    made_ = gcdt::triangulate(runtime_, primitives_, source, options);
    if (triangles() > 2 * std::uint64_t{all_}) refuse("a tile has more triangles than its vertices can have");
    solved_.final.points = runtime_.allocate<cl_int2>("points of a tile", all_);
    runtime_.launch("tiles", "tile_gather_points", over(all_), all_, made_.vertices.input_vertex, made_.vertices.points,
                    solved_.final.points);
  }

  /// Replaces flags, which are up to `most`, by their sums before each and in all; returns that of all.
  cl_uint scan(const Buffer<cl_uint>& flags, cl_uint count, cl_uint most = 1) {
    const cl_uint sum = primitives_.scan_total(flags, count);
    if (sum > std::uint64_t{most} * count) refuse("a tile's device has counted more than there are");
    return sum;
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
    const cl_uint count = scan(before, solved_.own);
    if (count == 0) return;
    const auto merged = runtime_.allocate<cl_uint2>("merged vertices", count);
    runtime_.launch("tiles", "tile_merged", over(solved_.own), solved_.own, before, made_.representatives, ids(),
                    merged);
    solved_.merged = read_all_of<Constraint>(runtime_, merged, count);
    check_ends_below(solved_.merged, task_.input.n(), "a merged vertex is none of the input");
  }

  /// The tile's vertices that stand for those of these input numbers.
  std::vector<std::uint32_t> stand_ins(const std::vector<std::uint32_t>& wanted) {
    const auto count = static_cast<cl_uint>(wanted.size());
    if (count == 0) return {};
    const auto list = runtime_.upload("input numbers", wanted), found = runtime_.allocate<cl_uint>("vertices", count),
               standing = runtime_.allocate<cl_uint>("representatives", count);
    runtime_.launch("tiles", "tile_numbers", over(count), count, solved_.own, all_, ids(), list, found);
    runtime_.launch("tiles", "tile_gather", over(count), count, found, made_.representatives, standing);
    auto vertices = read_all_of<std::uint32_t>(runtime_, standing, count);
    check_below(vertices, all_, "what stands for the end of a constraint is no vertex of the tile");
    return vertices;
  }

  // Of passages and of what was dropped, which passes from now on, too. All that are its own are open ends.
  void find_ends() {
    if (task_.constraints) make_known(places_, made_.dropped, made_.dropped.size());
    const auto dropped = read_all_of<std::uint32_t>(runtime_, made_.dropped, made_.dropped.size());
    check_below(dropped, known_constraints(), "a dropped constraint is none of the tile");
    for (const std::uint32_t c : dropped) solved_.dropped.push_back({number_of(c), ends_of(c)});
    std::vector<std::uint32_t>& ends = solved_.ends = share_.open_ends;
    for (const Dropped& constraint : solved_.dropped)
      ends.insert(ends.end(), constraint.ends.begin(), constraint.ends.end());
    sort_unique(ends);
    solved_.stand_ins = stand_ins(ends);
  }

  void find_final() {
    final_ = runtime_.allocate<cl_uint>("final triangles", std::size_t{triangles()} + 1);
    if (triangles() == 0) return runtime_.fill<cl_uint>(final_, 0, 1);
    const Box& all = task_.input.box;
    const cl_int4 box = {{static_cast<cl_int>(all.least[0]), static_cast<cl_int>(all.least[1]),
                          static_cast<cl_int>(all.most[0]), static_cast<cl_int>(all.most[1])}};
    const auto [first, last] = task_.cuts.codes_of(tile_);
    const cl_uint shift = shift_of_cells(all, solved_.own), words = GCDT_TILE_ROW * GCDT_TILE_ROW / 32;
    const auto inner = runtime_.allocate<cl_uint>("cells of a tile", words);
    runtime_.launch("tiles", "tile_inner", over(words), words, shift, cl_ulong{first}, cl_ulong{last}, inner);
    runtime_.launch("tiles", "tile_final", over(triangles()), triangles(), made_.mesh.corners, points(), box,
                    cl_ulong{first}, cl_ulong{last}, shift, inner, final_);
    pass();
  }

  /// Of cells such that a row of them, 16 or more, has what is in the box, and where it can be several triangles of
  /// evenly spread vertices fit into one: the circles of nearly all are smaller then.
  static cl_uint shift_of_cells(const Box& box, std::size_t vertices) {
    std::size_t row = GCDT_TILE_ROW;
    while (row > 16 && 16 * row * row > vertices) row /= 2;
    cl_uint shift = 0;
    // Ends: a coordinate has 31 bits.
    while (std::max(box.most[0], box.most[1]) >> shift >= static_cast<std::int64_t>(row)) ++shift;
    return shift;
  }

  /// Triangles that are passed are not final.
  void pass() {
    std::vector<Passage> passages = share_.passages;
    for (const Dropped& constraint : solved_.dropped)
      passages.push_back({constraint.ends[0], constraint.ends[1], false});
    if (passages.empty()) return;
    std::vector<std::uint32_t> ends;
    for (const Passage& passage : passages) ends.push_back(passage.from), ends.push_back(passage.to);
    ends = stand_ins(ends);
    for (std::size_t i = 0; i < passages.size(); ++i) passages[i].from = ends[2 * i], passages[i].to = ends[2 * i + 1];
    const NearMesh near = near_mesh(runtime_, primitives_, made_.mesh, points(), passages);
    std::vector<std::uint32_t> passed = passed_by({near.triangles, near.neighbours, near.points}, near.passages);
    if (passed.empty()) return;
    for (std::uint32_t& t : passed) t = near.numbers[t];
    const auto count = static_cast<cl_uint>(passed.size());
    runtime_.launch("tiles", "tile_not_final", over(count), count, runtime_.upload("passed triangles", passed), final_);
  }

  void give_to_seam() {
    const cl_uint pieces = made_.pieces.count;
    auto wanted = runtime_.filled<cl_uint>("vertices of the seam", std::size_t{solved_.own} + 1, 0);
    auto kept = runtime_.filled<cl_uint>("kept pieces", std::size_t{pieces} + 1, 0);
    if (triangles() == 0)
      runtime_.launch("tiles", "tile_standing", over(solved_.own), solved_.own, made_.representatives, wanted);
    else
      runtime_.launch("tiles", "tile_mark", over(triangles()), triangles(), solved_.own, final_, made_.mesh.corners,
                      made_.mesh.constrained, made_.vertices.levels_buffer, made_.vertices.input_vertex, pieces,
                      pieces_as_vertices(), wanted, kept);
    const cl_uint count = scan(wanted, solved_.own);
    const auto list = runtime_.allocate<cl_uint>("vertices of the seam", count);
    primitives_.compact_indices(wanted, list, solved_.own);
    solved_.vertices = seam_vertices(list, count);
    part_pieces(kept);
  }

  Buffer<cl_uint2> pieces_as_vertices() {
    const cl_uint words = 2 * made_.pieces.count;
    auto ends = runtime_.allocate<cl_uint2>("pieces as vertices", made_.pieces.count);
    if (words > 0)
      runtime_.launch("tiles", "tile_gather", over(words), words, made_.pieces.ends, made_.vertices.input_vertex, ends);
    return ends;
  }

  /// Those that are kept stay on the device. `kept`: flags, which are scanned.
  void part_pieces(const Buffer<cl_uint>& kept) {
    const Pieces& all = made_.pieces;
    const cl_uint count = all.count;
    if (count == 0) return;
    make_known(numbers(), all.sources, all.source_count);
    FinalPieces& final = solved_.final.pieces;
    final.count = scan(kept, count);
    const auto before = runtime_.allocate<cl_uint>("sources of kept pieces before", std::size_t{count} + 1);
    runtime_.launch("tiles", "pieces_sources", over(count), count, kept, all.source_offsets, before);
    final.source_count = primitives_.scan_total(before, count);
    if (final.source_count > all.source_count) refuse("the sources of a piece are not there");
    const cl_uint of_seam = count - final.count, seam_sources = all.source_count - final.source_count;
    final.ends = runtime_.allocate<cl_uint2>("kept pieces", final.count);
    final.offsets = runtime_.allocate<cl_uint>("kept source offsets", std::size_t{final.count} + 1);
    final.sources = runtime_.allocate<cl_uint>("kept sources", final.source_count);
    const auto ends = runtime_.allocate<cl_uint2>("pieces of the seam", of_seam);
    const auto offsets = runtime_.allocate<cl_uint>("source offsets of the seam", std::size_t{of_seam} + 1),
               sources = runtime_.allocate<cl_uint>("sources of the seam", seam_sources);
    runtime_.launch("tiles", "pieces_part", over(count), count, kept, before, all.ends, all.source_offsets, all.sources,
                    final.ends, final.offsets, final.sources, ends, offsets, sources);
    runtime_.fill<cl_uint>(final.offsets, final.source_count, 1, final.count);
    runtime_.fill<cl_uint>(offsets, seam_sources, 1, of_seam);
    // Each piece has some source: where there are as many sources as pieces, each has one.
    if (final.source_count == final.count) final.offsets = {};
    solved_.pieces = read_array<Constraint>(runtime_, ends, of_seam);
    check_ends_below(solved_.pieces, all_, "the end of a piece is no vertex of the tile");
    if (seam_sources != of_seam) {
      solved_.source_offsets = read_array<std::uint32_t>(runtime_, offsets, std::size_t{of_seam} + 1);
      check_offsets(solved_.source_offsets, of_seam, seam_sources, "the sources of a piece are not there");
    }
    solved_.sources = read_array<std::uint32_t>(runtime_, sources, seam_sources);
    check_below(solved_.sources, task_.input.constraints.count, "a source of a piece is no constraint of the input");
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
    check_below(input_numbers, task_.input.n(), "a vertex of the seam is none of the input");
    check_each(count, "a vertex of the seam is not on the grid",
               [&](std::size_t i) { return grid_points[i][0] >= 0 && grid_points[i][1] >= 0; });
    std::vector<SeamVertex> made(count);
    for (std::size_t i = 0; i < count; ++i) made[i] = {vertices[i], input_numbers[i], grid_points[i]};
    return made;
  }

  void keep_final() {
    FinalTriangles& final = solved_.final;
    const cl_uint all = final.triangles = triangles();
    final.corners = std::move(made_.mesh.corners);
    final.neighbours = std::move(made_.mesh.neighbours);
    final.constrained = std::move(made_.mesh.constrained);
    final.before = std::move(final_);
    made_ = {};
    const auto sides = runtime_.allocate<cl_uint>("border edges before", std::size_t{all} + 1);
    if (all > 0) runtime_.launch("tiles", "tile_sides", over(all), all, final.before, final.neighbours, sides);
    final.count = scan(final.before, all);
    if (final.count == 0) return;
    const cl_uint count = scan(sides, all, 3);
    const auto border = runtime_.allocate<cl_uint4>("border", count);
    runtime_.launch("tiles", "tile_border", over(all), all, sides, final.before, final.corners, final.neighbours,
                    final.constrained, border);
    solved_.border = read_all_of<BorderEdge>(runtime_, border, count);
    check_each(count, "an edge of the border is of no final triangle", [&](std::size_t i) {
      const BorderEdge& edge = solved_.border[i];  // final triangles have no vertex of another tile
      return edge.triangle < final.count && edge.k() < 3 && edge.from < solved_.own && edge.to < solved_.own;
    });
    std::vector<std::uint32_t> ends;
    for (const BorderEdge& edge : solved_.border)
      if (edge.is_on_hull()) ends.push_back(edge.from), ends.push_back(edge.to);
    sort_unique(ends);
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
  Buffer<cl_uint> places_;  ///< of the tile's constraints, where devices share them out
  Buffer<cl_uint> final_;   ///< by triangle 1 or 0, then scanned
  SolvedTile solved_;
};

}  // namespace

SolvedTile solve_tile(DevicePool::Lent& lent, const TileTask& task, const Share& share, std::size_t tile) {
  lent.runtime.memory().begin_call();
  lent.runtime.use_programs(runtime::Meshes::one);
  return TileRun(lent, task, share, tile).finish();
}

}  // namespace gcdt::tiles

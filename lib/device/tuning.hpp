// SPDX-License-Identifier: Apache-2.0
// Choices that results do not depend on, only speed. Everybody has the defaults; bench/ablation.cpp varies them, and
// tests take by them, on any device and with few vertices, the ways that others take (docs/testing.md).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace gcdt {

/// What the work-items of a device are: everything that is done in one way here and in another way there goes by it.
enum class DeviceKind {
  gpu,
  threads,      ///< of a CPU: each a loop of a thread, which takes contiguous shares (kernels/common/loops.h)
  lanes,        ///< of a CPU: lanes of vectors, in Mesa's llvmpipe; there loops may end early (docs/devices.md)
  accelerator,  ///< nobody knows
};

inline bool is_cpu(DeviceKind kind) { return kind == DeviceKind::threads || kind == DeviceKind::lanes; }

struct Tuning {
  /// As what the device is to be treated; none: as what it is.
  std::optional<DeviceKind> kind;
  /// Vertices of the coarsest level at most, which goes into the symbolic triangle at once. Small enough for one
  /// work-group, large enough that the levels below it would cost more launches than they save flips. (With 16,384 a
  /// grid of a million takes a fifth longer: NOTES, "Fewer levels, larger patches".)
  std::uint32_t coarsest_level = 256;
  /// How much less deep than evenly spread vertices of a level those have to be that come early because they are
  /// isolated, in depths of the quadtree (phases/levels.hpp): with less, islands of a map come too early; with more,
  /// chains stay (NOTES, "Isolated vertices").
  int isolation_margin = 4;
  /// There are dense rows where so many times as many vertices are deep as of evenly spread ones, and so many more: a
  /// thin ring of random vertices has 26 times as many, and no chains of flips; few vertices make short chains.
  std::uint32_t times_evenly = 64, least_row = 256;
  /// Rounds of flips between two blocking reads, and of insertion at most, if that is more than
  /// `most_insertion_rounds`: reads cost about as much as one or two rounds. 1: read after each. (More on a pool's
  /// GPUs: pool_plan.cpp.)
  std::uint32_t rounds_per_read = 4;
  /// Rounds that one work-group does by itself in a launch at most, which bounds the launch.
  std::uint32_t rounds_of_group = 1024;
  /// 64-bit keys up to which groups sort blocks in local memory, which are merged four by four: a launch for four
  /// times the width where a sort by digits has four for each five bits (NOTES, "Sorting few keys"). Keys of at most
  /// GCDT_MOST_BITS_BY_DIGIT bits are sorted by digits however few they are.
  std::uint32_t most_merged = 1u << 18;
  /// Rows of a table of quality that are read back; more are folded on the device, so many of them to one in a launch:
  /// an H200's 135,000 in two, by work-items with few rows each (NOTES, "Scans and folds").
  std::uint32_t rows_read = 1024, rows_folded = 32;
  /// Candidates of a round of refinement that a GPU ranks by comparing all with all, in one launch instead of a sort's.
  std::uint32_t most_ranked_by_count = 1u << 13;
  /// Candidates of a round of refinement up to which one work-group does the first rounds of flips, and the host reads
  /// nothing before the next search, on a GPU (NOTES, "Rounds that are read once").
  std::uint32_t most_unread = 1u << 13;
  /// Tours of cavities that a GPU makes by teams of eight work-items: more fill it by one work-item each (NOTES, "Stars
  /// and teams").
  std::uint32_t most_by_teams = 1u << 15;
  /// Aims of a round of refinement that one work-item does by itself, where it is a thread; 0: none. And rounds of a
  /// launch of it at most (NOTES, "Small rounds").
  std::uint32_t most_tail_aims = 256, rounds_of_tail = 16;
  /// Up to so many vertices are inserted by one work-group that loops by itself: a round there costs about a
  /// microsecond, two launches cost ten times that.
  std::uint32_t one_group_vertices = 1024;
  /// The same of edges that are tested: the tail of small rounds needs no launch and no read.
  std::uint32_t one_group_edges = 2048;
  /// From so many edges on flips begin within patches, each by a work-group in its local memory; vertices of a patch at
  /// most, if there is room (NOTES, "Patches in local memory"); rounds of a patch or district at most.
  std::uint32_t least_patched = 1u << 21, patch_vertices = 768, rounds_of_patch = 8;
  /// Local memory of a patch at most, and what kernels have besides.
  static constexpr std::uint32_t most_patch_bytes = 48u << 10, spare_local_bytes = 256;
  /// From so many edges on they go on within districts, instead of sweeps: of so many vertices first, then of four
  /// times as many. One edge in so many, about, is left.
  std::uint32_t least_divided = 3u << 21, district_vertices = 2048;
  static constexpr std::uint32_t most_district_vertices = 4096, left_by_districts = 64;
  /// From so many edges on, rounds of flips sweep over the marks of all edges, for as long as a round has at least one
  /// in `sweep_share` of them illegal: a sweep reads 4 bytes an edge, a list loses the order of the edges.
  std::uint32_t least_sweep = 1u << 17, sweep_share = 32;
  /// Stamps of tickets that are given out at most before the claim words are cleared, at least 2; no more than fit.
  std::uint32_t most_stamps = 0xFFFFFFFFu;
  /// Parts of constraints beyond one each, at most; none: by the device (walk.cpp). 0: one work-item a constraint.
  std::optional<std::uint32_t> part_pool;
  /// Crossed faces of a part, about: enough to be worth finding its first face.
  std::uint32_t crossings_per_part = 8;
  /// Crossed faces a constraint from which on they are cleaned in the order of the curve; none: by the device, below.
  std::optional<std::uint32_t> curve_crossings;
  /// Constraints that are edges already from which on they are left out of what is enforced, if they are a quarter of
  /// all; 0: always; none: by the device, below.
  std::optional<std::uint32_t> least_existing;
  /// Edges of the mesh from which on, where vertices come in rounds, new triangles have slots of faces that their own
  /// piece crosses, if a piece crosses so many at most: later flips find them where they look
  /// (kernels/constrain/slots.cl).
  std::uint32_t least_grouped = 1u << 22, grouped_crossings = 8;
  /// Crossed faces, as many times as the mesh has faces, from which on some constraints are taken ahead of the
  /// others; none: by the device, below.
  std::optional<std::uint32_t> crossings_ahead;
  /// The same from which on walks are given gates; none: by the device, below, and never if no buffer can hold them.
  std::optional<std::uint32_t> crossings_gated;
  /// Crossed faces a part from which on parts are walked in order of these; none: by the device, below.
  std::optional<std::uint32_t> crossings_ordered;
  /// Up to so many vertices, where a work-item is a thread, one orders, puts out and checks all of them
  /// (kernels/programs/by_one_item.cl): in less time than the launches and blocking reads take that other threads would
  /// need to help it, each of which wakes all of them (bench/NOTES.md).
  std::uint32_t one_item_vertices = 2048;
  /// It orders so many times as many: ordering has the most launches and reads for the work that it does (NOTES, "Few
  /// vertices on CPUs").
  static constexpr std::uint32_t one_item_orders = 6;
  /// Whether the calling thread does by itself what there is to do with few vertices, where work-items are threads and
  /// the memory is the host's (host_kernels.hpp); none: unless somebody watches the OpenCL calls. Larger buffers than
  /// `most_shared` bytes are not the host's: few vertices need none.
  std::optional<bool> works_here;
  /// Up to so many vertices it does all, and to as many times more as a second thread brings less of: with u units
  /// u / (u - 1) times (bench/NOTES.md, "Few vertices on the calling thread").
  std::uint32_t here_vertices = 8192;
  static constexpr std::size_t most_shared = std::size_t{16} << 20;
  /// Work-groups of launches, but for those of one group, while there are several runtimes; 0: as many as they want;
  /// none: where the driver needs them to be of one width, as many as the widest has (runtime.cpp).
  std::optional<std::uint32_t> width;
  /// Whether transfers go through memory of the driver's own, and the room for results is made while the device works
  /// (transfer_chunks.hpp, host_room.hpp); none: where the device's threads are not the host's, on GPUs.
  std::optional<bool> prepares_host_memory;
  /// Threads that make room for a single call's result; 0: none do. Clearing a page is bound by a thread, and one
  /// clears less while an H200 works than its result has (NOTES, "The caller's clock").
  std::uint32_t room_threads = 3;
  /// Chunks through which a solver's large transfers go, and bytes of each: memory that the solver keeps pinned. With
  /// more chunks, more threads copy at once; smaller ones are not worth their start (NOTES, "The caller's clock").
  std::uint32_t transfer_chunks = 16;
  std::size_t transfer_chunk = std::size_t{1} << 21;
  /// Bytes of a transfer that goes through them; smaller ones go as the driver likes, which takes them at once.
  std::size_t least_chunked = std::size_t{1} << 20;
  /// Threads that copy between chunks and the caller's memory at most, the caller's included: each about 10 GB/s, where
  /// the device takes 55. Bytes that are worth one more, for which a thread is started (NOTES, "The caller's clock").
  std::uint32_t copy_threads = 6;
  std::size_t copied_by_thread = std::size_t{1} << 22;
  /// Memory that the device is taken to have, if it has more; none: all.
  std::optional<std::uint64_t> memory_bytes;
  /// Whether each block is a buffer of its own, of just the bytes asked for, and gone when it is handed back: so a test
  /// sees what is written beside it, and what is read that nobody wrote (docs/testing.md).
  bool fresh_buffers = false;
  /// Whether rounds of insertion and flips by one work-group tell the compiler how many work-items that has
  /// (kernels/common/shared.h, GCDT_ONE_GROUP); none: on NVIDIA's GPUs, whose compiler takes 256 at most for granted
  /// otherwise, so that rounds of one group take twice as long (NOTES, "Launches").
  std::optional<bool> states_one_group;
  /// Programs that threads build at once (built_programs.hpp); none: on GPUs, if their drivers compile a program when
  /// it is built, five, after which NVIDIA's compiler is no faster (NOTES, "First call"); elsewhere one.
  std::optional<std::uint32_t> builds_at_once;
  static constexpr std::uint32_t builds_of_gpu = 5;
  /// Workers of a pool on a device, each with one run at a time; none: by the kind of device (pool_plan.cpp).
  std::optional<std::uint32_t> workers;
  /// Milliseconds that a run of a pool takes whatever is in it; none: by the kind of device.
  std::optional<double> job_overhead;
  /// Whether the workers of a device share a context, so that the device does not change contexts whenever one worker
  /// waits; none: on GPUs. (A context that the application brings is shared in any case.)
  std::optional<bool> shares_context;
  /// Whether a pool launches all kernels of the device once in the first batch (warmup.hpp), while other devices work
  /// on it; none: on a CPU beside GPUs.
  std::optional<bool> warms_up;

  // The rest is the same in every run: nothing but speed depends on it. Each says what it is a number of, what it
  // trades, and where that was measured; NOTES is bench/NOTES.md.

  // ---- Ways, which the plan chooses by ----------------------------------------------------------

  /// Vertices of a problem that one work-group inserts and flips by itself: saves launches and reads, but a larger one
  /// would be at it when all others are done (not measured). Of lanes: their loops may end early
  /// (docs/devices.md).
  static constexpr std::uint32_t most_of_a_group = 2048, most_of_a_group_of_lanes = 256;
  /// Vertices of a launch of many problems, which must not last for seconds: 12 ms on an H200 (NOTES, "Batches").
  static constexpr std::uint32_t most_of_a_launch = 1u << 24;
  /// Vertices of a problem whose constraints one work-item enforces, while they are in its cache: each begins with a
  /// look around its first vertex, whatever the degree (NOTES, "CPUs").
  static constexpr std::uint32_t most_enforced_by_one = 1u << 14;
  /// Pieces of a problem of which all are compared with all for crossings, by one loop each: saves the records of
  /// faces, costs their square (not measured). Of lanes: their loops may end early.
  static constexpr std::uint32_t most_of_all_pairs = 1u << 16, most_of_all_pairs_of_lanes = 1u << 11;

  // ---- Programs that only save time (solve/programs.hpp) ------------------------------------------

  /// The first call of a process goes without them below so many edges, and does so many rounds of a phase by launches
  /// before one work-group does those of few: a round there costs 10 microseconds more, its program 0.1 s and more
  /// (NOTES, "First call").
  static constexpr std::uint32_t least_all_programs = 1u << 22, rounds_without_few = 1024;

  // ---- Flips (flip.cpp) -------------------------------------------------------------------------

  /// Of the edges of a list, what is left after `rounds_per_read` rounds is about one in so many; of those that sweeps
  /// leave, after each round: guesses, by which the host goes without reads. And rounds between two reads at most,
  /// where guesses fail because flips depend on each other (NOTES, "Reads").
  static constexpr std::uint32_t flipped_between_reads = 6, flipped_after_sweeps = 2, most_between_reads = 16;
  /// Rounds of insertion between two reads at most, or `rounds_per_read`, if that is more: uniform vertices take seven
  /// where a level has fifteen for each coarser one. Where there are more than so many for each, most faces have more
  /// than one to begin with (NOTES, "Launches").
  static constexpr std::uint32_t most_insertion_rounds = 8, crowded_level = 7;

  // ---- Launches (runtime.cpp) -------------------------------------------------------------------

  /// Work-items of a group. 128 keep occupancy on GPUs with kernels of 64 or more registers (NOTES, "Single problems":
  /// 64 and 256 are no faster); on CPUs whose groups are lanes of vectors 64 amortise a group's start (not measured).
  static constexpr std::size_t gpu_group = 128, cpu_group = 64;
  /// Work-items of the group that does whole rounds by itself: 256 are slower, and 1024, with fewer registers each, too
  /// (NOTES, "Launches").
  static constexpr std::size_t gpu_single_group = 512;
  /// Work-items of a group that flips within a patch, or sorts a block: few such groups at a time fill a unit, whose
  /// caches have room for them (NOTES, "Fewer levels, larger patches" and "Scans and folds"; 512: not
  /// measured).
  static constexpr std::size_t gpu_wide_group = 256;
  /// Groups per compute unit: enough to fill a GPU's schedulers (NOTES, "Single problems": 6 to 4096 tried); on CPUs
  /// enough to even out the load (not measured).
  static constexpr std::size_t gpu_groups_per_unit = 32, cpu_groups_per_unit = 64;
  /// The same of groups that keep rows of tables: enough to read at the memory's speed, as few rows as that
  /// takes (NOTES, "Scans and folds").
  static constexpr std::size_t gpu_row_groups_per_unit = 8;
  /// Where a group is one work-item that loops over its share by itself: items of a share at least, which amortise its
  /// start, and shares per compute unit, which let threads end together (not measured).
  static constexpr std::size_t least_share = 64, shares_per_unit = 16;

  // ---- Memory and transfers ---------------------------------------------------------------------
  // (buffer_pool.cpp, runtime.cpp, transfer_chunks.cpp, copy_crew.cpp, host_room.cpp)

  /// Buffers' sizes are rounded up to multiples of 1/16 of the power of two below, at least of 1024 bytes, so that
  /// inputs of about one size share buffers: costs 6 % of memory at most.
  static constexpr unsigned steps_per_doubling = 16;
  static constexpr std::size_t least_bytes = 1024;
  /// Bytes of a free buffer that serves however much smaller the one asked for is; others serve up to twice as large.
  static constexpr std::size_t small_bytes = std::size_t{1} << 16;
  /// Calls that a free buffer is kept without a use: saves allocations of calls by turns, costs memory (not measured).
  static constexpr std::uint64_t calls_kept = 2;
  /// Bytes of a write that is copied and not waited for, where threads take longer to wake up than the copy does
  /// (NOTES, "CPUs": small writes).
  static constexpr std::size_t most_copied = std::size_t{1} << 16;
  /// Bytes of a read that goes through memory of the driver's own: counters, reports, maxima (NOTES, "Launches").
  static constexpr std::size_t page = std::size_t{1} << 16;
  /// How long a wait yields before it sleeps, and how long it sleeps: a thread that sleeps comes back some 70
  /// microseconds later, which a run of small problems would feel; one that yields takes a core.
  static constexpr std::chrono::microseconds patience{200}, nap{20};
  /// Bytes of a chunk of a pool's upload: large enough that a transfer (19 microseconds a MiB) takes longer than its
  /// start; small enough that a chunk is still in the host's caches when it is read (NOTES, "Batches").
  static constexpr std::size_t gpu_upload_chunk = std::size_t{1} << 20, cpu_upload_chunk = std::size_t{1} << 18;
  /// Bytes of a chunk of a pool's download: smaller ones are not worth their start, larger ones no faster (NOTES,
  /// "Batches"). Less than `least_streamed` bytes, counters and the like, are read at once (not
  /// measured).
  static constexpr std::size_t download_chunk = std::size_t{1} << 20, least_streamed = std::size_t{1} << 16;
  /// Bytes that a thread copies to or from a chunk before it looks for others: some 25 microseconds' work, so that the
  /// first and the last chunk of a transfer are shared by all threads (NOTES, "The caller's clock").
  static constexpr std::size_t copied_at_once = std::size_t{1} << 18;

  // ---- Scans and sorts --------------------------------------------------------------------------
  // (primitives.cpp; sizes of tiles and digits: kernels/sort/sizes.h)

  /// Parts per compute unit: more groups than a GPU unit holds at once (NOTES, "Sorts"); on CPUs enough to even out the
  /// load, and few, because each sort part brings 256 counters (not measured).
  static constexpr std::size_t gpu_scan_parts_per_unit = 32, cpu_scan_parts_per_unit = 4;
  /// Elements that are worth a part of their own: of a group's scan one tile, as small tables are scanned too (NOTES,
  /// "Scans and folds"); of a work-item's not measured.
  static constexpr std::size_t scan_span_group = 512, scan_span_serial = 4096, sort_span_serial = 4096;
  /// Fewer keys than that a CPU sorts by one work-item, and begins with the high bits, or with buckets, from them on:
  /// launches for each digit cost more below (NOTES, "Few vertices on CPUs"). Groups use buckets from as many on, and
  /// merge blocks of up to `most_merged` keys that have none.
  static constexpr std::size_t least_by_prefix = std::size_t{1} << 14;
  /// Keys of a run that a work-item sorts by insertion; longer runs are a work-group's (NOTES, "Batches").
  static constexpr std::uint32_t longest_run = 32;
  /// Pairs of a bucket that one work-item sorts on a CPU, where those of longer ones are taken out: ten launches more,
  /// in which all threads take part (NOTES, "Few vertices on CPUs").
  static constexpr std::uint32_t longest_bucket = 16384;

  // ---- Order ------------------------------------------------------------------------------------
  // (order.cpp, order_problems.cpp)

  /// High bits of Morton codes that are sorted by beyond those that tell n evenly spread vertices apart: 16 cells a
  /// vertex, so runs to be mended are short (NOTES, "Single problems": bit_width(n) + 4).
  static constexpr unsigned spare_bits = 4;
  /// Of the vertices that come up to a level by their rank, as many isolated ones come besides as are this share of
  /// them (NOTES, "Isolated vertices": half takes the same rounds).
  static constexpr std::uint32_t share_isolated = 4;
  /// Vertices of a batch that one work-item surveys and quantises: few enough that a batch of small problems fills a
  /// GPU, many enough that a row of maxima costs little beside them (not measured).
  static constexpr std::uint32_t least_chunk = 64;
  /// Chunks of one problem that are folded by one work-item (not measured).
  static constexpr std::uint32_t most_chunks = 32768;

  // ---- Insertion by threads ---------------------------------------------------------------------
  // (grow.cpp)

  /// Vertices of the levels that one work-item inserts, one after the other: a thread's share of less is not worth a
  /// launch (not measured).
  static constexpr std::uint32_t most_grown_by_one = 4096;
  /// Vertices of a share at least (not measured), and shares per compute unit: what lies along their borders is left,
  /// flipped and inserted again, so that more shares than even out the units' work cost more than they save (NOTES,
  /// "Shares of a thread").
  static constexpr std::uint32_t least_grown = 1024, grown_shares_per_unit = 2;
  /// Shares that the next round joins, whose leavings lie along the borders between them: four cells of the curve to
  /// one (NOTES, "CPUs").
  static constexpr std::uint32_t grown_joined = 4;
  /// Faces that a walk visits where others may change the mesh beside it, and so might lead it in circles; the vertex
  /// is then left to the next round (not measured).
  static constexpr std::uint32_t walk_beside_others = 4096;

  // ---- Constraints ------------------------------------------------------------------------------
  // (walk.cpp, split.cpp)

  /// Parts of constraints: a GPU wants some hundred thousand work-items (NOTES, "Single problems": 2^15 to 2^19
  /// tried); a CPU, per compute unit, only enough to even out its threads' load (not measured).
  static constexpr std::uint32_t gpu_parts = 1u << 17, cpu_parts_per_unit = 512;
  /// Where parts would have more crossed faces than so many, a GPU gets more parts, up to half as many as there are
  /// vertices: a launch lasts as long as its longest walks, and lanes wait for the longest beside them. A part takes
  /// some 100 bytes (NOTES, "Many crossings").
  static constexpr std::uint32_t gpu_long_parts = 1u << 19, crossings_of_long = 32;
  /// Pieces with many parts get so many times as many on GPUs, within gpu_long_parts: what a long piece crosses may lie
  /// in few of its parts, as where the border of a domain goes through the faces of the last level, and a launch lasts
  /// as long as the longest (NOTES, "Long pieces": 8 and 16 counted, 8 measured).
  static constexpr std::uint32_t gpu_long_piece = 8;
  /// Crossed faces a constraint from which on GPUs clean them in the order of the curve: lanes side by side then read
  /// the same faces (NOTES, "Many crossings"). Constraints that a group puts into its cells at least, and groups at
  /// most: each has a word for each cell, which are scanned (not measured).
  static constexpr std::uint32_t gpu_curve_crossings = 16, least_curve_span = 2048, most_curve_parts = 256;
  /// Crossed faces, as many times as the mesh has faces, from which on every `step_ahead`-th constraint is cleaned and
  /// enforced ahead of the others: twice two phases with little to walk, which on GPUs are some 65 launches more
  /// (NOTES, "Constraints in turn").
  static constexpr std::uint32_t gpu_crossings_ahead = 40, gpu_step_ahead = 16, cpu_crossings_ahead = 8,
                                 cpu_step_ahead = 8;
  /// The same from which on a GPU's walks are given gates; a CPU's find all they need in lines of 64 bytes (NOTES,
  /// "Many crossings").
  static constexpr std::uint32_t gpu_crossings_gated = 2;
  /// Crossed faces a part from which on a GPU's lanes wait longer for those beside them than it takes to order parts;
  /// and parts that are ordered with one another: more of them lie too far apart to read the same (NOTES, "Lanes that
  /// walk as far").
  static constexpr std::uint32_t gpu_crossings_ordered = 24, parts_ordered_together = 256;
  /// Constraints that are edges already from which on it pays to leave them out: a few launches and a read (NOTES,
  /// "Edges already").
  static constexpr std::uint32_t gpu_least_existing = 1u << 18, cpu_least_existing = 1u << 11;
  /// Entries of a layer over the chains up to which one work-group makes it and those above: a launch for each would
  /// take longer (NOTES, "Many crossings").
  static constexpr std::uint32_t minima_of_group = 1024;
  /// Crossed faces of a part on threads, about: where a part begins takes as long to find as some to hundreds of faces
  /// to cross (NOTES, "Threads: parts": a closed comb of 1000 vertices cleaned in 0.7 ms instead of 4.9).
  static constexpr std::uint32_t cpu_crossings_per_part = 128;
  /// Parts that even the shortest total length gets: keeps a few long pieces on many work-items (not measured).
  static constexpr std::uint32_t gpu_least_parts = 4096, cpu_least_parts = 64;
  /// Crossing pairs that are split together: some 50 bytes each, besides 40 for each distinct pixel (not measured).
  static constexpr std::uint32_t pairs_split_at_once = 1u << 22;

  // ---- Regions and queries ----------------------------------------------------------------------
  // (domain.cpp, locate.cpp)

  /// Rounds of labels between two blocking reads (not measured).
  static constexpr std::uint32_t label_rounds_per_read = 8;
  /// Queries in the device's memory at once: 40 bytes each and what is copied back; more are no faster (not measured).
  static constexpr std::size_t queries_at_once = std::size_t{1} << 20;

  // ---- Pools: jobs and workers ------------------------------------------------------------------
  // (pool_plan.cpp, schedule.cpp, copy.cpp)

  /// The greatest weight of a job, in vertices and constraints. A CPU is fastest if a job stays in its caches: it takes
  /// 2.0 microseconds a vertex with 75,000 vertices, and 4.9 with 2.2 million. A GPU needs enough vertices to make
  /// launches cheap, but not so many that the host cannot keep up with copying the results.
  static constexpr std::uint64_t cpu_weight = 1u << 17, gpu_weight = 1u << 24;
  /// Workers of a GPU. Copying results to the host takes longer than making them, and the GPU would stand still
  /// meanwhile. They share a context, because a GPU changes slowly from one context to another, and would do so each
  /// time that a worker waits (NOTES, "Batches": two, four to six workers).
  static constexpr std::uint32_t gpu_workers = 3;
  /// Workers of a CPU with several cores: one of them gathers input, chooses grids and copies results while the
  /// kernels of the other use all cores (NOTES, "Two workers of a CPU").
  static constexpr std::uint32_t cpu_workers = 2;
  /// Rounds of insertion and of flips between two reads of a GPU. A wait costs more than a few rounds that find
  /// nothing, because the work of other workers goes before this worker's next launch (NOTES, "Batches": 10de70b).
  static constexpr std::uint32_t gpu_rounds_per_read = 16;
  /// Milliseconds that some 120 launches and 20 waits take: an H200 takes 3.7 for 100 sketches (NOTES, "Batches": 4).
  static constexpr double gpu_overhead = 2;
  /// Compute units that CPU devices leave to each worker of a GPU: one for its thread, and one for the thread that
  /// makes room for its results (NOTES, "Batches": "PoCL beside an H200").
  static constexpr std::uint32_t cores_per_gpu_worker = 2;
  /// The fixed cost of a problem, in vertices and constraints: it takes about 0.7 microseconds on the host and on an
  /// H200 whatever its size, and an H200 does 70 vertices and constraints a microsecond (NOTES, "Batches": b0b92ff).
  static constexpr std::uint64_t problem_weight = 48;
  /// The weight of a first job where the throughput is unknown: large enough to measure it, small enough to lose no
  /// time on a slow worker (not measured).
  static constexpr double first_weight = 20000;
  /// A worker takes `part_of_rest` of its share of the rest, since throughputs are not exact. It takes all of its share
  /// if the end is at most `last_milliseconds` away, and the whole rest if it would leave less than it does in
  /// `least_left_milliseconds`. First jobs of a device's workers differ in size unless the end is nearer than
  /// `little_milliseconds` (NOTES, "Batches": b0b92ff and what follows it).
  static constexpr double part_of_rest = 0.8, last_milliseconds = 60, least_left_milliseconds = 10,
                          little_milliseconds = 40;
  /// A job's contents take at least so many times as long as its overhead (NOTES, "Batches": one worker for small
  /// batches).
  static constexpr double least_overheads = 3;
  /// At least this part of a run's time counts as spent on the contents, because the overhead is only an estimate (not
  /// measured).
  static constexpr double least_part_of_contents = 0.25;
  /// A worker steals a job only if its own run, times this margin, is shorter than what the owner still needs. A stolen
  /// job is expected to take at least so many milliseconds (not measured).
  static constexpr double theft_margin = 1.5, least_theft_milliseconds = 5;
  /// The part of a GPU's throughput below which a CPU beside it does harm: it takes cores from the threads that feed
  /// the GPU (NOTES, "Batches": "PoCL beside an H200").
  static constexpr double least_part_of_gpu = 0.125;
  /// How often an idle worker looks for a job to steal, and how often progress is reported (not measured).
  static constexpr std::chrono::milliseconds steal_interval{5}, progress_interval{50};
  /// A thread makes room for the results of jobs or calls of so many vertices or more: for fewer it is not worth its
  /// start (not measured).
  static constexpr std::uint64_t least_prepared_vertices = 1u << 15;
  /// Vertices of the input that a tile looks through at once: as many as a part of the device's memory has room for at
  /// 32 bytes each, within these: a chunk takes two waits (NOTES, "Tiles").
  static constexpr std::size_t least_tile_chunk = std::size_t{1} << 14, most_tile_chunk = std::size_t{1} << 24;
  static constexpr std::uint64_t part_of_tile_chunk = 512;
  /// Constraints of a block that a device of a pool shares out: as many as a part of its memory has room for at 32
  /// bytes each, and at most so many, since devices take blocks by turns.
  static constexpr std::size_t most_constraints_of_block = std::size_t{1} << 22;
  static constexpr std::uint64_t part_of_constraint_block = 2048;
  /// Of so many of the host's cores one makes room for the result of tiles.
  static constexpr unsigned cores_of_room_thread = 4;
  /// Threads beside the caller's that loops of the host share while a problem is solved in tiles (not measured).
  static constexpr std::size_t most_of_crew = 15;
  /// Bytes of a problem that are prefetched before it is gathered: as much as a first cache holds (NOTES, "Batches").
  static constexpr std::size_t most_prefetched = std::size_t{1} << 15;
};

}  // namespace gcdt

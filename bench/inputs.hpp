// SPDX-License-Identifier: Apache-2.0
// The inputs of the benchmark (bench/README.md): which there are, and how each is made.
#pragma once

#include <functional>
#include <gcdt/array.hpp>
#include <string>
#include <vector>

#include "workloads.hpp"

namespace gcdt::bench {

using test::Point;
using test::Segment;
using test::Workload;

/// One row of the table: a recipe and the number of vertices asked of it (about what it makes; exact
/// but for the recipes that draw whole shapes). For a map, `name` is the file's and size 0.
struct Input {
  std::string name;
  std::size_t size = 0;
  std::string path;  ///< of a map in Triangle's .poly format
};

enum class List { gpu, cpu, scaling, shapes };

/// The rows of `list`, short ones first; `maps` are .poly files.
std::vector<Input> inputs(List list, const std::vector<std::string>& maps);
/// At most `most` vertices each, and no row twice: proves that everything works, measures nothing.
std::vector<Input> quick(const std::vector<Input>& rows, std::size_t most);
/// Whether `selection`, names or name:size separated by commas, names `input`; an empty one names all.
bool selected(const Input& input, const std::string& selection);

/// Makes the input. `triangles` triangulates points: synthetic_cons takes its constraints from a
/// Delaunay triangulation. Throws std::runtime_error if a map cannot be read.
Workload make(const Input& input,
              const std::function<Array<std::array<std::uint32_t, 3>>(const std::vector<Point>&)>& triangles);

/// Outlines of many small leaves drawn on a grid of pixels: many short constraints, evenly spread.
Workload leafs(std::size_t n);
/// Few lines across the whole scene, and clusters of outlines of very different sizes between them.
Workload airport(std::size_t n);

/// Shorelines of islands, lakes and islands in them: segments and outlines of many scales.
Workload coasts(std::size_t n);
/// The same with vertices and constraints in random order.
Workload shuffled(const Workload& work, test::Random& random);

/// A square of at most n integer points, and lines along whole rows and columns of it, eight for each 15 of its side:
/// each runs through all vertices of its row or column.
Workload lined_grid(std::size_t n);
/// About n points of a square of integers and as many constraints along its rows and columns, 0 to 7 steps long: what
/// cleaning has to do with overlaps, vertices inside constraints, repeated ones and such without length.
Workload dirty(std::size_t n);

Workload read_poly(const std::string& path);
/// Writes 8 bytes PSLGBIN1, int64 n, int64 m, n pairs of float64, m pairs of int32, little endian.
void write_pslg(const Workload& work, const std::string& path);
/// Throws std::runtime_error if it cannot be read or is none.
Workload read_pslg(const std::string& path);

}  // namespace gcdt::bench

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "geojson.hpp"
#include "json_line.hpp"
#include "paths.hpp"

namespace gcdt::io {

namespace {

using Json = nlohmann::json;

// Collections in collections: deeper than any file that means it.
constexpr int deepest = 64;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

class Reader {
 public:
  /// `name`: of the text in messages; `lines`: they name lines of the text, too.
  Reader(std::string path, std::string name, bool lines) : name_(std::move(name)), lines_(lines) {
    input_.files.push_back(std::move(path));
  }

  Input read(std::string_view text) {
    input_.vertex_file = input_.constraint_file = name_;
    text_ = text;
    Json root;
    try {
      root = Json::parse(text);
    } catch (const Json::exception& error) {
      throw Failure(Exit::input, fmt::format("{}: no JSON that can be read: {}", name_, error.what()));
    }
    object(root, "the file", 0);
    direct_rings();
    take_heights();
    return std::move(input_);
  }

 private:
  /// While it lives, the value that is looked at is a part of the one before.
  class Inside {
   public:
    Inside(Reader& reader, JsonStep step) : reader_(reader) { reader_.path_.push_back(std::move(step)); }
    ~Inside() { reader_.path_.pop_back(); }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;

   private:
    Reader& reader_;
  };

  [[noreturn]] void fail(const std::string& where, const std::string& what) const {
    const std::string line = lines_ ? fmt::format(":{}", json_line(text_, path_)) : "";
    throw Failure(Exit::input, fmt::format("{}{}: {}: {}", name_, line, where, what));
  }

  /// The beginning of a value as it may be shown.
  static std::string shown(const Json& value) {
    constexpr std::size_t most = 40;
    const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
    return text.size() > most ? text.substr(0, most) + "..." : text;
  }

  /// The third numbers of positions are an attribute, if all have one.
  void take_heights() {
    const auto without = std::count_if(heights_.begin(), heights_.end(), [](double h) { return !(h - h == 0); });
    const std::size_t with = heights_.size() - static_cast<std::size_t>(without);
    if (with == 0) return;
    if (without > 0) {
      input_.notes.push_back(
          fmt::format("{} of {} positions have a third number, and not all: they are not used", with, heights_.size()));
      return;
    }
    input_.attribute_count = 1;
    input_.attributes = std::move(heights_);
  }

  const Json& member(const Json& of, const char* key, const std::string& where) const {
    const auto found = of.find(key);
    if (found == of.end()) fail(where, fmt::format("\"{}\" is missing", key));
    return *found;
  }

  const Json& array(const Json& value, const std::string& where) const {
    if (!value.is_array()) fail(where, fmt::format("an array is due, not {}", shown(value)));
    return value;
  }

  template <class Each>
  void for_each(const Json& value, const std::string& where, const char* kind, Each&& each) {
    std::size_t number = 0;
    for (const Json& element : array(value, where)) {
      const Inside inside(*this, {"", number});
      each(element, fmt::format("{}, {} {}", where, kind, number++));
    }
  }

  template <class Each>
  void for_each_of(const Json& of, const char* key, const std::string& where, const char* kind, Each&& each) {
    const Json& value = member(of, key, where);
    const Inside inside(*this, {key, 0});
    for_each(value, where, kind, each);
  }

  void object(const Json& value, const std::string& where, int depth) {
    if (depth > deepest) fail(where, "collections are nested too deeply");
    if (!value.is_object()) fail(where, fmt::format("an object is due, not {}", shown(value)));
    const Json& type = member(value, "type", where);
    if (!type.is_string()) {
      const Inside inside(*this, {"type", 0});
      fail(where, fmt::format("\"type\" is no text, but {}", shown(type)));
    }
    const auto name = type.get<std::string>();
    if (name == "FeatureCollection")
      return for_each_of(value, "features", where, "feature",
                         [&](const Json& f, const std::string& at) { object(f, at, depth + 1); });
    if (name == "Feature") {
      const Json& geometry = member(value, "geometry", where);
      const Inside inside(*this, {"geometry", 0});
      if (!geometry.is_null()) object(geometry, where, depth + 1);
      return;
    }
    if (name == "GeometryCollection")
      return for_each_of(value, "geometries", where, "geometry",
                         [&](const Json& g, const std::string& at) { object(g, at, depth + 1); });
    geometry(name, value, where);
  }

  void geometry(const std::string& type, const Json& value, const std::string& where) {
    constexpr const char* types[] = {"Point", "MultiPoint", "LineString", "MultiLineString", "Polygon", "MultiPolygon"};
    if (std::count(std::begin(types), std::end(types), type) == 0)
      fail(where, fmt::format("there is no type \"{}\"", type));
    const Json& at = member(value, "coordinates", where);
    const Inside inside(*this, {"coordinates", 0});
    const auto line = [&](const Json& l, const std::string& place) { positions(l, place, false); };
    const auto polygon = [&](const Json& p, const std::string& place) {
      for_each(p, place, "ring", [&](const Json& r, const std::string& inner) { positions(r, inner, true); });
      polygon_offsets_.push_back(rings_.size());
    };
    if (type == "Point") return position(at, where);
    if (type == "MultiPoint")
      return for_each(at, where, "point", [&](const Json& p, const std::string& place) { position(p, place); });
    if (type == "LineString") return line(at, where);
    if (type == "MultiLineString") return for_each(at, where, "line", line);
    if (type == "Polygon") return polygon(at, where);
    for_each(at, where, "polygon", polygon);
  }

  void position(const Json& value, const std::string& where) {
    if (array(value, where).size() < 2 || !value[0].is_number() || !value[1].is_number())
      fail(where, fmt::format("a position of two numbers is due, not {}", shown(value)));
    const std::array<double, 2> at = {value[0].get<double>(), value[1].get<double>()};
    for (const double c : at)
      if (!(c - c == 0)) fail(where, "a coordinate is not finite");
    if (input_.vertices.size() == max_vertices) fail(where, "too many vertices");
    input_.vertices.push_back(at);
    heights_.push_back(value.size() > 2 && value[2].is_number() ? value[2].get<double>() : none);
  }

  void positions(const Json& line, const std::string& where, bool ring) {
    const auto begin = static_cast<std::uint32_t>(input_.vertices.size());
    for_each(line, where, "position", [&](const Json& p, const std::string& place) { position(p, place); });
    if (ring && input_.vertices.size() > begin + 1 && input_.vertices.back() == input_.vertices[begin]) {
      input_.vertices.pop_back();
      heights_.pop_back();
    }
    const auto end = static_cast<std::uint32_t>(input_.vertices.size());
    const std::size_t first = input_.constraints.size();
    for (std::uint32_t v = begin; v + 1 < end; ++v) input_.constraints.push_back({v, v + 1});
    if (ring && end > begin) input_.constraints.push_back({end - 1, begin});
    if (ring) rings_.push_back({begin, end, first});
  }

  /// Turns rings by the library's rule; a ring has as many constraints as vertices.
  void direct_rings() {
    std::vector<std::array<double, 2>> vertices;
    std::vector<std::uint64_t> offsets = {0};
    for (const Ring& ring : rings_) {
      vertices.insert(vertices.end(), input_.vertices.begin() + ring.begin, input_.vertices.begin() + ring.end);
      offsets.push_back(vertices.size());
    }
    const std::vector<Constraint> directed = ring_constraints(vertices, offsets, polygon_offsets_);
    for (std::size_t r = 0; r < rings_.size(); ++r) {
      const Ring& ring = rings_[r];
      for (std::uint32_t i = 0; i < ring.end - ring.begin; ++i) {
        const std::uint64_t from = offsets[r];
        const Constraint& c = directed[from + i];
        input_.constraints[ring.first_constraint + i] = {static_cast<std::uint32_t>(c[0] - from + ring.begin),
                                                         static_cast<std::uint32_t>(c[1] - from + ring.begin)};
      }
    }
  }

  struct Ring {
    std::uint32_t begin, end;  ///< vertices
    std::size_t first_constraint;
  };
  std::string name_;
  bool lines_;
  std::string_view text_;
  std::vector<JsonStep> path_;  ///< to the value that is looked at
  Input input_;
  std::vector<Ring> rings_;
  std::vector<std::uint64_t> polygon_offsets_ = {0};
  std::vector<double> heights_;  ///< one a vertex
};

}  // namespace

Input read_geojson(const std::string& path) { return Reader(path, path, true).read(read_file(path)); }

bool is_line_file(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".geojsonl" || extension == ".geojsons" || extension == ".ndjson";
}

std::vector<TextLine> lines_of(const std::string& path) {
  const std::string all = read_file(path);
  std::vector<TextLine> lines;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = std::min(all.find('\n', begin), all.size());
    ++number;
    const std::size_t first = all.find_first_not_of("\x1e \t\r", begin);
    if (first < end) lines.push_back({number, all.substr(first, end - first)});
    begin = end + 1;
  }
  return lines;
}

Input read_geojson_line(const std::string& path, const TextLine& line) {
  return Reader(path, fmt::format("{}:{}", path, line.number), false).read(line.text);
}

}  // namespace gcdt::io

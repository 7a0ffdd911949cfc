// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "geojson.hpp"
#include "geometries.hpp"
#include "json_line.hpp"
#include "paths.hpp"

namespace gcdt::io {

namespace {

using Json = nlohmann::json;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

class GeojsonReader {
 public:
  /// `name`: of the text in messages; `lines`: they name lines of the text, too.
  GeojsonReader(std::string path, std::string name, bool lines) : name_(std::move(name)), lines_(lines) {
    input_.files.push_back(std::move(path));
  }

  Input read(std::string_view text) {
    input_.vertex_file = input_.constraint_file = name_;
    text_ = text;
    check_depth();
    Json root;
    try {
      root = Json::parse(text);
    } catch (const Json::exception&) {
      const JsonFault fault = json_fault(text);
      throw Failure(Exit::input, fmt::format("{}{}: no JSON that can be read, at column {}: {}", name_,
                                             lines_ ? fmt::format(":{}", fault.line) : "", fault.column, fault.what));
    }
    if (root.is_array())
      bare_rings(root);
    else
      object(root, "the file", 0);
    geometries_.finish();
    return std::move(input_);
  }

 private:
  /// While it lives, the value that is looked at is a part of the one before.
  class Inside {
   public:
    Inside(GeojsonReader& reader, JsonStep step) : reader_(reader) { reader_.path_.push_back(std::move(step)); }
    ~Inside() { reader_.path_.pop_back(); }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;

   private:
    GeojsonReader& reader_;
  };

  /// Functions that call themselves for what is inside, such as Json::dump(), are safe after this.
  void check_depth() const {
    constexpr int deepest = 1000;
    int depth = 0;
    std::size_t line = 1;
    bool quoted = false;
    for (std::size_t i = 0; i < text_.size(); ++i) {
      const char c = text_[i];
      if (c == '\n') ++line;
      if (c == '"') quoted = !quoted;
      if (quoted) {
        i += c == '\\' ? 1 : 0;
        continue;
      }
      if (c == '[' || c == '{') ++depth;
      if (c == ']' || c == '}') --depth;
      if (depth > deepest)
        throw Failure(Exit::input, fmt::format("{}{}: nested deeper than {}", name_,
                                               lines_ ? fmt::format(":{}", line) : "", deepest));
    }
  }

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
    if (depth > deepest_collection) fail(where, "collections are nested too deeply");
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
      geometries_.end_polygon();
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
    const double height = value.size() > 2 && value[2].is_number() ? value[2].get<double>() : none;
    if (!geometries_.add(at[0], at[1], height)) fail(where, "too many vertices");
  }

  void positions(const Json& line, const std::string& where, bool ring) {
    geometries_.begin();
    for_each(line, where, "position", [&](const Json& p, const std::string& place) { position(p, place); });
    ring ? geometries_.end_ring() : geometries_.end_line();
  }

  /// Arrays without a word of GeoJSON around them: of positions a ring, of rings a polygon, of those many.
  void bare_rings(const Json& root) {
    int depth = 0;
    for (const Json* at = &root; at->is_array() && !at->empty() && depth < 5; at = &at->front()) ++depth;
    const auto polygon = [&](const Json& p, const std::string& place) {
      for_each(p, place, "ring", [&](const Json& r, const std::string& inner) { positions(r, inner, true); });
      geometries_.end_polygon();
    };
    if (depth > 4) fail("the file", "arrays are nested deeper than polygons, rings, positions and numbers");
    if (depth == 4) return for_each(root, "the file", "polygon", polygon);
    if (depth != 2) return polygon(root, "the file");
    positions(root, "the file", true);
    geometries_.end_polygon();
  }

  std::string name_;
  bool lines_;
  std::string_view text_;
  std::vector<JsonStep> path_;  ///< to the value that is looked at
  Input input_;
  Geometries geometries_{input_};
};

}  // namespace

Input read_geojson(const std::string& path) { return GeojsonReader(path, path, true).read(read_file(path)); }

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
  return GeojsonReader(path, fmt::format("{}:{}", path, line.number), false).read(line.text);
}

}  // namespace gcdt::io

// SPDX-License-Identifier: Apache-2.0
// What GDAL's vector drivers open. Without GDAL: that it is not there.
#include <fmt/format.h>

#include "geometries.hpp"
#include "inputs.hpp"
#include "paths.hpp"

#ifdef GCDT_WITH_GDAL

#include <cpl_error.h>
#include <gdal.h>
#include <ogr_api.h>

#include <memory>

namespace gcdt::io {

namespace {

using Dataset = std::unique_ptr<void, void (*)(GDALDatasetH)>;
using Feature = std::unique_ptr<void, void (*)(OGRFeatureH)>;
using Shape = std::unique_ptr<void, void (*)(OGRGeometryH)>;

/// While it lives, GDAL prints nothing.
class Quiet {
 public:
  Quiet() { CPLPushErrorHandler(CPLQuietErrorHandler); }
  ~Quiet() { CPLPopErrorHandler(); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
};

class GdalReader {
 public:
  GdalReader(const std::string& path, Input& input) : path_(path), geometries_(input) {}

  void read() {
    const Quiet quiet;
    GDALAllRegister();
    CPLErrorReset();
    const Dataset data(GDALOpenEx(path_.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr),
                       [](GDALDatasetH d) { GDALClose(d); });
    if (!data) throw Failure(Exit::input, fmt::format("{}: cannot be opened by GDAL: {}", path_, said()));
    for (int i = 0; i < GDALDatasetGetLayerCount(data.get()); ++i) layer(GDALDatasetGetLayer(data.get(), i));
    geometries_.finish();
  }

 private:
  static std::string said() {
    std::string text = CPLGetLastErrorMsg();
    for (char& c : text)
      if (c == '\n') c = ' ';
    return text.empty() ? "no driver knows it" : text;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Failure(Exit::input, fmt::format("{}: layer \"{}\", feature {}: {}", path_, layer_, feature_, what));
  }

  void layer(OGRLayerH layer) {
    layer_ = OGR_L_GetName(layer);
    OGR_L_ResetReading(layer);
    CPLErrorReset();
    for (;;) {
      const Feature feature(OGR_L_GetNextFeature(layer), OGR_F_Destroy);
      if (CPLGetLastErrorType() >= CE_Failure) fail(said());
      if (!feature) return;
      feature_ = OGR_F_GetFID(feature.get());
      // Curves become lines, as fine as GDAL makes them by default.
      if (OGRGeometryH shape = OGR_F_GetGeometryRef(feature.get())) {
        const Shape linear(OGR_G_GetLinearGeometry(shape, 0, nullptr), OGR_G_DestroyGeometry);
        if (!linear) fail(said());
        geometry(linear.get(), 0);
      }
    }
  }

  void geometry(OGRGeometryH shape, int depth) {
    if (depth > deepest_collection) fail("collections are nested too deeply");
    if (OGR_G_IsEmpty(shape)) return;
    switch (wkbFlatten(OGR_G_GetGeometryType(shape))) {
      case wkbPoint: return positions(shape);
      case wkbLineString:
        geometries_.begin();
        positions(shape);
        return geometries_.end_line();
      case wkbPolygon:
      case wkbTriangle:
        for (int i = 0; i < OGR_G_GetGeometryCount(shape); ++i) {
          geometries_.begin();
          positions(OGR_G_GetGeometryRef(shape, i));
          geometries_.end_ring();
        }
        return geometries_.end_polygon();
      default:
        if (OGR_G_GetGeometryCount(shape) == 0) fail(fmt::format("there is no type {}", OGR_G_GetGeometryName(shape)));
        for (int i = 0; i < OGR_G_GetGeometryCount(shape); ++i) geometry(OGR_G_GetGeometryRef(shape, i), depth + 1);
    }
  }

  void positions(OGRGeometryH shape) {
    const bool high = OGR_G_Is3D(shape);
    for (int i = 0; i < OGR_G_GetPointCount(shape); ++i) {
      const double x = OGR_G_GetX(shape, i), y = OGR_G_GetY(shape, i);
      if (!(x - x == 0) || !(y - y == 0)) fail("a coordinate is not finite");
      if (!(high ? geometries_.add(x, y, OGR_G_GetZ(shape, i)) : geometries_.add(x, y))) fail("too many vertices");
    }
  }

  const std::string& path_;
  std::string layer_;
  GIntBig feature_ = 0;
  Geometries geometries_;
};

}  // namespace

Input read_with_gdal(const std::string& path) {
  Input input = input_of(path);
  GdalReader(path, input).read();
  return input;
}

}  // namespace gcdt::io

#else

namespace gcdt::io {

Input read_with_gdal(const std::string& path) {
  throw Failure(Exit::usage, fmt::format("{}: {} files are read by GDAL, which this gcdt is built without (CMake: "
                                         "-DGCDT_GDAL=ON, package libgdal-dev)",
                                         path, lower_extension(path)));
}

}  // namespace gcdt::io

#endif

/// @file
/// What a camera in the middle of an environment map takes: pictures, which are no maps.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/sample/filter.h"

namespace ENVMAP_EXPORT envmap {

/// How the angle from the axis becomes a place in the picture:
/// - perspective: straight lines stay straight, the distance from the middle goes with the tangent.
/// - fisheye: equidistant, the distance from the middle goes with the angle; a circle as high as the picture, black
/// around it.
/// - cylinder: columns are turns about the vertical, heights go with the tangent.
enum class CameraModel { perspective, fisheye, cylinder };
inline constexpr std::array<std::string_view, 3> camera_model_names{"perspective", "fisheye", "cylinder"};
template <>
inline constexpr std::size_t enumerators<CameraModel> = camera_model_names.size();

struct PhotographOptions {
  CameraModel lens = CameraModel::perspective;
  /// From the bottom to the top of the picture; in (0, pi), of fisheyes up to 2 pi.
  double field_radians = pi / 3;
  int width = 640, height = 480;
  /// World direction in the middle; not 0. +Y is up, or -Z of what looks up, +Z of what looks down.
  Direction towards{0, 0, 1};
  /// nearest, bilinear or bicubic; of the perspective lens also nearest_level, trilinear, ewa and area, the solid-angle
  /// mean over each pixel to 1e-4 of it.
  Filter filter = Filter::bilinear;
  /// Along each side of a pixel, for nearest, bilinear and bicubic; absent: as samples_of() says.
  std::optional<int> samples = {};
  Rotation rotation{1};  ///< Turns the environment before the picture is taken, as ConvertOptions::rotation.
  double gain = 1;       ///< Factor on radiance.
};

/// The angle in radians that a cylinder's picture spans from left to right, for square pixels.
double angle_across(const PhotographOptions& options);

/// Along each side of a pixel: `samples`, or two for each texel of the source that the widest pixel spans, up to 32.
int samples_of(const PhotographOptions& options, const Level& source);

/// Radiance, rows from the top: plain means of samples x samples places in each pixel, or as the filter says.
/// @throws UsageError where a field is out of its range (bounds.h) or a cylinder spans more than one turn, InputError
/// where a texel is NaN or infinite.
std::vector<Colour> photograph(EnvironmentMap source, const PhotographOptions& options, const Run& run = {});

}  // namespace envmap

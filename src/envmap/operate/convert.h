/// @file
/// From any projection to any other.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/map/rows.h"
#include "envmap/projection/ball_camera.h"
#include "envmap/sample/filter.h"

namespace ENVMAP_EXPORT envmap {

struct ConvertOptions {
  Frame to{Projection::cube};
  std::optional<int> size = {};  ///< Height of a face; absent: matching_size() of the source.
  /// Absent: `area` where a texel of the result spans more than 1.25 texels of the source; otherwise `bilinear`,
  /// with 2 x 2 samples (or `samples`, if more) where it spans more than 0.5 and texels do not fall on texels.
  std::optional<Filter> filter = {};
  int samples = 1;  ///< Along each side of a texel, for nearest, bilinear and bicubic.
  /// Of the area filter, relative to the texel (or 0.001 x the mean if larger). Absent: 1e-4 if it was asked for, 1e-3
  /// if it was chosen.
  std::optional<double> area_error = {};
  /// Of the area filter. Absent: `outlines` if it was asked for, `quads` if it was chosen.
  std::optional<AreaSides> area_sides = {};
  /// Take the cheapest filter that is found to err by no more (FilterChoice); `filter` and `samples` are then ignored.
  /// Where the result has the source's own texels, they are copied, with error 0.
  std::optional<double> max_error = {};
  Rotation rotation{1};                      ///< Turns the environment: radiance from d comes out from rotation x d.
  MirroredAxis mirror = MirroredAxis::none;  ///< After `rotation`.
  double gain = 1;                           ///< Factor on radiance.
  /// The camera that took the source, a photo of a mirror ball; absent: one infinitely far away. What the camera does
  /// not see gets the colours of the ball's rim. Of sphere maps only.
  std::optional<BallCamera> ball = std::nullopt;
};

/// What a filter was measured to do: metrics `rms` and `max` against the area filter in sampled texels, as compare()
/// has them, and the time it takes for each texel of the whole map, levels apart.
struct FilterTrial {
  Filter filter;
  int samples;
  double rms, maximum, seconds_per_texel;
};

struct FilterChoice {
  FilterOptions filter;             ///< The one chosen: the area filter where none reached the error.
  std::vector<FilterTrial> trials;  ///< All that were tried, cheapest first; the last is the one chosen.
  std::int64_t texels;              ///< In which they were measured.
  bool reached;                     ///< Whether rms and max are at most the error there.
};

/// Whether the result has the source's own texels, turned or not, where no filter is asked for.
bool keeps_texels(const EnvironmentMap& source, const ConvertOptions& options);

/// A conversion, prepared once: what it will do, and its rows. It holds what the filter reads, so the source need not
/// outlive it, and never changes; copies share what they hold.
class Resampler {
 public:
  /// Copies the source's texels.
  /// @throws UsageError where a field is out of its range (bounds.h) or `ball` is set for another map than a sphere
  /// map, InputError where a texel is NaN or infinite. @param run of what is prepared: levels, and the choice of a
  /// filter.
  Resampler(const EnvironmentMap& source, const ConvertOptions& options, const Run& run = {})
      : Resampler(source.clone(), options, run) {}
  /// Moves the source's texels instead of copying them.
  Resampler(EnvironmentMap&& source, const ConvertOptions& options, const Run& run = {});

  [[nodiscard]] const Frame& frame() const;
  [[nodiscard]] int size() const;
  /// As it was asked for or chosen.
  [[nodiscard]] const FilterOptions& filter() const;
  /// How the filter was chosen, where `max_error` was given.
  [[nodiscard]] const std::optional<FilterChoice>& choice() const;

  /// The result row by row, the same at any number of threads. The rows share what the resampler holds.
  [[nodiscard]] Rows rows() const;

 private:
  struct Prepared;
  std::shared_ptr<const Prepared> prepared_;
};

/// The result whole, with one level; the same at any number of threads. Resampler makes it row by row and tells
/// what filter it chose.
EnvironmentMap convert(const EnvironmentMap& source, const ConvertOptions& options, const Run& run = {});

}  // namespace envmap

/// @file
/// Maps out of photos of mirror balls and by fisheye lenses. What a photo shows beside its circle is not read.
#pragma once

#include <cstdint>
#include <optional>

#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/projection/lens.h"

namespace envmap {

/// Smallest radius in pixels of a circle in a photo.
inline constexpr double least_radius = 4;

/// What a map is made with.
struct PhotoMapOptions {
  std::size_t max_memory = 0;  ///< As ReadOptions has it.
  std::uint64_t max_pixels = std::uint64_t{1} << 31;
  Progress progress = {};
};

/// The mirror ball as a sphere map that its outline fills, with a texel for each pixel. Where the outline lies on the
/// edges of pixels, texels are the photo's pixels. The last pixels before the outline, which are mixed with what is
/// behind the ball, take the colours next to them.
/// @param photo its level is an image of any width. @throws InputError where the ball is not in the photo as a whole.
EnvironmentMap ball_map(const Level& photo, const Circle& ball, const PhotoMapOptions& options = {});

struct FisheyeMap {
  EnvironmentMap map;
  double covered;  ///< Part of the sphere that is shown; the rest is 0.
};

/// Photos as an angular map with the lens's axis in its middle, and a texel for each pixel near the axis.
/// @param back the photo turned by 180 degrees about +Y, or null. Where both show a direction, the weight of each falls
/// to 0 towards its circle. @param back_lens that took it; absent: the same one, and the photos are of one size.
FisheyeMap fisheye_map(const Level& photo, const Fisheye& lens, const Level* back, const PhotoMapOptions& options = {},
                       const std::optional<Fisheye>& back_lens = std::nullopt);

/// One half of a paraboloid map, or both. @throws InputError where a photo is not square, or sizes differ.
EnvironmentMap paraboloid_map(const Level& front, const Level* back);

}  // namespace envmap

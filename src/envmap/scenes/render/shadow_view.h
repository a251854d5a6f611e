/// @file
/// What punctual lights see of a scene: the images that their shadows are found in.
#pragma once

#include <span>
#include <vector>

#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/scene/camera.h"

namespace envmap {

/// One image of a light: a pinhole's, or that of parallel rays.
struct ShadowView {
  int but = -1;         ///< The node that casts no shadow, with all below it; -1: none.
  Direction centre{0};  ///< World: the pinhole, or the middle of all that parallel rays pass through.
  Rotation axes{1};     ///< Columns: right, up, ahead; world.
  double half = 1;      ///< Half the width of the image: at depth 1, of parallel rays in metres.
  bool parallel = false;
};

/// The number of images that all it lights is in: 1 of directional lights and of spots up to 45 degrees from their
/// axis, else 6, in the order of a cube's faces.
int shadow_view_count(const PlacedLight& light);

/// Of all images together: 256 MiB.
inline constexpr std::size_t max_shadow_texels = std::size_t{1} << 24;

/// Texels a side of so many images: 2048, or as many as 256 MiB have room for.
int shadow_map_size(std::size_t count);

inline std::size_t shadow_map_texels(std::size_t count) {
  const auto size = std::size_t(count > 0 ? shadow_map_size(count) : 0);
  return count * size * size;
}

/// The image of parallel rays along a direction through all of a ball.
ShadowView parallel_image(const Direction& along, const Ball& scene);

/// All of these lights, in their order. @param scene what may cast shadows.
std::vector<ShadowView> shadow_views(std::span<const PlacedLight> lights, const Ball& scene);

}  // namespace envmap

/// @file
/// The reference among the ways of drawing: a ray for each sample of each texel.
#pragma once

#include "envmap/base/run.h"
#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/texture_filter.h"

namespace envmap {

/// How far rays are followed.
struct RayPaths {
  std::vector<int> mirrors;  ///< Nodes whose smooth surfaces (is_smooth()) reflect and let through what is there.
  int bounces = 32;          ///< So often a ray leaves a mirror or a lens; after that these show the environment.
  double far = 1000;         ///< Nothing further from the last surface.
  /// Samples of each integral of an environment's light over a surface's lobes (lobe_integral.h); 0: prefiltered
  /// levels, as the card has them.
  int lobe_samples = 0;
  TextureFilter texture_filter = TextureFilter::bilinear;  ///< Over what a ray's part of the pixel covers.
};

/// Each texel shows what its own ray meets first between the spheres `near` and `far`, lit by shade(), and from mirrors
/// goes on as in pictures. The same bytes at any number of threads. @param progress may be empty. @throws UsageError
/// where there is no memory for the scene's tree.
Drawn raycast(const FrameState& shot, const Viewpoint& from, const RayPaths& paths = {}, const Progress& progress = {});

/// The picture through from.lens, rows from the top: rays go on from smooth mirrors, through thin walls, and through
/// solids, which they leave by refraction and by reflection inside. All that Embree meets is lit as scatter() says;
/// what counts for less than a ten-thousandth of a pixel is taken from the environment, as what rough surfaces reflect.
/// Source: Whitted 1980, "An improved illumination model for shaded display".
std::vector<Colour> raycast_picture(const FrameState& shot, const Viewpoint& from, const RayPaths& paths,
                                    const Progress& progress = {});

}  // namespace envmap

/// @file
/// What one face of a map is drawn into.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "envmap/maths/vector.h"
#include "envmap/projection/projection.h"
#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/gl.h"

namespace envmap {

/// @throws UsageError where a face is larger than GL draws.
void check_face(int width, int height);

/// Which surface each texel sees, and how near it is: what all methods draw, and shading reads. It is made new for each
/// face; a map has one canvas.
struct VisibilityBuffer {
  VisibilityBuffer(int width, int height);

  int width, height;
  gl::Texture surfaces;  ///< Instance + 1 and triangle.
  gl::Texture depth;     ///< near / distance, and the stencil of Part.
  gl::Framebuffer seen;  ///< The two of them.
  gl::Framebuffer lit;   ///< The layer of a map that is shaded, and the stencil.
};

/// What blended surfaces need beside a canvas: the nearness and the stencil of two of their layers, and one sample of
/// all texels, on which they are put.
struct DepthPeeling {
  explicit DepthPeeling(const VisibilityBuffer& canvas);

  gl::Texture sample;
  std::array<gl::Texture, 2> depth;
  std::array<gl::Framebuffer, 2> seen;  ///< Each with the canvas' surfaces.
  std::array<gl::Framebuffer, 2> lit;   ///< Each with the sample.
};

/// Directions through the texels of a face in the frame of the map; 0 where the texel is no part of it.
/// @param offset from the centres, in texels.
gl::Texture make_rays(Projection p, int size, int face, const Vec2<double>& offset);

/// The same of a picture, as ray.glsl reads it.
gl::Texture make_rays(const Lens& lens, int height, const Vec2<double>& offset);

}  // namespace envmap

/// @file
/// Looking up textures on surfaces.
#pragma once

#include <vector>

#include "envmap/scenes/render/texture_filter.h"
#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// A place in texture coordinates, and how it moves from one pixel to the next across and down.
struct TextureFootprint {
  glm::vec2 at{0};
  Vec2<double> across{0}, down{0};
};

/// Bilinear between the four texels round a place, colours made linear first (glTF 2.0, 3.8.4). Level 0 always.
glm::vec4 texture_at(const Texture& texture, const glm::vec2& coordinates);

/// The textures of a scene with their mip levels, where the filter reads any. Texels of a level are the means, in
/// linear light, of the two by two texels that they cover, or of parts of three of a side that is odd.
class TextureSampler {
 public:
  /// @param scene must outlive this.
  TextureSampler(const SceneGraph& scene, TextureFilter filter);

  [[nodiscard]] glm::vec4 operator()(int texture, const TextureFootprint& footprint) const;

 private:
  struct Level {
    int width, height;
    std::vector<glm::vec4> texels;
  };
  [[nodiscard]] glm::vec4 bilinear(int texture, int level, const Vec2<double>& at) const;
  [[nodiscard]] glm::vec4 trilinear(int texture, double lod, const Vec2<double>& at) const;

  const SceneGraph& scene_;
  TextureFilter filter_;
  std::vector<std::vector<Level>> levels_;  // Of each texture from the second on.
};

}  // namespace envmap

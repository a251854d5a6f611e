/// @file
/// Pictures of a scene whose mirrors and lenses are drawn through dynamic maps, which stay from frame to frame.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "envmap/offscreen/eyes.h"
#include "envmap/offscreen/lit_scene.h"
#include "envmap/render/context.h"
#include "envmap/render/mirrors.h"

namespace envmap {

/// A picture for each eye, after the maps are drawn as far as the eyes need them. @param tell a line for each map.
std::vector<std::vector<Colour>> draw_through_maps(Renderer& renderer, Mirrors& maps, Shot shot,
                                                   const std::vector<Eye>& eyes, const MirrorOptions& drawing,
                                                   const std::function<void(const std::string&)>& tell);

/// Makes the OpenGL context that it draws with: it lives in one thread.
class MirrorPainter {
 public:
  MirrorPainter(ContextKind kind, const LitScene& lit, const std::vector<Mirror>& mirrors)
      : context_(kind), renderer_(lit.scene, lit.environment.get(), nodes_of(mirrors)), maps_(lit.scene, mirrors) {}

  [[nodiscard]] const Context& context() const { return context_; }
  [[nodiscard]] Renderer& renderer() { return renderer_; }

  /// draw_through_maps(). @param moved meshes whose vertices are others than in the last shot.
  [[nodiscard]] std::vector<std::vector<Colour>> paint(Shot shot, const std::vector<int>& moved,
                                                       const std::vector<Eye>& eyes, MirrorOptions drawing,
                                                       const std::function<void(const std::string&)>& tell);

  /// Each mirror's map, turned to the axes of the world; of a mirror that was not seen a map without levels.
  [[nodiscard]] std::vector<EnvironmentMap> maps() const;

 private:
  Context context_;
  Renderer renderer_;
  Mirrors maps_;
};

}  // namespace envmap

/// @file
/// Pictures of a scene whose mirrors and lenses are drawn through dynamic maps, which stay from frame to frame.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "envmap/scenes/lit_scene.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/stereo.h"

namespace envmap {

struct RenderedFrames {
  std::vector<std::vector<Colour>> pictures;  ///< One for each eye.
  MirrorUpdates updates;
};

/// A mirror's map in the axes of the world; of a mirror that was not seen a map without levels.
struct PaintedMap {
  EnvironmentMap radiance;
  /// One a texel, in metres from `at`, in the order of faces, rows and columns. Infinite where nothing was hit, and in
  /// faces that were not needed.
  std::vector<float> distances = {};
  Direction at{0};  ///< Where it was drawn from.
};

/// Pictures, after the maps are drawn as far as the eyes need them.
RenderedFrames draw_through_maps(Renderer& renderer, Mirrors& maps, FrameState shot, const std::vector<Eye>& eyes,
                                 const MirrorOptions& drawing);

/// Needs a current context, and goes before it.
class MirrorPainter {
 public:
  /// @param programs that others of the same context share; null: its own.
  MirrorPainter(const LitScene& lit, const std::vector<Mirror>& mirrors,
                std::shared_ptr<ProgramCache> programs = nullptr)
      : renderer_(lit.scene, lit.environment.get(), nodes_of(mirrors), std::move(programs)),
        maps_(lit.scene, mirrors) {}

  [[nodiscard]] Renderer& renderer() { return renderer_; }

  /// draw_through_maps(). @param moved meshes whose vertices are others than in the last shot.
  [[nodiscard]] RenderedFrames paint(FrameState shot, const std::vector<int>& moved, const std::vector<Eye>& eyes,
                                     MirrorOptions drawing);

  /// Of each mirror.
  [[nodiscard]] std::vector<PaintedMap> maps() const;

 private:
  Renderer renderer_;
  Mirrors maps_;
};

}  // namespace envmap

/// @file
/// A scene in memory with the environment that lights it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/light/distant_lights.h"
#include "envmap/scenes/render/shading/prepared_environment.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

struct LitScene {
  SceneGraph scene;
  std::shared_ptr<const Environment> environment = {};  ///< Null: black.
  std::vector<DistantLight> distant = {};               ///< Of it.

  /// @param lights that stand for the environment where shadows are found; 0: it shines through everything.
  void light_by(const PreparedEnvironment& by, int lights, Reflection reflection, const Progress& progress);

  /// Puts skins and morph targets where they are then. @return meshes that changed. @throws InputError where nodes are
  /// beyond is_bounded() then.
  std::vector<int> move_to(double time);

  [[nodiscard]] FrameState shot(double time, const std::optional<Colour>& ambient, bool shadows) const;

  /// Whether nothing lights it.
  [[nodiscard]] bool is_dark(const std::optional<Colour>& ambient) const;

  /// remarks_on(), and whether it is black.
  [[nodiscard]] std::vector<std::string> remarks(const std::optional<Colour>& ambient) const;
};

/// What of the file is missing or not drawn, in sentences.
std::vector<std::string> remarks_on(const SceneGraph& scene);

}  // namespace envmap

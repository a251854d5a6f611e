/// @file
/// A scene that is read once, and drawn from many places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/maths/vector.h"
#include "envmap/scenes/light.h"
#include "envmap/scenes/render_map.h"
#include "envmap/scenes/view.h"

namespace ENVMAP_EXPORT envmap {

struct SceneReadOptions {
  std::uint64_t max_pixels = std::uint64_t{1} << 31;  ///< Of all textures together.
  bool allow_missing = false;  ///< Surfaces have no texture where its file is not there; remarks() say so.
  std::string folder = {};     ///< Of a scene in memory: where the files lie that it names. Empty: it may name none.
};

/// The corners of a box, in the axes of the scene.
struct SceneBox {
  Direction low{0}, high{0};
};

/// A scene in memory: glTF 2.0 or OBJ. OpenGL, where a method draws with it, has a thread of its own; its context,
/// programs and textures live as long as the scene. Several threads may draw at once: they take turns.
class Scene {
 public:
  /// @param path of a .gltf, .glb or .obj file; `-`: standard input. @throws InputError where it cannot be read.
  static Scene read(const std::string& path, const SceneReadOptions& options = {});
  /// The bytes of such a file, of which it keeps none.
  static Scene read(std::span<const std::byte> file, const SceneReadOptions& options = {});

  ~Scene();
  Scene(Scene&&) noexcept;  ///< One that was moved from can only be assigned to.
  Scene& operator=(Scene&&) noexcept;

  /// Names of nodes, in the order of the file; some may be empty or alike.
  [[nodiscard]] std::vector<std::string> nodes() const;
  /// What of the file is missing or not drawn, in sentences.
  [[nodiscard]] std::vector<std::string> remarks() const;
  /// Of all triangles, at a time of the scene's movements.
  [[nodiscard]] SceneBox box(double time_seconds = 0) const;

  /// Draws the map round RenderOptions::at. @param light null: what lies behind the scene is black.
  /// @throws UsageError where an option is out of its range or names what the scene has not, RendererError where there
  /// is nothing to draw with.
  [[nodiscard]] RenderedMap map(const RenderOptions& options = {}, const Light* light = nullptr,
                                const Run& run = {}) const;

  /// Draws a map round each of the places: the bytes that map() gives there, for little more than the cost of one where
  /// most of that is the light's or OpenGL's start. @param options `at` has no meaning.
  [[nodiscard]] std::vector<RenderedMap> maps(std::span<const ScenePlace> at, const RenderOptions& options = {},
                                              const Light* light = nullptr, const Run& run = {}) const;

  /// Draws a picture. @see map()
  [[nodiscard]] ViewedScene view(const ViewOptions& options = {}, const Light* light = nullptr,
                                 const Run& run = {}) const;

 private:
  friend class SceneAccess;
  struct State;
  explicit Scene(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace envmap

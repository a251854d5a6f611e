/// @file
/// Several mirrors and lenses in one scene: each has a map of its own, drawn from its centre with the others' latest
/// maps, and only as far as somebody can see it (visible_directions.h).
///
/// Sources: Blinn and Newell 1976 (environment maps); Heidrich and Seidel 1998, "View-independent environment maps"
/// (two paraboloids); Diefenbach 1996 and Nielsen and Christensen 2002 for reflections in reflections, a frame old.
#pragma once

#include <string>
#include <vector>

#include "envmap/scenes/render/renderer.h"
#include "envmap/scenes/render/visible_directions.h"

namespace envmap {

/// A node that is drawn through a map, with all that lies below it.
struct Mirror {
  int node = 0;
  Projection to = Projection::paraboloid;
  MirrorOptics optics;
  bool rough = false;  ///< Then its map is a whole cube, of which the GGX-prefiltered levels are made.
};

/// Nodes with a metallic surface without roughness, or a transmissive one of roughness below 0.2, taken as smooth.
/// @param to sphere, paraboloid or cube.
std::vector<Mirror> find_mirrors(const SceneGraph& scene, Projection to);

std::vector<int> nodes_of(const std::vector<Mirror>& mirrors);

/// @param node may have any material. @return as find_mirrors() would have it.
Mirror make_mirror(const SceneGraph& scene, int node, Projection to);

struct MirrorOptions {
  int size = 0;  ///< Height of a face; 0: what the pixels of the picture need, up to `largest`.
  int largest = 1024;
  /// Update rounds per frame (reflections between mirrors). Unset: repeats until no texel changes by more than 1/255 of
  /// white, or of itself if it is brighter, at most max_rounds times.
  std::optional<int> bounces;
  bool all = false;    ///< Draw every face of every map in every frame.
  bool moved = false;  ///< Vertices of meshes did: what shows them is drawn again.
  double near = 0.01, far = 1000;
};

inline constexpr int max_rounds = 32;

/// What became of a mirror's map in a round of an update.
struct MapUpdate {
  enum class Outcome {
    drawn,
    unchanged,  ///< What it shows did not change since it was drawn.
    unseen      ///< No pixel looks it up.
  };
  int mirror;  ///< Its number.
  Outcome outcome;
  int size = 0;   ///< Height of a face.
  int faces = 0;  ///< That were drawn.
  double seconds = 0;
};

struct MirrorUpdates {
  std::vector<MapUpdate> maps;  ///< In the order in which they were drawn; one that stayed is in the first round alone.
  bool settled = true;          ///< False: mirrors go on changing each other after max_rounds.
};

/// The maps as they are from frame to frame. A map begins as the environment.
class Mirrors {
 public:
  Mirrors(const SceneGraph& scene, std::vector<Mirror> mirrors);

  /// Draws what the viewers need.
  /// @param viewers at least one.
  MirrorUpdates update(Renderer& renderer, const FrameState& shot, const std::vector<Viewer>& viewers,
                       const MirrorOptions& options);

  [[nodiscard]] const std::vector<MirrorMap>& maps() const { return maps_; }

 private:
  // What a map was drawn of: where nothing of it changes, the map stays.
  struct Drawn {
    Pose pose;
    Direction at{0};
    MirrorLookup lookup = MirrorLookup::direction;
    unsigned faces = 0;
    std::vector<int> versions;  // Of all maps.
    int version = 0;            // Counts changes that can be seen.
    std::optional<EnvironmentMap> seen;
  };
  struct Wanted {
    Direction at{0};  // Where it is drawn from.
    std::vector<DirectionCone> caps;
    double spacing = pi;              // Radians between texels.
    double pixels = 0;                // That look it up.
    std::optional<Direction> normal;  // Of a flat mirror.
    std::optional<Direction> front;   // The same where it shows one side: nothing behind that is looked up.
  };
  struct Plan {
    int size = 0;
    Rotation axes{1};
    bool anew = false;  // All of it must be drawn.
  };

  // The normal of a mirror that is flat.
  [[nodiscard]] std::optional<Direction> normal_of(const Mirror& mirror, const FrameState& shot) const;
  // For pictures of flat mirrors.
  void set_flat(std::size_t k, const FrameState& shot, const Wanted& want);
  void add_wanted(std::size_t k, const FrameState& shot, const Viewer& viewer, Wanted& want) const;
  [[nodiscard]] std::vector<Wanted> wanted(const FrameState& shot, const std::vector<Viewer>& viewers) const;
  [[nodiscard]] Plan plan(std::size_t k, const FrameState& shot, const Wanted& want, const Viewer& viewer,
                          const MirrorOptions& options) const;
  [[nodiscard]] unsigned needed_faces(std::size_t k, const Wanted& want, const Plan& plan) const;
  void draw(std::size_t k, Renderer& renderer, const FrameState& shot, const Direction& at, const Plan& plan,
            unsigned needed, const MirrorOptions& options);

  const SceneGraph& scene_;
  std::vector<Mirror> mirrors_;
  std::vector<MirrorMap> maps_;
  std::vector<Drawn> drawn_;
};

}  // namespace envmap

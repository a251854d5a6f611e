/// @file
/// What it takes to draw the map of a scene round a point, and what comes of it. One file for each way of drawing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/operate/lookup.h"
#include "envmap/scenes/render/drawing_method.h"
#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// A picture in place of a map: what a pinhole or an orthographic camera sees. X of the map's frame is right, Y up,
/// -Z ahead.
struct Lens {
  int width = 0;             ///< Pixels; the height is Viewpoint::size.
  Vec2<double> tangents{1};  ///< Of half the angles of view, across and up; of parallel rays half the sides in metres.
  double shift = 0;          ///< Of what is seen, to the right, in half widths: for pairs of eyes.
  bool parallel = false;     ///< Rays run along -Z from the plane through the viewpoint; near and far are planes, too.

  /// Through a point of the picture, u right and v down as in a map. @return unit.
  [[nodiscard]] Direction ray(double u, double v) const {
    if (parallel) return {0, 0, -1};
    return glm::normalize(Direction(tangents.x * (2 * u - 1 - shift), tangents.y * (1 - 2 * v), -1));
  }
  /// Where that ray starts, from the viewpoint.
  [[nodiscard]] Direction origin(double u, double v) const {
    return parallel ? Direction(tangents.x * (2 * u - 1), tangents.y * (1 - 2 * v), 0) : Direction(0);
  }
};

/// (x, y, z, 1) lies before it where the product is above 0.
using Plane = glm::vec<4, double, glm::highp>;

/// One map to draw.
struct Viewpoint {
  Projection to = Projection::cube;
  int size = 256;                  ///< Height of a face.
  Direction at{0};                 ///< World.
  Rotation axes{1};                ///< From the map's frame to the world's.
  double near = 0.01, far = 1000;  ///< Spheres round `at`: nothing nearer or further is drawn.
  int without = -1;                ///< The node that is left out with all below it; -1: none.
  int samples = 1;                 ///< A texel. Distances and surfaces are those of the first.
  unsigned which = ~0U;            ///< Faces to draw, a bit each.
  bool cull = true;                ///< Leave out what lies beyond a face, by spheres round meshes.
  /// distort and tessellate move vertices near a disc's singularity (z < -1 + epsilon) to infinity. 0: 0.5 for
  /// paraboloids, otherwise 0.05 for distort and 0.01 for tessellate.
  double epsilon = 0;
  bool show_ambient = false;  ///< Behind all surfaces, too: as mirrors show it.
  /// By OpenGL, up to 8 x 8 samples of an environment of smaller texels, so that small suns keep their light.
  bool mean_background = false;
  std::optional<Lens> lens;  ///< Then it is a picture of one face, and `to` is not looked at.
  Plane before{0, 0, 0, 1};  ///< Of pictures that OpenGL draws: nothing behind it is drawn. World.
};

struct DistantLight;
struct Environment;
struct MirrorMap;
struct MapTexture;

struct MirrorLook {
  MirrorLookup lookup = MirrorLookup::distance;
  bool tinted = false;  ///< Each face of a map in a colour of its own.
  int pictures = 16;    ///< So often at most flat mirrors show each other by pictures: draw_picture().
  /// What flat mirrors reflect is as far away as its image, which lies behind them: as maps that are looked up want it.
  bool images = false;
};

/// The scene at one moment.
struct FrameState {
  const SceneGraph& scene;
  Pose pose;
  const Environment* environment = nullptr;  ///< Background and light (shading.h); null: black.
  Colour ambient{0};                         ///< Radiance from everywhere, beside the environment; no background.
  bool shadows = true;                       ///< Of punctual lights.
  /// The environment's (distant_lights.h), for what surfaces keep of it from each other: at most max_distant_lights;
  /// none: it shines through everything.
  std::span<const DistantLight> distant{};
  std::span<const MirrorMap> mirrors{};  ///< In the order of the renderer's; empty: they show the environment.
  /// What flat mirrors show of a picture, as the eye mirrored in each sees it, right and left exchanged; in the order
  /// of `mirrors`, null for all others. Empty: none has one.
  std::span<const MapTexture* const> reflections{};
  MirrorLook look{};
};

/// A mesh in its place. All of a scene's, in the order of nodes: what a surface is numbered by.
struct Instance {
  int node, mesh;
};
std::vector<Instance> instances(const SceneGraph& scene);

/// Of all instances.
std::size_t triangles(const SceneGraph& scene);

/// Glass and coats of less roughness are taken for smooth.
inline constexpr float smooth_glass = 0.2F;

/// Whether normals of this material come from an image.
inline bool is_bumpy(const Material& m) { return m.normal_texture >= 0 || m.coat_normal_texture >= 0; }

/// Whether a mirror or a lens of this material shows things sharply: metal without roughness, glass of less than 0.2.
bool is_smooth(const Material& material);

/// Whether what is of this material keeps punctual light from what lies behind, on either side: what lets light through
/// does not.
bool casts_shadow(const Material& material);

/// Where the map of a node is drawn from: the centre of the box that holds its meshes and those below it; where it has
/// none, its origin. World.
Direction centre_of(const SceneGraph& scene, const Pose& pose, int node);

/// centre_of() each node, in the time of one.
std::vector<Direction> centres_of_nodes(const SceneGraph& scene, const Pose& pose);

/// From a place of the world to the centre of a node, or to the scene's first camera where the name is "camera";
/// nothing where there is none of that name. Not of unit length.
std::optional<Direction> direction_to(const SceneGraph& scene, const Pose& pose, const Direction& from,
                                      const std::string& name);

/// Viewpoint::axes that look there: Z along it, X level. @param along any length but 0. @throws UsageError
Rotation turned_to(const Direction& along);

/// A drawn map with what is needed to judge it, texel by texel in the order of faces, rows and columns.
struct Drawn {
  EnvironmentMap radiance;
  std::vector<float> distances;         ///< From the point, in metres; infinite where nothing was hit.
  std::vector<std::uint32_t> surfaces;  ///< 1 + index into instances(); 0 where nothing was hit.
  /// Solid angle in steradians of the triangles that distort or tessellate left out round the singularity, whether or
  /// not others hide them: what the map lacks at most. 0 for other methods.
  double missing_solid_angle = 0;
};

/// Where the samples of a texel lie, from its centre: a rank-1 lattice; one sample is the centre.
Vec2<double> sample_offset(int sample, int samples);

/// Unit vectors, in the map's frame, from one sample of each of a row's texels, of columns(): see texel_directions(). A
/// sample beyond the rim of a disc sees the rim.
void sample_directions(Projection p, int size, int face, int row, const Vec2<double>& offset, std::span<Direction> out);

}  // namespace envmap

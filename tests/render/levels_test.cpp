// Levels of detail of mirrors' maps, made on the card: against those of the library, and in pictures against many rays.
#include "envmap/operate/levels.h"

#include <gtest/gtest.h>

#include "drawing.h"
#include "envmap/map/image_view.h"
#include "envmap/operate/generate.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/shading/shading.h"
#include "rooms.h"

namespace levels_test {
namespace {

using namespace envmap;

class Levels : public ::testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Maps, Levels, ::testing::Values(Projection::sphere, Projection::paraboloid, Projection::cube),
                         [](const auto& p) { return identifier(p.param); });

Level read_level(const MapTexture& map, int level) {
  Level out(map.projection, map.size >> level);
  std::vector<glm::vec4> texels(ImageView<glm::vec4>::count(out.width(), out.height()));
  const ImageView<const glm::vec4> image(texels, out.width(), out.height());
  for (int face = 0; face < out.faces(); ++face) {
    glGetTextureSubImage(map.texture, level, 0, 0, map.layer(face), out.width(), out.height(), 1, GL_RGBA, GL_FLOAT,
                         static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
    for (int row = 0; row < out.height(); ++row)
      std::ranges::transform(image.row(0, row), out.row(face, row).begin(),
                             [](const glm::vec4& t) { return Colour(t); });
  }
  return out;
}

// What an empty scene shows of its environment.
MapTexture map_of(const Environment& environment, Projection to, int size, int levels) {
  drawing::context();
  const SceneGraph nothing;
  Renderer renderer(nothing, &environment);
  MapTexture map(to, size, levels);
  const FrameState shot{.scene = nothing, .pose = pose(nothing, 0), .environment = &environment};
  renderer.draw_background({.to = to, .size = size}, shot, map);
  renderer.make_levels(map, ~0U);
  return map;
}

// f(level, face, column, row) of the texels that a map has.
void for_each_texel(const Level& level, auto&& f) {
  for (int face = 0; face < level.faces(); ++face)
    for (int row = 0; row < level.height(); ++row) {
      const Columns in = columns(level.projection(), level.height(), row);
      for (int i = in.first; i < in.end; ++i) f(face, i, row);
    }
}

TEST_P(Levels, AreTheMeansThatTheLibraryMakes) {
  const Environment faces(generate(Faces{}, Projection::cube, 64), 1);
  const MapTexture map = map_of(faces, GetParam(), 64, 5);
  EnvironmentMap known = read_back(map);
  add_levels(known.levels, Weights::solid_angle, 5);
  ASSERT_GE(known.levels.size(), 5U);
  for (int level = 1; level < 5; ++level) {
    const Level made = read_level(map, level);
    for_each_texel(made, [&](int face, int i, int row) {
      // Of texels that the rim cuts the part inside is a guess. Beyond that of paraboloids the library looks at the
      // other half.
      const double r = std::hypot(2 * (i + 0.5) / made.width() - 1, 2 * (row + 0.5) / made.width() - 1);
      const bool cut = GetParam() == Projection::sphere && r > 1 - 1.5 / made.width();
      if (GetParam() == Projection::paraboloid && r > 1) return;
      const float off = glm::length(*made.texel(face, i, row) - *known.levels[std::size_t(level)].texel(face, i, row));
      EXPECT_LT(off, cut ? 0.35 : 5e-3) << level << ": " << face << " " << i << " " << row;
    });
  }
}

TEST_P(Levels, OfOddSizesKeepWhite) {
  const Environment white(generate(Constant{Direction(1)}, Projection::cube, 16), 1);
  const MapTexture map = map_of(white, GetParam(), 37, 4);
  for (int level = 1; level < 4; ++level) {
    const Level made = read_level(map, level);
    for_each_texel(made, [&](int face, int i, int row) { EXPECT_NEAR(made.texel(face, i, row)->x, 1, 1e-5) << level; });
  }
}

// A ball before squares far finer than its pixels: one lookup a pixel is nearer to the mean of many rays than one ray
// is.
TEST_P(Levels, OneSampleShowsTheMean) {
  drawing::context();
  static const Environment squares(generate(Checker{60, Direction(1), Direction(0)}, Projection::latlong, 512), 1);
  SceneGraph scene;
  scene.materials.push_back({.metallic = 1, .roughness = 0});
  scene.meshes.push_back(rooms::ball(64, 0.6));
  scene.nodes.push_back({.name = "ball", .meshes = {0}});
  constexpr int size = 64;
  const auto camera = [](int samples) {
    return Viewpoint{.size = size, .at = {0, 0.3, 3}, .samples = samples, .lens = Lens{size, {0.25, 0.25}, 0}};
  };
  FrameState shot{.scene = scene, .pose = pose(scene, 0), .environment = &squares};
  const auto rays = [&](int samples) { return raycast_picture(shot, camera(samples), {.mirrors = {0}}); };
  const std::vector<Colour> truth = rays(100), one = rays(1);
  Renderer renderer(scene, &squares, {0});
  Mirrors mirrors(scene, find_mirrors(scene, GetParam()));
  mirrors.update(renderer, shot, {{.at = camera(1).at, .pixel = 0.5 / size}}, {.size = 512});
  shot.mirrors = mirrors.maps();
  const std::vector<Colour> picture = draw_picture(renderer, camera(1), shot);
  double of_maps = 0, of_rays = 0;
  const Viewpoint from = camera(1);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const Direction ray = from.lens->ray((i + 0.5) / size, (j + 0.5) / size);
      const double b = glm::dot(ray, from.at);
      if (b * b - glm::dot(from.at, from.at) + 0.34 < 0) continue;  // Beside the ball, or on its outline.
      const auto k = std::size_t(j * size + i);
      of_maps += std::pow(picture[k].x - truth[k].x, 2);
      of_rays += std::pow(one[k].x - truth[k].x, 2);
    }
  EXPECT_LT(std::sqrt(of_maps), 0.4 * std::sqrt(of_rays));
}

}  // namespace
}  // namespace levels_test

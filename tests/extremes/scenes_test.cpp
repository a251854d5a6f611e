// Scenes of any size and anywhere, and suns that light them. Each bound is derived beside it.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <string>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "envmap/scenes/render_map.h"
#include "envmap/scenes/view.h"
#include "render/drawing.h"
#include "render/rooms.h"

namespace scenes_test {
namespace {

using namespace envmap;

Drawn drawn(const FrameState& shot, const Viewpoint& from, bool by_rays) {
  if (by_rays) return raycast(shot, from);
  drawing::context();
  Renderer renderer(shot.scene, shot.environment);
  return draw(renderer, from, shot, DrawMethod::exact);
}

// The room of rooms.h scaled and moved, drawn from a point that lies in it as `at` lies in the room.
Drawn drawn(double scale, const Direction& offset, const Direction& at, Projection to, bool by_rays) {
  SceneGraph scene = rooms::room(3);
  for (Node& node : scene.nodes) node.local = glm::scale(glm::translate(Matrix(1), offset), Direction(scale));
  const Viewpoint from{.to = to, .size = 48, .at = offset + scale * at, .near = 0.01 * scale, .far = 100 * scale};
  Drawn map = drawn({.scene = scene, .pose = pose(scene, 0)}, from, by_rays);
  for (float& distance : map.distances) distance = float(distance / scale);
  return map;
}

// What is seen depends on no unit of length: every texel shows the wall that its ray meets, as of a room of size 1.
// Vertices reach the card as float32 from the eye, right to 2^-24 of the room: they move by less than 1e-5 of a texel,
// so that of the texels only those may differ whose rays meet an edge. The colour changes by 1/2 over the size of the
// room and is made of 8-bit weights of a texture: 0.005.
TEST(SceneSizes, FromAMicrometreToTheDistanceOfTheSun) {
  const Direction at(0.3137, -0.1719, 0.4327);
  for (const double scale : {1e-6, 1e-3, 1.0, 1e4, 1.5e11})
    for (const Projection to : {Projection::cube, Projection::paraboloid, Projection::latlong})
      for (const bool by_rays : {false, true}) {
        SCOPED_TRACE(::testing::Message() << scale << " m, " << name(to) << (by_rays ? ", rays" : ", OpenGL"));
        const rooms::Faults faults = rooms::judge(drawn(scale, {}, at, to, by_rays), {.to = to, .size = 48, .at = at});
        EXPECT_EQ(faults.holes, 0);
        EXPECT_LE(faults.surface, 2e-3);
        EXPECT_LE(faults.distance, 2e-3);
        EXPECT_LE(faults.colour, 0.01);
      }
}

// A room a million of its sizes from the origin: places are float64 until they count from the eye,
// 1e-10 of the room there.
TEST(SceneSizes, FarFromTheOrigin) {
  const Direction at(0.3137, -0.1719, 0.4327);
  for (const bool by_rays : {false, true}) {
    SCOPED_TRACE(by_rays);
    const Drawn map = drawn(1, {1e6, -2e6, 3e6}, at, Projection::cube, by_rays);
    const rooms::Faults faults = rooms::judge(map, {.to = Projection::cube, .size = 48, .at = at});
    EXPECT_EQ(faults.holes, 0);
    EXPECT_LE(faults.surface, 2e-3);
    EXPECT_LE(faults.colour, 0.01);
  }
}

// A sun in one texel of the environment. A smooth metal of albedo 1 shows mixtures of texels, so no more than the sun;
// of everything else what is seen is finite and not negative. By rays: tests/render holds OpenGL against them.
TEST(SceneSuns, OfTheLargestFloat) {
  constexpr float sun = 3e38F;
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, 8);
  for (int j = 0; j < 8; ++j)
    for (Colour& c : map.base().row(0, j)) c = Colour(1);
  *map.base().texel(0, 10, 2) = Colour(sun);
  const Environment sky(std::move(map));
  for (const auto& [metallic, roughness] : {std::pair{1.F, 0.F}, {1.F, 0.3F}, {0.F, 1.F}}) {
    SCOPED_TRACE(::testing::Message() << "metallic " << metallic << ", roughness " << roughness);
    SceneGraph scene;
    scene.materials = {{.metallic = metallic, .roughness = roughness}};
    scene.meshes = {rooms::ball(16)};
    scene.nodes = {{.name = "ball", .meshes = {0}}};
    const Viewpoint from{.to = Projection::cube, .size = 12, .at = {0.4, 0.7, 2.2}};
    const Drawn seen = raycast({.scene = scene, .pose = pose(scene, 0), .environment = &sky}, from);
    for (std::size_t k = 0; k < seen.surfaces.size(); ++k) {
      const Colour c = rooms::colour_at(seen, k);
      for (int n = 0; n < 3; ++n) {
        ASSERT_TRUE(std::isfinite(c[n]) && c[n] >= 0) << k << ": " << c[n];
        const bool mirror = metallic == 1 && roughness == 0;
        ASSERT_LE(c[n], mirror ? sun * 1.0001F : std::numeric_limits<float>::max()) << k;
      }
    }
  }
}

// Before the scene is read, which is not there. @param call with a value that is none of the type.
template <class Enum, class Call>
void refuse_others(const std::string& field, const Call& call) {
  for (const int number : {99, -1, int(enumerators<Enum>)}) try {
      call(static_cast<Enum>(number));
      ADD_FAILURE() << field << " " << number;
    } catch (const UsageError& e) {
      EXPECT_NE(std::string(e.what()).find(field + " must be an enumerator"), std::string::npos) << e.what();
    }
}

TEST(SceneCalls, RefuseNumbersThatAreNoEnumerators) {
  const auto draws = [](const RenderOptions& o) { (void)render("none.obj", o); };
  const auto sees = [](const ViewOptions& o) { (void)view("none.obj", o); };
  refuse_others<DrawMethod>("method", [&](DrawMethod m) { draws({.method = m}); });
  refuse_others<ContextKind>("context", [&](ContextKind c) { draws({.context = c}); });
  refuse_others<Projection>("projection", [&](Projection p) { draws({.to = p}); });
  refuse_others<ViewMethod>("method", [&](ViewMethod m) { sees({.method = m}); });
  refuse_others<Reflection>("reflection", [&](Reflection r) { sees({.reflection = r}); });
  refuse_others<MirrorLookup>("lookup", [&](MirrorLookup l) { sees({.lookup = l}); });
  refuse_others<ContextKind>("context", [&](ContextKind c) { sees({.context = c}); });
  refuse_others<DrawMethod>("method", [](DrawMethod m) { (void)can_draw(m, Projection::cube); });
  EXPECT_THROW(sees({.maps = static_cast<Projection>(99)}), UsageError);
  EXPECT_THROW(draws({.towards = Direction(0)}), UsageError);
}

TEST(SceneCalls, NameTheFileAtFault) {
  for (const char* scene : {"none.obj", "none.glb"}) try {
      (void)render(scene);
      ADD_FAILURE() << scene;
    } catch (const InputError& e) {
      EXPECT_EQ(e.file(), scene);
      EXPECT_EQ(std::string(e.what()).find(scene), 0U) << e.what();
    }
}

}  // namespace
}  // namespace scenes_test

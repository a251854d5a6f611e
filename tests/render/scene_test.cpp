// A scene that is read once: what it draws is what render() and view() draw, at a fraction of their cost.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <stop_token>
#include <thread>

#include "envmap/prefilter/work_counters.h"
#include "envmap/scenes.h"
#include "on_processor.h"
#include "render/gltf_file.h"

namespace scene_test {
namespace {

using namespace envmap;
using namespace scenes;

const std::vector<ScenePlace> places = {Direction(0.1, 0.2, 0), Direction(-0.3, 0, 0.2), Direction(0, 0.1, -0.1)};

bool same(const EnvironmentMap& a, const EnvironmentMap& b) {
  for (int face = 0; face < a.base().faces(); ++face)
    for (int j = 0; j < a.base().height(); ++j)
      if (!std::ranges::equal(a.base().row(face, j), b.base().row(face, j))) return false;
  return a.forward == b.forward;
}

std::vector<std::byte> bytes_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

// A tetrahedron round the origin, open at one side, rough and smooth.
class ScenesKept : public SceneTest {
 protected:
  ScenesKept() {
    std::ofstream(path("room.mtl")) << "newmtl rough\nKd .8 .4 .2\nPr .6\nnewmtl metal\nKd .9 .9 .9\nPr .3\nPm 1\n";
    std::ofstream(path("room.obj")) << "mtllib room.mtl\nv 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nusemtl rough\n"
                                       "f 1 2 3\nf 1 4 2\nusemtl metal\nf 1 3 4\n";
  }

  static EnvironmentMap sky(int size = 32) {
    return generate(Sun{.towards = {0.2, 0.9, -0.4}, .radius_degrees = 8}, Projection::latlong, size);
  }

  // A triangle that two seconds carry from -X to +X.
  void write_moving() const {
    GltfFile file = triangle();
    const int times = file.add<float>({0, 2}, "SCALAR", 1), steps = file.add<float>({-1, 0, -2, 1, 0, -2}, "VEC3", 3);
    file.document["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
         {"samplers", {{{"input", times}, {"output", steps}}}}}};
    file.write(folder / "moving.glb");
  }
};

RenderOptions cast() { return {.size = 16, .method = DrawMethod::raycast}; }

// By OpenGL on the processor.
RenderOptions drawn() {
  const bool osmesa = on_processor() == std::string_view("osmesa");
  return {.size = 16, .method = DrawMethod::exact, .context = osmesa ? ContextKind::osmesa : ContextKind::egl};
}

void expect_maps_of_render(const std::string& file, const EnvironmentMap& sky, RenderOptions options) {
  const Scene scene = Scene::read(file);
  const Light light(sky.clone());
  const std::vector<RenderedMap> made = scene.maps(places, options, &light),
                                 again = scene.maps(places, options, &light);
  ASSERT_EQ(made.size(), places.size());
  const std::size_t step = options.method == DrawMethod::raycast ? 1 : 2;  // OpenGL takes its time to start.
  for (std::size_t k = 0; k < places.size(); k += step) {
    options.at = places[k];
    const RenderedMap wanted = render(file, options, &sky);
    EXPECT_TRUE(same(made[k].map, wanted.map)) << k;
    EXPECT_TRUE(same(again[k].map, wanted.map)) << k;
    EXPECT_EQ(made[k].method, wanted.method);
    EXPECT_EQ(made[k].remarks, wanted.remarks);
  }
}

TEST_F(ScenesKept, MapsByRaysAreThoseOfRender) { expect_maps_of_render(path("room.obj"), sky(), cast()); }
TEST_F(ScenesKept, MapsByOpenGlAreThoseOfRender) { expect_maps_of_render(path("room.obj"), sky(), drawn()); }

TEST_F(ScenesKept, LightsAndTimesMayChange) {
  write_moving();
  const std::string file = path("moving.glb");
  const Scene scene = Scene::read(file);
  const EnvironmentMap bright = sky(), even = generate(Gradient{}, Projection::latlong, 32);
  const Light sun{bright.clone()}, gradient{even.clone()};
  RenderOptions options = cast();
  for (const double time : {0.0, 1.5, 0.0}) {
    options.time_seconds = time;
    EXPECT_TRUE(same(scene.map(options, &sun).map, render(file, options, &bright).map)) << time;
    EXPECT_TRUE(same(scene.map(options, &gradient).map, render(file, options, &even).map)) << time;
    EXPECT_TRUE(same(scene.map(options).map, render(file, options).map)) << time;
  }
  options = drawn();  // OpenGL takes its time to start: one comparison after several changes.
  (void)scene.map(options, &sun);
  options.time_seconds = 1.5;
  EXPECT_TRUE(same(scene.map(options, &gradient).map, render(file, options, &even).map));
  EXPECT_FALSE(same(scene.map(cast(), &sun).map, scene.map(cast(), &gradient).map));
}

TEST_F(ScenesKept, PicturesAreThoseOfView) {
  const Scene scene = Scene::read(path("room.obj"));
  const EnvironmentMap bright = sky();
  const Light light{bright.clone()};
  const ViewOptions options{.camera = Direction(0, 0, 0.1), .width = 16, .height = 12, .context = drawn().context};
  (void)scene.map(drawn(), &light);  // Which shares the context.
  EXPECT_EQ(scene.view(options, &light).radiance, view(path("room.obj"), options, &bright).radiance);
}

TEST_F(ScenesKept, TwoScenesTakeTurnsAtOpenGl) {
  write_moving();
  const Scene room = Scene::read(path("room.obj")), moving = Scene::read(path("moving.glb"));
  const Light light{sky()};
  const EnvironmentMap first = room.map(drawn(), &light).map.clone(), second = moving.map(drawn(), &light).map.clone();
  std::vector<std::thread> threads;
  std::atomic<int> different = 0;
  for (int k = 0; k < 4; ++k)
    threads.emplace_back([&, k] {
      const Scene& scene = k % 2 == 0 ? room : moving;
      if (!same(scene.map(drawn(), &light).map, k % 2 == 0 ? first : second)) ++different;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(different, 0);
}

TEST_F(ScenesKept, BytesAreAsGoodAsAFile) {
  write_moving();
  const RenderOptions bright{.size = 16, .method = DrawMethod::raycast, .ambient = Colour(1)};
  const EnvironmentMap wanted = render(path("moving.glb"), bright).map.clone();
  EXPECT_TRUE(same(Scene::read(bytes_of(path("moving.glb"))).map(bright).map, wanted));
  const Scene room = Scene::read(bytes_of(path("room.obj")), {.folder = folder.string()});
  EXPECT_TRUE(same(room.map(bright).map, render(path("room.obj"), bright).map));
}

void fails_with(const std::function<void()>& call, const std::string& words) {
  try {
    call();
    ADD_FAILURE() << "nothing was thrown in place of: " << words;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

TEST_F(ScenesKept, ErrorsSayWhatIsWrong) {
  GltfFile file = triangle();
  file.write(folder / "beside.gltf");  // With its buffer in data.bin.
  const std::vector<std::byte> bytes = bytes_of(path("beside.gltf"));
  fails_with([&] { (void)Scene::read(bytes); }, "scene in memory: ");
  fails_with([&] { (void)Scene::read(bytes); }, "give the folder that it lies in");
  EXPECT_NO_THROW((void)Scene::read(bytes, {.folder = folder.string()}));
  fails_with([&] { (void)Scene::read(std::span<const std::byte>()); }, "scene in memory: is empty");
  fails_with([&] { (void)Scene::read(path("room.obj"), {.folder = "."}); }, "folder is for a scene in memory");
  const Scene scene = Scene::read(path("room.obj"));
  fails_with([&] { (void)scene.maps(std::vector<ScenePlace>{"nobody"}, cast()); }, "'nobody' is no node of");
  fails_with([&] { (void)scene.maps(std::vector<ScenePlace>{Direction(NAN, 0, 0)}, cast()); }, "at must be finite");
  EnvironmentMap broken = sky();
  broken.base().row(0, 0)[0].x = NAN;
  fails_with([&] { (void)Light(std::move(broken)); }, "NaN");
  fails_with([&] { (void)Light(EnvironmentMap{}); }, "level");
  EXPECT_TRUE(scene.maps({}, cast()).empty());
}

TEST_F(ScenesKept, StopsBetweenMaps) {
  const Scene scene = Scene::read(path("room.obj"));
  std::stop_source button;
  const std::vector<ScenePlace> many(20, places[0]);
  const auto stop_late = [&](double part) {
    if (part > 0.6) button.request_stop();
  };
  for (const RenderOptions& options : {cast(), drawn()}) {
    button = {};
    EXPECT_THROW((void)scene.maps(many, options, nullptr, {.progress = stop_late, .stop = button.get_token()}),
                 Cancelled);
  }
}

TEST_F(ScenesKept, KnowsItsNodesAndItsBox) {
  write_moving();
  const Scene room = Scene::read(path("room.obj")), moving = Scene::read(path("moving.glb"));
  EXPECT_FALSE(room.nodes().empty());
  EXPECT_EQ(room.box().low, Direction(-1));
  EXPECT_EQ(room.box().high, Direction(1));
  EXPECT_EQ(moving.box(2).low.x - moving.box(0).low.x, 2);
}

// What is dear, the prefiltered levels of the sky, is made once for all maps.
TEST_F(ScenesKept, EightMapsFilterTheSkyOnce) {
  const auto work = [&](std::size_t count) {
    const Light light(sky(256));
    const std::vector<ScenePlace> at(count, places[1]);
    const prefiltering::WorkDone before = prefiltering::work_done();
    (void)Scene::read(path("room.obj")).maps(at, {.size = 16, .method = DrawMethod::raycast}, &light);
    prefiltering::WorkDone done = prefiltering::work_done();
    for (std::size_t k = 0; k < done.size(); ++k) done[k] -= before[k];
    return done;
  };
  const prefiltering::WorkDone one = work(1);
  EXPECT_GT(std::ranges::max(one), 0);
  EXPECT_EQ(work(8), one);
}

}  // namespace
}  // namespace scene_test

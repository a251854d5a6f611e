// What drawing a map costs on OSMesa: milliseconds a map, without reading it back (raycast has nothing to read back;
// resample is the six faces of its cube, read back and converted).
//
//   METHOD/PROJECTION/edge:E/size:N    the box of tests/render/rooms.h, 12 (E-1)^2 triangles
//   view/PROJECTION/mirrors:N          frames of so many mirror balls in that box, one of which moves:
// all maps drawn once, at
//                                      256 (cube: 128), and a picture of 320x240
//
// Beside the time of a map, the part of texels that show another surface than a ray in float64 meets, in %.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "render/rooms.h"

namespace {

using namespace envmap;

Drawn once(Renderer& renderer, const Viewpoint& from, const FrameState& shot, DrawMethod method) {
  return method == DrawMethod::raycast ? raycast(shot, from) : draw(renderer, from, shot, method);
}

void draw_maps(benchmark::State& state, DrawMethod method, Projection to) {
  static Context context(ContextKind::osmesa);
  const SceneGraph scene = rooms::room(int(state.range(0)));
  Renderer renderer(scene, nullptr);
  const FrameState shot{scene, pose(scene, 0)};
  const Viewpoint from{.to = to, .size = int(state.range(1)), .at = {0.1, -0.2, 0.15}, .axes = rotation(20, 30, 40)};
  const rooms::Faults faults = rooms::judge(once(renderer, from, shot, method), from);
  MapTexture map(from.to, from.size);
  for (auto _ : state) {
    if (method == DrawMethod::resample || method == DrawMethod::raycast) {
      benchmark::DoNotOptimize(once(renderer, from, shot, method));
    } else {
      renderer.draw(from, shot, method, map);
      glFinish();
    }
  }
  state.counters["wrong"] = 100 * (faults.holes + faults.surface);
}

// Balls of 24 rings in rows of four before the camera.
SceneGraph hall(int mirrors) {
  SceneGraph scene = rooms::room(21);
  scene.materials.push_back({.metallic = 1, .roughness = 0});
  scene.meshes.push_back(rooms::ball(24, 0.1));
  scene.meshes.back().material = int(scene.materials.size()) - 1;
  for (int k = 0; k < mirrors; ++k)
    scene.nodes.push_back(
        {.local = glm::translate(Matrix(1), Direction(-0.45 + 0.3 * (k % 4), 0.45 - 0.3 * (k / 4), -0.2 * (k % 3))),
         .meshes = {int(scene.meshes.size()) - 1}});
  return scene;
}

void measure_view(benchmark::State& state, Projection to) {
  static Context context(ContextKind::osmesa);
  const SceneGraph scene = hall(int(state.range(0)));
  const std::vector<Mirror> found = find_mirrors(scene, to);
  std::vector<int> nodes;
  for (const Mirror& mirror : found) nodes.push_back(mirror.node);
  Renderer renderer(scene, nullptr, nodes);
  Mirrors mirrors(scene, found);
  FrameState shot{scene, pose(scene, 0)};
  const Viewpoint from{.size = 240, .at = {0.1, 0.05, 0.95}, .lens = Lens{320, {0.8, 0.6}, 0}};
  for (auto _ : state) {
    shot.pose[std::size_t(nodes.front())][3].z += 1e-3;
    shot.mirrors = {};
    mirrors.update(renderer, shot, {{.at = from.at, .pixel = 1.2 / from.size}},
                   {.size = to == Projection::cube ? 128 : 256, .bounces = 1});
    shot.mirrors = mirrors.maps();
    benchmark::DoNotOptimize(draw_picture(renderer, from, shot));
  }
  state.SetItemsProcessed(state.iterations());
}

}  // namespace

int main(int argc, char** argv) {
  for (const Projection to : all_projections)
    for (const DrawMethod method :
         {DrawMethod::exact, DrawMethod::distort, DrawMethod::tessellate, DrawMethod::resample, DrawMethod::raycast}) {
      if (to == Projection::latlong && (method == DrawMethod::distort || method == DrawMethod::tessellate)) continue;
      benchmark::RegisterBenchmark(fmt::format("{}/{}", draw_method_names[std::size_t(method)], name(to)).c_str(),
                                   draw_maps, method, to)
          ->ArgNames({"edge", "size"})
          ->ArgsProduct({{2, 4, 21, 77, 209}, {512}})
          ->ArgsProduct({{21}, {128, 256, 1024}})
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    }
  for (const Projection to : {Projection::sphere, Projection::paraboloid, Projection::cube})
    benchmark::RegisterBenchmark(fmt::format("view/{}", name(to)).c_str(), measure_view, to)
        ->ArgName("mirrors")
        ->Arg(1)
        ->Arg(4)
        ->Arg(16)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}

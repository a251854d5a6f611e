// What drawing a map costs on OSMesa: milliseconds a map, without reading it back (raycast has nothing to read back; resample
// is the six faces of its cube, read back and converted).
//
//   METHOD/PROJECTION/edge:E/size:N    the box of tests/render/rooms.h, 12 (E-1)^2 triangles
//
// Beside the time, the part of texels that show another surface than a ray in float64 meets, in %.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "envmap/render/context.h"
#include "envmap/render/raycast.h"
#include "envmap/render/renderer.h"
#include "render/rooms.h"

namespace {

using namespace envmap;

Drawn once(Renderer& renderer, const Viewpoint& from, const Shot& shot, DrawMethod method) {
  return method == DrawMethod::raycast ? raycast(shot, from) : draw(renderer, from, shot, method);
}

void measure(benchmark::State& state, DrawMethod method, Projection to) {
  static Context context(ContextKind::osmesa);
  const Scene scene = rooms::room(static_cast<int>(state.range(0)));
  Renderer renderer(scene, nullptr);
  const Shot shot{scene, pose(scene, 0)};
  const Viewpoint from{.to = to, .size = static_cast<int>(state.range(1)), .at = {0.1, -0.2, 0.15}, .axes = rotation(20, 30, 40)};
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

}  // namespace

int main(int argc, char** argv) {
  for (const Projection to : all_projections)
    for (const DrawMethod method :
         {DrawMethod::exact, DrawMethod::distort, DrawMethod::tessellate, DrawMethod::resample, DrawMethod::raycast}) {
      if (to == Projection::latlong && (method == DrawMethod::distort || method == DrawMethod::tessellate)) continue;
      benchmark::RegisterBenchmark(fmt::format("{}/{}", draw_method_names[static_cast<std::size_t>(method)], name(to)).c_str(),
                                   measure, method, to)
          ->ArgNames({"edge", "size"})
          ->ArgsProduct({{2, 4, 21, 77, 209}, {512}})
          ->ArgsProduct({{21}, {128, 256, 1024}})
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}

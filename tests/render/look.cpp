#include <fmt/format.h>
#include <chrono>
#include <cstdlib>
#include "envmap/render/context.h"
#include "envmap/render/renderer.h"
#include "rooms.h"
using namespace envmap;
int main(int argc, char** argv) {
  const int size = argc > 1 ? std::atoi(argv[1]) : 512;
  Context context(ContextKind::automatic);
  fmt::print("{}\n", context.renderer());
  for (int edge : {2, 4, 21, 80, 209}) {
    if (argc > 2 && edge > std::atoi(argv[2])) continue;
    const Scene scene = rooms::room(edge);
    Renderer renderer(scene, nullptr);
    const Shot shot{scene, pose(scene, 0)};
    for (Projection p : all_projections)
      for (DrawMethod m : {DrawMethod::exact, DrawMethod::distort, DrawMethod::tessellate, DrawMethod::resample}) {
        Viewpoint from{.to = p, .size = size, .at = {0.1, -0.2, 0.15}};
        if (p == Projection::latlong && (m == DrawMethod::distort || m == DrawMethod::tessellate)) continue;
        std::fflush(stdout);
        const Drawn map = draw(renderer, from, shot, m);
        const auto faults = rooms::judge(map, from);
        double best = 1e9;
        MapTexture target(p, size);
        if (m != DrawMethod::resample)
          for (int k = 0; k < 5; ++k) {
            glFinish();
            const auto start = std::chrono::steady_clock::now();
            renderer.draw(from, shot, m, target);
            glFinish();
            best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
          }
        else
          for (int k = 0; k < 3; ++k) {
            const auto start = std::chrono::steady_clock::now();
            draw(renderer, from, shot, m);
            best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
          }
        fmt::print("{:4} {:10} {:10} {:7.1f} ms  holes {:.4f}% surface {:.4f}% distance {:.4f}% colour {:.5f}\n", edge,
                   name(p), draw_method_names[static_cast<int>(m)], 1e3 * best, 100 * faults.holes,
                   100 * faults.surface, 100 * faults.distance, faults.colour);
      }
  }
}

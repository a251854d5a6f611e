#include "envmap/scenes/choose_maps.h"

#include <algorithm>
#include <cmath>

#include "envmap/scenes/mirror_painter.h"
#include "envmap/scenes/render/rays/raycast.h"

namespace envmap {

std::vector<Colour> picture_through_maps(Renderer& renderer, const FrameState& shot, const std::vector<Mirror>& mirrors,
                                         const Eye& eye, const MirrorOptions& drawing) {
  Mirrors maps(shot.scene, mirrors);
  FrameState with_maps = shot;
  with_maps.look.pictures = drawing.bounces.value_or(shot.look.pictures);
  return draw_through_maps(renderer, maps, with_maps, {eye}, drawing).pictures.front();
}

namespace {

// The rms of the difference over that of the truth, in every pixel.
double error_of(const std::vector<Colour>& picture, const std::vector<Colour>& truth) {
  double off = 0, all = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Flux t(truth[k]), d = Flux(picture[k]) - t;
    off += glm::dot(d, d), all += glm::dot(t, t);
  }
  return off > 0 ? std::sqrt(off / all) : 0;
}

}  // namespace

MapChoice choose_maps(Renderer& renderer, const std::vector<Mirror>& mirrors, std::vector<Moment> moments,
                      const MirrorOptions& drawing, double max_error, int lobe_samples) {
  std::vector<std::vector<Colour>> truths;
  for (const Moment& m : moments) {
    m.arrive();
    truths.push_back(raycast_picture(m.shot, m.eye.from,
                                     {.mirrors = nodes_of(mirrors), .far = drawing.far, .lobe_samples = lobe_samples}));
  }
  MapChoice best{.rays = true, .drawing = drawing};
  // Whether what `change` makes of the best way so far is good enough; it takes that one's place where it is,
  // or where none is yet.
  const auto does = [&](auto&& change) {
    MapChoice way = best;
    way.error = 0;
    change(way);
    for (std::size_t k = 0; k < moments.size(); ++k) {
      moments[k].arrive();
      moments[k].shot.look.lookup = way.lookup;
      way.error =
          std::max(way.error,
                   error_of(picture_through_maps(renderer, moments[k].shot, mirrors, moments[k].eye, way.drawing),
                            truths[k]));
    }
    way.rays = way.error > max_error;
    if (best.rays || !way.rays) best = way;
    return !way.rays;
  };
  for (const int largest : {64, 128, 256, 512, 1024})
    if (does([&](MapChoice& way) { way.drawing.largest = largest; }) || mirrors.empty()) break;
  if (best.rays || mirrors.empty()) return best;
  for (const int bounces : {1, 2, 4})
    if (does([&](MapChoice& way) { way.drawing.bounces = bounces; })) break;
  does([](MapChoice& way) { way.lookup = MirrorLookup::direction; });
  return best;
}

}  // namespace envmap

#include "drawing/luminances.h"

#include <algorithm>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/maths/primaries.h"

namespace tools {

using namespace envmap;

Luminances::Luminances(const Level& level) : bins_(std::size_t((highest - lowest) * per_stop)) {
  const Flux weights = luminance_weights(rec709);
  const double last = double(bins_.size() - 1);
  std::vector<double> solid_angle(std::size_t(level.width()));
  double light = 0, sphere = 0;
  for (int j = 0; j < level.height(); ++j) {
    solid_angles(level.projection(), level.height(), j, solid_angle);
    for (int face = 0; face < level.faces(); ++face)
      for (int i = 0; i < level.width(); ++i) {
        const double w = solid_angle[std::size_t(i)], l = glm::dot(weights, Flux(*level.texel(face, i, j)));
        sphere += w;
        if (!(l > 0) || !std::isfinite(l)) {
          black_ += w;
          continue;
        }
        Bin& bin = bins_[std::size_t(std::clamp((portable::log2(l) - lowest) * per_stop, 0.0, last))];
        bin.sphere += w, bin.light += w * l, light += w * l;
      }
  }
  black_ /= sphere;
  for (Bin& bin : bins_) bin.sphere /= sphere, bin.light = light > 0 ? bin.light / light : 0;
}

double Luminances::percentile(double part) const {
  double darker = black_;
  for (std::size_t k = 0; k < bins_.size(); ++k) {
    darker += bins_[k].sphere;
    if (bins_[k].sphere > 0 && darker >= part) return portable::exp2(lowest + double(k + 1) / per_stop);
  }
  return 0;
}

}  // namespace tools

#include "envmap/operate/sampling.h"

#include <algorithm>
#include <cmath>

namespace envmap {
namespace {

// Ratio of the singular values of the direction's derivative by texel steps.
double anisotropy(Projection p, const Location<double>& at) {
  const Derivative d = derivative(p, at, 1e-6);
  const Direction a = d.du / double(aspect(p)), b = d.dv;
  const double aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b);
  const double middle = 0.5 * (aa + bb), swing = std::sqrt(0.25 * (aa - bb) * (aa - bb) + ab * ab);
  // The product of the eigenvalues is the determinant: their difference would cancel where one is small.
  return (middle + swing) / std::sqrt(std::max(aa * bb - ab * ab, 1e-300));
}

}  // namespace

std::vector<SamplingRow> sampling_table(Projection p, int size, int steps) {
  const int width = size * aspect(p), ci = (width - 1) / 2, cj = (size - 1) / 2;
  std::vector<SamplingRow> rows;
  const auto direction = [&](int i, int j) {
    Direction d[1];
    texel_directions(p, size, 0, j, i, d);
    return d[0];
  };
  std::vector<double> weights(static_cast<std::size_t>(width));
  for (int k = 0; k <= steps; ++k) {
    const auto along = [&](int from, int to) {
      return from + int(std::lround((to - from) * double(k) / steps));
    };
    const int i = p == Projection::latlong ? ci : along(ci, columns(p, size, cj).end - 1);
    const int j = on_disc(p) ? cj : along(cj, 0);
    if (!rows.empty() && rows.back().i == i && rows.back().j == j) continue;
    solid_angles(p, size, j, weights);
    const double mean = 4 * pi / (faces(p) * (on_disc(p) ? 0.25 * pi : 1.0) * width * size);
    const double w = weights[i];
    rows.push_back({i, j, angle_between(direction(i, j), direction(ci, cj)) * 180 / pi, w, w / mean,
                    anisotropy(p, {0, (i + 0.5) / width, (j + 0.5) / size})});
  }
  return rows;
}

}  // namespace envmap

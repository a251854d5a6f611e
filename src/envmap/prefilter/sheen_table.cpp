#include <algorithm>
#include <cmath>
#include <utility>

#include "envmap/base/bounds.h"
#include "envmap/base/carry_out.h"
#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/prefilter/brdf_table.h"

namespace envmap {
namespace {

// Light from one direction: log2 of sin(n,h)^2, of which D is a power, and V cos(n,l) times the weight of the rule.
struct Sample {
  double log2_sine2, weight;
};

// Directions of light. Their cosines l lie in panels that grow by 4 from that of the view, as V bends there; l = high -
// w t^2 takes the square root out of sin(n,l). Their azimuths pi (1 - u^2) lie closest opposite the view,
// where h turns fastest.
std::vector<Sample> samples_for(double view) {
  const auto& lights = quadrature::rule<16>();
  const auto& azimuths = quadrature::rule<32>();
  std::vector<Sample> samples;
  for (double low = 0, high = view; low < 1; low = std::exchange(high, std::min(1.0, 4 * high)))
    for (std::size_t i = 0; i < lights.node.size(); ++i) {
      const double t = 0.5 + 0.5 * lights.node[i], light = high - (high - low) * t * t;
      const double sines = std::sqrt((1 - view * view) * (1 - light * light));
      const double seen = lights.weight[i] * (high - low) * t * light / (4 * (light + view - light * view));
      for (std::size_t k = 0; k < azimuths.node.size(); ++k) {
        const double u = 0.5 + 0.5 * azimuths.node[k];
        const double twice = 2 * (1 + view * light + sines * portable::cos_pi(1 - u * u));  // |v + l|^2
        const double cosine2 = std::min(1.0, (view + light) * (view + light) / twice);
        samples.push_back({portable::log1p(-cosine2) / std::numbers::ln2, seen * azimuths.weight[k] * u});
      }
    }
  return samples;
}

}  // namespace

std::vector<double> sheen_albedo(double cosine, std::span<const double> roughnesses) {
  check_range(limits::cosine, cosine);
  for (const double roughness : roughnesses) check_range(limits::roughness, roughness);
  const std::vector<Sample> samples = samples_for(cosine);
  std::vector<double> albedos;
  for (const double roughness : roughnesses) {
    const double power = 1 / std::max(9e-4, roughness * roughness);
    double sum = 0;
    for (const Sample& s : samples)
      if (const double x = 0.5 * power * s.log2_sine2; x > -200) sum += s.weight * portable::exp2(x);
    albedos.push_back((2 + power) * sum);
  }
  return albedos;
}

std::vector<Colour> sheen_table(int size, const Run& run) {
  check_range(limits::table_size, size);
  const auto n = std::size_t(size);
  std::vector<double> roughnesses;
  for (int j = 0; j < size; ++j) roughnesses.push_back((j + 0.5) / size);
  std::vector<Colour> table(n * n);
  carry_out(run, [&](const Progress& progress) {
    for_each_row(1, size, progress, [&](int, int i) {
      const std::vector<double> column = sheen_albedo((i + 0.5) / size, roughnesses);
      for (std::size_t j = 0; j < n; ++j) table[j * n + std::size_t(i)] = Colour(float(column[j]));
    });
  });
  return table;
}

}  // namespace envmap

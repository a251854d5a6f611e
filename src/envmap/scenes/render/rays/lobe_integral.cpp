#include "envmap/scenes/render/rays/lobe_integral.h"

#include <bit>
#include <cmath>

#include "envmap/scenes/render/shading/microfacet.h"
#include "envmap/scenes/render/shading/sheen_brdf.h"

namespace envmap {
namespace {

// A direction in the frame whose Z is the normal, uniform over azimuth.
Direction polar(double cosine, double turn) {
  const double across = std::sqrt(std::max(0.0, 1 - cosine * cosine)), azimuth = 2 * pi * turn;
  return {across * std::cos(azimuth), across * std::sin(azimuth), cosine};
}

// By the cosine to the normal.
struct CosineSampling {
  Rotation frame;

  explicit CosineSampling(const Direction& n) : frame(upright_about(n)) {}
  [[nodiscard]] Direction sample(const Point2& u) const { return frame * polar(std::sqrt(1 - u.y), u.x); }
  [[nodiscard]] double density(const Direction& l) const { return std::max(0.0, glm::dot(frame[2], l)) / pi; }
};

struct Diffuse : CosineSampling {
  using CosineSampling::CosineSampling;
  [[nodiscard]] Flux value(const Direction& l) const { return Flux(density(l)); }
};

struct Charlie : CosineSampling {
  Direction view;
  double roughness;

  Charlie(const Direction& n, const Direction& v, double r) : CosineSampling(n), view(v), roughness(r) {}
  [[nodiscard]] Flux value(const Direction& l) const {
    const Direction& n = frame[2];
    const double nl = glm::dot(n, l), nv = std::max(1e-3, glm::dot(n, view));
    return nl > 0 ? Flux(nl * sheen(glm::dot(n, glm::normalize(l + view)), nv, nl, roughness)) : Flux(0);
  }
};

// Sampled by the normals of microfacets that the viewer sees: Heitz 2018,
// "Sampling the GGX Distribution of Visible Normals".
struct Ggx {
  Rotation frame;
  Direction view, local;  // In the world, and in the frame.
  double alpha, nv;
  Flux f0;
  double f90;

  Ggx(const Direction& n, const Direction& v, double a, const Flux& straight, double grazing)
      : frame(upright_about(n)),
        view(v),
        local(v * frame),
        alpha(a),
        nv(std::max(1e-3, local.z)),
        f0(straight),
        f90(grazing) {
    local.z = nv;
    local = glm::normalize(local);
  }

  [[nodiscard]] Direction sample(const Point2& u) const {
    const Direction stretched = glm::normalize(Direction(alpha * local.x, alpha * local.y, local.z));
    const double across = std::hypot(stretched.x, stretched.y);
    const Direction t1 = across > 0 ? Direction(-stretched.y, stretched.x, 0) / across : Direction(1, 0, 0);
    const Direction t2 = glm::cross(stretched, t1);
    const double r = std::sqrt(u.y), azimuth = 2 * pi * u.x, s = 0.5 * (1 + stretched.z);
    const double x = r * std::cos(azimuth);
    const double y = (1 - s) * std::sqrt(std::max(0.0, 1 - x * x)) + s * r * std::sin(azimuth);
    const Direction m = x * t1 + y * t2 + std::sqrt(std::max(0.0, 1 - x * x - y * y)) * stretched;
    const Direction h = glm::normalize(Direction(alpha * m.x, alpha * m.y, std::max(0.0, m.z)));
    return frame * (2 * glm::dot(local, h) * h - local);
  }

  // D G1 / (4 cos(n,v)), G1 = 2 nv / (nv + sqrt(a^2 + (1 - a^2) nv^2)).
  [[nodiscard]] double density(const Direction& l) const {
    const double z = local.z, masked = 2 / (z + std::sqrt(alpha * alpha + (1 - alpha * alpha) * z * z));
    return ggx_distribution(alpha, frame[2], glm::normalize(l + frame * local)) * masked / 4;
  }

  [[nodiscard]] Flux value(const Direction& l) const {
    const double nl = glm::dot(frame[2], l);
    if (nl <= 0) return Flux(0);
    const Direction h = glm::normalize(l + view);
    const Flux fresnel = f0 + (f90 - f0) * schlick_weight(glm::dot(view, h));
    return nl * ggx_distribution(alpha, frame[2], h) * smith_visibility(alpha, nv, nl) * fresnel;
  }
};

// The additive sequence of Roberts 2018 ("The Unreasonable Effectiveness of Quasirandom Sequences"), in the square.
Point2 sequence(int k, const Point2& start) {
  const double x = start.x + 0.7548776662466927 * k, y = start.y + 0.5698402909980532 * k;
  return {x - std::floor(x), y - std::floor(y)};
}

// Where a sequence starts: other pixels err otherwise. SplitMix64 of the bits of a direction.
Point2 start_of(const Direction& d) {
  const auto mixed = [](std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  };
  const std::uint64_t a = mixed(std::bit_cast<std::uint64_t>(d.x) + mixed(std::bit_cast<std::uint64_t>(d.y)));
  const std::uint64_t b = mixed(a + std::bit_cast<std::uint64_t>(d.z));
  return {double(a >> 11) * 0x1p-53, double(b >> 11) * 0x1p-53};
}

}  // namespace

template <class Lobe>
Flux LobeIntegral::integrate(const Lobe& lobe) const {
  Flux sum(0);
  const auto add = [&](const Direction& l, double by_light) {
    const double density = lobe.density(l) + by_light;
    const Flux value = lobe.value(l);
    if (density > 0 && value != Flux(0)) sum += Flux(lookup_(l)) * value / density;
  };
  const Point2 start = start_of(lobe.frame[2]);
  for (int k = 0; k < half_; ++k) {
    const Direction l = lobe.sample(sequence(k, start));
    add(l, sampler_.density(l));
    const EnvironmentSampler::Sample light = sampler_.sample(sequence(k, {start.y, start.x}));
    if (light.density > 0) add(light.from, light.density);
  }
  return sum / double(half_);
}

Flux LobeIntegral::diffuse(const Direction& n) const { return integrate(Diffuse(n)); }

Flux LobeIntegral::ggx(const Direction& n, const Direction& v, double alpha, const Flux& f0, double f90) const {
  return integrate(Ggx(n, v, alpha, f0, f90));
}

Flux LobeIntegral::charlie(const Direction& n, const Direction& v, double roughness) const {
  return integrate(Charlie(n, v, roughness));
}

}  // namespace envmap

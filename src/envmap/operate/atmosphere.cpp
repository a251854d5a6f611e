#include "envmap/operate/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/check_direction.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/primaries.h"
#include "envmap/operate/air.h"
#include "envmap/projection/visit.h"

namespace envmap {
namespace {

// The sky of one viewer and sun, tabulated by the zenith angle and the azimuth from the sun. What is tabulated is
// smooth: the phase functions, which are not, are applied afterwards.
class SkyTable {
 public:
  SkyTable(const Atmosphere& a, const air::Air& air);
  [[nodiscard]] Flux radiance(const Direction& d) const;
  [[nodiscard]] double edge() const { return edge_; }

 private:
  struct Node {
    Flux molecules, haze, even;
  };
  static constexpr int zeniths = 257, turns = 65;  // Above the horizon, and as many below.
  void tabulate(const air::Air& air, bool down, double radius, double mu_sun);

  Direction sun_;
  Point2 side_{0, 1};  // Horizontal part of the sun's direction, x and z.
  double edge_;        // Height of the horizon in a direction.
  std::vector<Node> nodes_;
};

SkyTable::SkyTable(const Atmosphere& a, const air::Air& air)
    : sun_(a.sun), edge_(air::horizon(air::ground_radius + a.altitude)), nodes_(std::size_t(2) * zeniths * turns) {
  if (const double across = std::sqrt(a.sun.x * a.sun.x + a.sun.z * a.sun.z); across > 0)
    side_ = {a.sun.x / across, a.sun.z / across};
  for (const bool down : {false, true}) tabulate(air, down, air::ground_radius + a.altitude, a.sun.y);
}

void SkyTable::tabulate(const air::Air& air, bool down, double radius, double mu_sun) {
  const double sine_sun = std::sqrt(std::max(0.0, 1 - mu_sun * mu_sun));
  for_each_row(1, zeniths, {}, [&](int, int row) {
    const double x = row / (zeniths - 1.0), mu = std::clamp(edge_ + x * x * (down ? -1 - edge_ : 1 - edge_), -1.0, 1.0);
    for (int k = 0; k < turns; ++k) {
      const double nu = mu * mu_sun + std::sqrt(1 - mu * mu) * sine_sun * (2.0 * k / (turns - 1) - 1);
      air::Scattered s = air.scattered({radius, mu, mu_sun, std::clamp(nu, -1.0, 1.0), down});
      for (int b = 0; b < air::bands; ++b) {
        s.molecules[b] *= air::sun_irradiance()[b];
        s.haze[b] *= air::sun_irradiance()[b];
      }
      nodes_[std::size_t((down ? zeniths : 0) + row) * turns + k] = {air::to_rgb(s.molecules), air::to_rgb(s.haze),
                                                                     air::to_rgb(s.even)};
    }
  });
}

Flux SkyTable::radiance(const Direction& d) const {
  const bool down = d.y < edge_;
  const double from_edge = (d.y - edge_) / (down ? -1 - edge_ : 1 - edge_);
  const double across = std::sqrt(d.x * d.x + d.z * d.z);
  const double turn = across > 0 ? std::clamp((d.x * side_.x + d.z * side_.y) / across, -1.0, 1.0) : 1;
  const double row = (zeniths - 1) * std::sqrt(std::clamp(from_edge, 0.0, 1.0)),
               column = 0.5 * (turns - 1) * (turn + 1);
  const int i = std::min(int(row), zeniths - 2), j = std::min(int(column), turns - 2);
  const Node* n = &nodes_[std::size_t((down ? zeniths : 0) + i) * turns + j];
  const double r = row - i, c = column - j;
  const double w[] = {(1 - r) * (1 - c), (1 - r) * c, r * (1 - c), r * c};
  const Node* corner[] = {n, n + 1, n + turns, n + turns + 1};
  const double nu = std::clamp(glm::dot(d, sun_), -1.0, 1.0);
  const double molecules = air::molecule_phase(nu), haze = air::haze_phase(nu);
  Flux sum(0);
  for (int k = 0; k < 4; ++k)
    sum += w[k] * (molecules * corner[k]->molecules + haze * corner[k]->haze + corner[k]->even);
  return glm::max(sum, Flux(0));  // Colours beyond Rec.709.
}

// ---- the sun's disc -------------------------------------------------------------------------------------------------

// Its radiance by the height in which it is seen and by the cosine at the sun's surface: darkened
// towards the limb by Hestroffer and Magnan, and dimmed by the air.
class SunTable {
 public:
  SunTable(const Atmosphere& a, const air::Air& air, double edge);
  [[nodiscard]] Flux radiance(double height, double limb) const;  // `limb`: cosine at the sun's surface.
  [[nodiscard]] double solid_angle() const { return solid_angle_; }

 private:
  static constexpr int heights = 65, limbs = 65;
  double low_, high_, solid_angle_;
  std::vector<Flux> nodes_;
};

SunTable::SunTable(const Atmosphere& a, const air::Air& air, double edge) : nodes_(std::size_t(heights) * limbs) {
  const double half = portable::sin(0.5 * a.radius_degrees * pi / 180);
  solid_angle_ = 4 * pi * half * half;
  const double reach = 2 * half;
  low_ = std::clamp(a.sun.y - reach, edge, 1.0 - 1e-9);
  high_ = std::max(low_ + 1e-9, std::min(a.sun.y + reach, 1.0));
  for (int i = 0; i < heights; ++i) {
    const air::Spectrum arrives =
        air.sunlight(air::ground_radius + a.altitude, low_ + (high_ - low_) * i / (heights - 1));
    for (int j = 0; j < limbs; ++j) {
      air::Spectrum s;
      for (int b = 0; b < air::bands; ++b) {
        const double exponent = air::limb_exponent()[b];
        s[b] = arrives[b] * air::sun_irradiance()[b] / solid_angle_ * (1 + 0.5 * exponent) *
               portable::pow(j / (limbs - 1.0), exponent);
      }
      nodes_[std::size_t(i) * limbs + j] = air::to_rgb(s);
    }
  }
}

Flux SunTable::radiance(double height, double limb) const {
  const double y = std::clamp((height - low_) / (high_ - low_), 0.0, 1.0) * (heights - 1), x = limb * (limbs - 1);
  const int i = std::min(int(y), heights - 2), j = std::min(int(x), limbs - 2);
  const Flux* n = &nodes_[std::size_t(i) * limbs + j];
  return glm::mix(glm::mix(n[0], n[1], x - j), glm::mix(n[limbs], n[limbs + 1], x - j), y - i);
}

// f(direction, flux) for points of equal solid angle over the part of the disc above the horizon (a Fibonacci lattice).
template <class F>
void over_disc(const Atmosphere& a, const SunTable& table, double edge, std::int64_t points, F&& f) {
  const Direction e1 =
      glm::normalize(glm::cross(std::abs(a.sun.x) < 0.7 ? Direction(1, 0, 0) : Direction(0, 1, 0), a.sun));
  const Direction e2 = glm::cross(a.sun, e1);
  const double depth = table.solid_angle() / (2 * pi), each = table.solid_angle() / double(points);
  for (std::int64_t k = 0; k < points; ++k) {
    const double part = (double(k) + 0.5) / double(points), below = part * depth, z = 1 - below;
    const double sine = std::sqrt(below * (1 + z)), turn = 2 * std::fmod(double(k) * std::numbers::phi, 1.0);
    const Direction d = z * a.sun + sine * (portable::cos_pi(turn) * e1 + portable::sin_pi(turn) * e2);
    if (d.y >= edge) f(d, each * table.radiance(d.y, std::sqrt(1 - part)));
  }
}

// Each point goes whole into the texel that it hits: the map holds the sun's flux at any size.
template <class P>
void add_disc(const Atmosphere& a, const SunTable& table, double edge, EnvironmentMap& map) {
  Level& level = map.base();
  const int w = level.width(), h = level.height();
  const double texels = table.solid_angle() * P::faces * w * h / (4 * pi);
  const Rotation to_image = glm::transpose(image_to_world(map.forward));
  std::unordered_map<std::int64_t, Flux> lit;
  over_disc(a, table, edge, std::int64_t(std::clamp(512 * texels, 0x1p20, 0x1p24)),
            [&](const Direction& d, const Flux& flux) {
              const auto at = P::locate(to_image * d);
              const int i = std::clamp(int(at.u * w), 0, w - 1), j = std::clamp(int(at.v * h), 0, h - 1);
              lit.try_emplace((std::int64_t(at.face) * h + j) * w + i, 0).first->second += flux;
            });
  for (const auto& [texel, flux] : lit) {
    const int i = int(texel % w), j = int(texel / w % h), face = int(texel / w / h);
    const double solid_angle = P::solid_angle({double(i) / w, double(j) / h, (i + 1.0) / w, (j + 1.0) / h});
    Colour& c = *level.texel(face, i, j);
    if (solid_angle > 0) c = Colour(glm::max(Flux(c) + flux / solid_angle, Flux(0)));
  }
}

void check_atmosphere(const Atmosphere& a) {
  check_enumerator("scattering", a.scattering);
  check_range(limits::turbidity, a.turbidity);
  check_range(limits::altitude, a.altitude);
  check_range(limits::sun_radius, a.radius_degrees);
  for (int c = 0; c < 3; ++c) check_range(limits::albedo, a.ground[c]);
}

void fill_sky(const SkyTable& sky, EnvironmentMap& map, const Progress& progress) {
  Level& level = map.base();
  const Rotation to_world = image_to_world(map.forward);
  for_each_row(level.faces(), level.height(), progress, [&](int face, int row) {
    const Columns in = level.columns(row);
    std::vector<Direction> d(in.count());
    texel_directions(level.projection(), level.height(), face, row, in.first, d);
    std::ranges::transform(d, in.of(level.row(face, row)).begin(),
                           [&](const Direction& v) { return Colour(sky.radiance(to_world * v)); });
  });
}

}  // namespace

Daylight generate(const Atmosphere& wanted, const Frame& to, int size, const Run& run) {
  check_atmosphere(wanted);
  check_range(limits::size, size);
  Atmosphere a = wanted;
  a.sun = glm::normalize(checked_direction("sun", a.sun));
  Daylight made{.map = blank_map(to, size)};
  run_operation(run, [&](const Progress& progress) {
    const double radius = air::ground_radius + a.altitude, edge = air::horizon(radius);
    const double reach =
        portable::acos(air::ground_radius / radius) + portable::acos(air::ground_radius / air::top_radius) + 0.01;
    const air::Air air({a.turbidity, a.ground, a.scattering == Scattering::multiple, portable::acos(a.sun.y), reach});
    fill_sky(SkyTable(a, air), made.map, progress);
    const SunTable disc(a, air, edge);
    if (a.disc) visit(made.map.projection(), [&](auto p) { add_disc<decltype(p)>(a, disc, edge, made.map); });
    const Flux weights = luminous_efficacy * luminance_weights(rec709);
    over_disc(a, disc, edge, 1 << 14, [&](const Direction& d, const Flux& flux) {
      made.sun_normal += glm::dot(weights, flux) * glm::dot(d, a.sun);
      made.sun_horizontal += glm::dot(weights, flux) * std::max(0.0, d.y);
    });
    made.sky_horizontal = glm::dot(weights, air::to_rgb(air.sky_irradiance(radius, a.sun.y)));
  });
  return made;
}

}  // namespace envmap

// The sky against integrals, simulated photons and measured daylight, none of which use its tables.
#include "envmap/operate/atmosphere.h"

#include <gtest/gtest.h>

#include <random>

#include "envmap/base/error.h"
#include "envmap/maths/compensated_sum.h"
#include "envmap/maths/primaries.h"
#include "envmap/operate/air.h"
#include "envmap/operate/lookup.h"
#include "envmap/operate/measure.h"
#include "numeric/floor.h"

namespace envmap::atmosphere_test {
namespace {

// ---- the air, written down a second time, in kilometres -------------------------------------------------------------

constexpr double earth = 6371, top = 6471;

// Vertical optical depths. Molecules: Bodhaine et al. 1999. Ozone: 300 Dobson units of Gorshelev et al. 2014.
struct Depths {
  int band;
  double molecules, haze, ozone;
};

Depths depths(int band, double turbidity) {
  const double haze = (turbidity - 1) * 0.097065;
  if (band == 3) return {band, 0.221106, haze * 1.29806, 8.061e22 * 1.949e-26};  // 450 nm; (550 / 450)^1.3.
  if (band == 8) return {band, 0.097065, haze, 8.061e22 * 3.2955e-25};           // 550 nm.
  return {13, 0.0491835, haze * 0.804798, 8.061e22 * 2.45e-25};                  // 650 nm.
}

struct Extinction {
  double molecules, haze, ozone;  // Per kilometre.
  [[nodiscard]] double all() const { return molecules + haze + ozone; }
};

Extinction extinction(const Depths& d, double height) {
  const double tent = height > 10 && height < 25    ? (height - 10) / 15
                      : height >= 25 && height < 40 ? (40 - height) / 15
                                                    : 0;
  return {d.molecules / 8 * std::exp(-height / 8), d.haze / 1.2 * std::exp(-height / 1.2), d.ozone / 15 * tent};
}

double sphere_exit(const Direction& p, const Direction& d, double radius) {
  const double b = glm::dot(p, d);
  return -b + std::sqrt(b * b - glm::dot(p, p) + radius * radius);
}

bool meets_ground(const Direction& p, const Direction& d) {
  const double b = glm::dot(p, d);
  return b < 0 && glm::dot(p, p) - b * b < earth * earth;
}

// By Simpson's rule, with points that crowd at the beginning.
double transmittance(const Depths& depth, const Direction& p, const Direction& d) {
  if (meets_ground(p, d)) return 0;
  const double end = sphere_exit(p, d, top);
  const int n = 160;
  double sum = 0;
  for (int k = 0; k <= n; ++k) {
    const double x = double(k) / n;
    sum += (k == 0 || k == n ? 1
            : k % 2          ? 4
                             : 2) *
           2 * x * extinction(depth, glm::length(p + end * x * x * d) - earth).all();
  }
  return std::exp(-sum * end / (3 * n));
}

double rayleigh(double cosine) { return 3 * (1 + cosine * cosine) / (16 * pi); }
double cornette_shanks(double cosine) {
  return 3 / (8 * pi) * 0.36 * (1 + cosine * cosine) / (2.64 * std::pow(1.64 - 1.6 * cosine, 1.5));
}

// Light of one scattering of a sun of irradiance 1, by the midpoint rule.
double single_scattering(const Depths& depth, const Direction& eye, const Direction& d, const Direction& sun) {
  const double end = sphere_exit(eye, d, top), cosine = glm::dot(d, sun);
  const int n = 500;
  double light = 0, passed = 0;
  for (int k = 0; k < n; ++k) {
    const double x0 = double(k) / n, x1 = (k + 1.0) / n, t = end * 0.5 * (x0 * x0 + x1 * x1),
                 step = end * (x1 * x1 - x0 * x0);
    const Direction p = eye + t * d;
    const Extinction e = extinction(depth, glm::length(p) - earth);
    light += step * std::exp(-passed - 0.5 * step * e.all()) * transmittance(depth, p, sun) *
             (e.molecules * rayleigh(cosine) + 0.9 * e.haze * cornette_shanks(cosine));
    passed += step * e.all();
  }
  return light;
}

air::Air model(double turbidity, double elevation, bool multiple, double ground = 0.2) {
  return air::Air({turbidity, Rgb<double>(ground), multiple, pi / 2 - elevation, 0.32});
}

Direction at_angles(double elevation, double azimuth) {
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

constexpr double degree = pi / 180;

TEST(Atmosphere, SingleScatteringIsItsIntegral) {
  for (const double height : {0.0, 3.0})
    for (const double elevation : {60.0, 10.0, 0.5, -4.0})
      for (const int band : {3, 13}) {
        const air::Air air = model(2.5, elevation * degree, false);
        const Direction sun = at_angles(elevation * degree, 0), eye(0, earth + height, 0);
        double most = 0, largest = 0;
        for (const double up : {0.2, 3.0, 20.0, 70.0, 90.0})
          for (const double azimuth : {0.0, 50.0, 180.0}) {
            const Direction d = at_angles(up * degree, azimuth * degree);
            const double nu = glm::dot(d, sun), wanted = single_scattering(depths(band, 2.5), eye, d, sun);
            const air::Scattered s = air.scattered({1000 * eye.y, d.y, sun.y, nu});
            const double got = s.molecules[band] * rayleigh(nu) + s.haze[band] * cornette_shanks(nu);
            largest = std::max(largest, wanted);
            most = std::max(most, std::abs(got - wanted));
          }
        EXPECT_LT(most / largest, elevation > 0 ? 1e-3 : 5e-3)
            << height << " km, sun at " << elevation << ", band " << band;
      }
}

TEST(Atmosphere, SunlightIsDimmedByTheAirInItsWay) {
  const air::Air air = model(4, 1, false);
  for (const double height : {0.0, 3.0, 20.0})
    for (const double elevation : {90.0, 30.0, 5.0, 1.0, 0.0})
      for (const int band : {3, 8, 13}) {
        const double wanted = transmittance(depths(band, 4), {0, earth + height, 0}, at_angles(elevation * degree, 0));
        const double got = air.sunlight(1000 * (earth + height), std::sin(elevation * degree))[band];
        EXPECT_NEAR(got, wanted, 3e-3 * std::max(wanted, 0.1)) << height << " km, " << elevation << ", " << band;
      }
}

// ---- photons through flat layers ------------------------------------------------------------------------------------

struct Photons {
  std::mt19937_64 engine{1};
  std::uniform_real_distribution<double> uniform{0, 1};
  double next() { return uniform(engine); }

  // A direction off another one by an angle.
  Direction off(const Direction& d, double cosine) {
    const Direction e1 = glm::normalize(glm::cross(std::abs(d.x) < 0.7 ? Direction(1, 0, 0) : Direction(0, 1, 0), d));
    const double turn = 2 * pi * next(), sine = std::sqrt(1 - cosine * cosine);
    return glm::normalize(cosine * d + sine * (std::cos(turn) * e1 + std::sin(turn) * glm::cross(d, e1)));
  }

  double deflection(bool molecules) {
    for (;;) {
      const double c = 2 * next() - 1;
      const double most = molecules ? rayleigh(1) : cornette_shanks(1);
      if (next() * most < (molecules ? rayleigh(c) : cornette_shanks(c))) return c;
    }
  }

  // The part of a photon from the sun that reaches the ground after it was scattered.
  double diffuse(const Depths& d, double sine, double albedo) {
    const auto above = [&](double h) { return d.molecules * std::exp(-h / 8) + d.haze * std::exp(-h / 1.2); };
    Direction towards(std::sqrt(1 - sine * sine), -sine, 0);
    double weight = 1, sum = 0, height = 100;
    for (bool scattered = false; weight > 1e-4;) {
      const double depth = above(height) + std::log(next()) * towards.y;
      if (depth <= 0) break;
      if (depth >= above(0)) {
        if (scattered) sum += weight;
        scattered = true;
        weight *= albedo;
        height = 0;
        towards = off({0, 1, 0}, std::sqrt(next()));
        continue;
      }
      double low = 0, high = 300;
      for (int k = 0; k < 40; ++k) (above(0.5 * (low + high)) > depth ? low : high) = 0.5 * (low + high);
      height = low;
      const double a = d.molecules / 8 * std::exp(-height / 8), b = d.haze / 1.2 * std::exp(-height / 1.2);
      const bool molecules = next() * (a + b) < a;
      if (!molecules) weight *= 0.9;
      towards = off(towards, deflection(molecules));
      scattered = true;
    }
    return sum;
  }
};

// Hillaire's series is an approximation: 4% with the sun high and a ground up to 0.2, 10% with a ground of 0.5.
TEST(Atmosphere, SkylightIsWhatPhotonsBring) {
  for (const double turbidity : {1.0, 2.5})
    for (const double albedo : {0.0, 0.2, 0.5}) {
      const Depths d = depths(8, turbidity);
      const double sine = std::sin(pi / 3);
      Photons photons;
      CompensatedSum sum;
      const int count = 60000;
      for (int k = 0; k < count; ++k) sum.add(photons.diffuse(d, sine, albedo));
      const double wanted = sum.value() / count * std::exp(-d.ozone / sine);  // Ozone lies above nearly all air.
      const air::Air air = model(turbidity, pi / 3, true, albedo);
      const double got = air.sky_irradiance(1000 * earth, sine)[8] / (air::sun_irradiance()[8] * sine);
      EXPECT_NEAR(got / wanted, 1, albedo > 0.2 ? 0.1 : 0.04) << turbidity << ", ground " << albedo;
    }
}

// ---- maps -----------------------------------------------------------------------------------------------------------

double luminance(const Flux& c) { return 683 * glm::dot(c, luminance_weights(rec709)); }

Atmosphere sun_at(double elevation, double azimuth = 0) {
  return {.sun = at_angles(elevation * degree, azimuth * degree)};
}

class EachSky : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachSky, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

// The flux of the disc is what the air lets through of 133.1 klx, at any size.
TEST_P(EachSky, TheSunHasItsFluxAtAnySize) {
  struct Case {
    double elevation, radius;
    int size;
  };
  for (const auto& [elevation, radius, size] : {Case{50, 0.2666, 16}, {50, 3, 1}, {0, 3, 16}}) {
    SCOPED_TRACE(radius);
    Atmosphere a = sun_at(elevation, 40);
    a.radius_degrees = radius, a.scattering = Scattering::single;
    const Daylight with = generate(a, GetParam(), size);
    a.disc = false;
    const Daylight without = generate(a, GetParam(), size);
    const double flux = luminance(measure(with.map).flux - measure(without.map).flux);
    // Rays of a disc that is 3 degrees wide leave the normal by up to 0.14%. Red beyond Rec.709 is clamped.
    EXPECT_NEAR(flux, with.sun_normal,
                (elevation > 0 ? 2e-3 : 1e-2) * with.sun_normal + 2e-7 * luminance(measure(with.map).flux));
    EXPECT_EQ(with.sun_normal, without.sun_normal);
  }
}

TEST_P(EachSky, AFloorReceivesWhatIsReported) {
  const Daylight d = generate(sun_at(50), GetParam(), 200);
  const double lux = luminance(irradiance_of_floor(d.map.base()));
  // The sun lies within one texel and counts from its middle: half a texel of 1.8 degrees moves a cosine by 1.3%.
  EXPECT_NEAR(lux / (d.sun_horizontal + d.sky_horizontal), 1, 0.013);
}

TEST(Atmosphere, SunlightOutsideTheAirIsThatOfTheSun) {
  // Darula, Kittler and Gueymard 2005: 133.3 klx, by slightly other spectra from 133.1 to 134.1.
  const Flux rgb = air::to_rgb(air::sun_irradiance());
  EXPECT_NEAR(luminance(rgb), 133.4e3, 1.2e3);
  // CIE x and y near those of 5800 K.
  const Flux xyz = to_xyz(rec709) * rgb;
  const double sum = xyz.x + xyz.y + xyz.z;
  EXPECT_NEAR(xyz.x / sum, 0.3226, 0.004);
  EXPECT_NEAR(xyz.y / sum, 0.3325, 0.004);
}

// IES clear sky (IESNA RP-21 1984): sun 127.5 exp(-0.21 / sin) klx, sky 0.8 + 15.5 sqrt(sin) klx.
TEST(Atmosphere, DaylightIsThatOfAClearDay) {
  for (const double elevation : {20.0, 40.0, 60.0}) {
    const Daylight d = generate(sun_at(elevation), Projection::latlong, 8);
    const double sine = std::sin(elevation * degree);
    EXPECT_NEAR(d.sun_normal / (127.5e3 * std::exp(-0.21 / sine)), 1, 0.15) << elevation;
    EXPECT_NEAR(d.sky_horizontal / (800 + 15500 * std::sqrt(sine)), 1, 0.4) << elevation;
  }
  const Daylight noon = generate(sun_at(65), Projection::latlong, 8);
  EXPECT_NEAR(noon.sun_horizontal + noon.sky_horizontal, 105e3, 10e3);
}

// The darkest twilight in which one reads is the civil one: 3.4 lux at -6 degrees (Seidelmann 1992, table 9.22).
TEST(Atmosphere, TwilightFadesToNight) {
  double last = 1e9;
  for (const double elevation : {5.0, 0.0, -6.0, -12.0, -90.0}) {
    const Daylight d = generate(sun_at(elevation), Projection::cube, 16);
    EXPECT_LT(d.sky_horizontal, last) << elevation;
    if (elevation == -6) {
      EXPECT_NEAR(std::log10(d.sky_horizontal / 3.4), 0, 0.4);
      EXPECT_EQ(d.sun_normal, 0);
    }
    last = d.sky_horizontal + 1e-12;
    EXPECT_EQ(find_flaws(d.map.base()).count(), 0) << elevation;
  }
}

TEST(Atmosphere, ALowSunIsRedAndAHighSkyBlue) {
  const auto colour = [](double elevation) {
    Atmosphere a = sun_at(elevation);
    const Flux with = measure(generate(a, Projection::latlong, 16).map).flux;
    a.disc = false;
    const EnvironmentMap sky = generate(a, Projection::latlong, 16).map;
    const Flux sun = with - measure(sky).flux;
    const Colour zenith = EnvironmentLookup(sky)(Direction(0, 1, 0));
    EXPECT_GT(zenith.z, zenith.x);
    return sun.z / sun.x;
  };
  EXPECT_GT(colour(60), 0.5);
  EXPECT_LT(colour(3), 0.2);
}

TEST(Atmosphere, TheSkyIsSymmetricAboutTheSunsMeridian) {
  const EnvironmentMap map = generate(sun_at(15), Projection::latlong, 64).map;
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const Colour a = *map.base().texel(0, i, j), b = *map.base().texel(0, 127 - i, j);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5 * a[c]) << i << "," << j;
    }
}

// The texel table against rays.
TEST(Atmosphere, TexelsAreRadianceAtTheirCentres) {
  for (const double elevation : {60.0, 5.0, -3.0}) {
    Atmosphere a = sun_at(elevation);
    a.disc = false;
    const EnvironmentMap map = generate(a, Projection::latlong, 90).map;
    const air::Air air = model(a.turbidity, elevation * degree, true);
    double most = 0;
    for (int j = 0; j < 45; ++j)
      for (int i = 0; i < 180; i += 7) {
        Direction d;
        texel_directions(Projection::latlong, 90, 0, j, i, std::span(&d, 1));
        const double nu = glm::dot(d, a.sun);
        air::Scattered s = air.scattered({1000 * earth, d.y, a.sun.y, nu});
        for (int b = 0; b < air::bands; ++b)
          s.even[b] += air::sun_irradiance()[b] * (rayleigh(nu) * s.molecules[b] + cornette_shanks(nu) * s.haze[b]);
        const double wanted = luminance(air::to_rgb(s.even));
        most = std::max(most, std::abs(luminance(Flux(*map.base().texel(0, i, j))) / wanted - 1));
      }
    EXPECT_LT(most, elevation > 0 ? 2e-2 : 6e-2) << elevation;
  }
}

// Hestroffer and Magnan 1998: at 550 nm the middle of the disc is 1 + 0.508 / 2 times its mean.
TEST(Atmosphere, TheDiscIsDarkerAtItsLimb) {
  Atmosphere a = sun_at(90);
  a.radius_degrees = 10;
  const EnvironmentMap map = generate(a, Projection::angular, 720).map;  // Half a degree a texel.
  const Daylight day = generate(a, Projection::angular, 16);
  const double mean = day.sun_normal / (2 * pi * (1 - std::cos(10 * degree)));
  a.disc = false;
  const EnvironmentMap sky = generate(a, Projection::angular, 720).map;
  const auto disc = [&](const Direction& d) {
    return luminance(Flux(EnvironmentLookup(map)(d)) - Flux(EnvironmentLookup(sky)(d)));
  };
  const double middle = disc({0, 1, 0}), limb = disc(at_angles(80.6 * degree, 0));
  EXPECT_NEAR(middle / mean, 1.254, 0.02);
  EXPECT_LT(limb / mean, 0.8);
}

}  // namespace
}  // namespace envmap::atmosphere_test

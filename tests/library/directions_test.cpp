// Directions of any length are the same direction, in every function that takes one.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "envmap/envmap.h"

namespace directions_test {
namespace {

using namespace envmap;

const EnvironmentMap& map() {
  static const EnvironmentMap made = generate(Gradient{}, Projection::latlong, 16);
  return made;
}

Harmonics series() { return project(map(), 3); }

// A function of a direction, as numbers.
struct Call {
  std::string name;
  std::function<std::vector<double>(const Direction&)> call;
};

std::vector<double> numbers(const Flux& f) { return {f.x, f.y, f.z}; }
std::vector<double> numbers(const Direction& d) { return {d.x, d.y, d.z}; }
std::vector<double> numbers(const EnvironmentMap& m) { return numbers(flux(m.base())); }
std::vector<double> numbers(const Location<double>& at) { return {double(at.face), at.u, at.v}; }

std::vector<Call> calls() {
  std::vector<Call> all{
      {"Sun",
       [](const Direction& d) {
         return numbers(generate(Sun{.towards = d, .radius_degrees = 10}, Projection::cube, 16));
       }},
      {"Atmosphere",
       [](const Direction& d) {
         const Daylight made = generate(Atmosphere{.sun = d, .disc = false}, Projection::latlong, 4);
         return std::vector{made.sun_normal, made.sky_horizontal};
       }},
      {"irradiance", [](const Direction& d) { return numbers(irradiance(map(), d)); }},
      {"radiance_within", [](const Direction& d) { return numbers(radiance_within(map(), d, 20)); }},
      {"evaluate", [](const Direction& d) { return numbers(evaluate(series(), d)); }},
      {"harmonics_at",
       [](const Direction& d) {
         std::vector<double> out(16);
         harmonics_at(3, d, out);
         return out;
       }},
      {"real_harmonic", [](const Direction& d) { return std::vector{real_harmonic(3, 2, d)}; }},
      {"upright_about", [](const Direction& d) { return numbers(upright_about(d)[0]); }},
      {"angle_between", [](const Direction& d) { return std::vector{angle_between(d, Direction(0, 3, 0))}; }},
      {"BallCamera", [](const Direction& d) { return numbers(BallCamera{4}.seen_from_afar(d)); }},
      {"photograph",
       [](const Direction& d) {
         const Colour middle = photograph(map().clone(), {.width = 3, .height = 3, .towards = d})[4];
         return std::vector<double>{middle.x, middle.y, middle.z};
       }},
  };
  for (const Projection p : all_projections)
    all.push_back({std::string("locate ") + name(p), [p](const Direction& d) { return numbers(locate(p, d)); }});
  return all;
}

TEST(Directions, OfAnyLengthAreTheSame) {
  const Direction unit_vector = Direction(1, 2, 3) / std::sqrt(14.0);
  for (const Call& c : calls()) {
    const std::vector<double> wanted = c.call(unit_vector);
    for (const Direction& d : {Direction(1, 2, 3), 0.1 * unit_vector, 1e-200 * unit_vector, 1e200 * unit_vector}) {
      const std::vector<double> found = c.call(d);
      ASSERT_EQ(found.size(), wanted.size());
      for (std::size_t k = 0; k < wanted.size(); ++k)
        EXPECT_NEAR(found[k], wanted[k], 1e-6 * std::abs(wanted[k]) + 1e-12) << c.name << " " << d.x;
    }
  }
}

TEST(Directions, WithoutALengthAreUsageErrors) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Call& c : calls())
    for (const Direction& d : {Direction(0), Direction(nan, 0, 1), Direction(0, inf, 0), Direction(nan)}) {
      try {
        (void)c.call(d);
        ADD_FAILURE() << c.name << ": no error";
      } catch (const UsageError& e) {
        EXPECT_NE(std::string(e.what()).find(" must be a finite direction other than 0, not ("), std::string::npos)
            << e.what();
      }
    }
}

// The flux of a sun is known: its solid angle x radiance.
TEST(Directions, OfASunLeaveItsFlux) {
  const Sky black{.zenith = Rgb<double>(0), .ground = Rgb<double>(0)};
  const Sun sun{.towards = {1, 2, 3}, .radius_degrees = 2, .radiance = Rgb<double>(1e4), .sky = black};
  const double wanted = 2 * pi * (1 - std::cos(2 * pi / 180)) * 1e4;
  EXPECT_NEAR(flux(generate(sun, Projection::latlong, 64).base()).x / wanted, 1, 2e-3);
}

}  // namespace
}  // namespace directions_test

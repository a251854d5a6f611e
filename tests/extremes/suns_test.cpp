// A sun in one texel, of 1e4 to almost the largest float, through every operation. Each bound is derived beside it.
#include "suns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/operate/convert.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/levels.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/prefilter.h"

namespace envmap::suns_test {
namespace {

using extremes::for_each_sun;

constexpr double half_ulp = 0x1p-24;  // Of a float, relative.

double solid_angle(const Level& level, const Texel& at) {
  std::vector<double> row(std::size_t(level.width()));
  solid_angles(level.projection(), level.height(), at.j, row);
  return row[std::size_t(at.i)];
}

// The sum has two parts, sun x its solid angle and the rest of 4 pi; solid angles sum to 4 pi within 1e-12 (design),
// and float64 rounds each of under 400 additions by 2^-53: 1e-12 relative to the flux holds.
TEST(Suns, FluxIsThatOfTheSunAndTheRest) {
  for_each_sun(16, [](const EnvironmentMap& map, const std::string& what, const Texel& at, float sun) {
    SCOPED_TRACE(what);
    const double w = solid_angle(map.base(), at), expected = w * sun + (4 * pi - w);
    EXPECT_NEAR(flux(map.base()).x / expected, 1, 2e-12);
    const Measures m = measure(map);
    EXPECT_EQ(m.maximum.x, sun);
    EXPECT_EQ(m.brightest_texel.i, at.i);
    EXPECT_EQ(m.brightest_texel.j, at.j);
  });
}

// Each texel is a mean with weights above 0 that sum to 1, in float64, then rounded: between least and largest of what
// it covers but for half an ulp. The flux keeps to one rounding of each texel for each level that was made.
TEST(Suns, LevelsKeepFluxAndRange) {
  for_each_sun(16, [](const EnvironmentMap& map, const std::string& what, const Texel&, float sun) {
    SCOPED_TRACE(what);
    EnvironmentMap chain = map.clone();
    add_levels(chain.levels);
    for (std::size_t k = 0; k < chain.levels.size(); ++k) {
      const Level& level = chain.levels[k];
      const auto [least, most] = extremes::range(level);
      EXPECT_GE(least, 1 - 1e-6F);
      EXPECT_LE(most, sun);
      const Flux off = flux_difference(level, map.base());
      for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(off[c]), double(k) * half_ulp + 1e-12);
    }
  });
}

// Weights that are not negative and sum to 1 keep to the range of the source: nearest copies, bilinear and the means of
// it (area, trilinear, ewa) round some ten times in float32. Cubic weights reach -0.07 (Keys 1981, a = -0.5: -2/27 at
// the worst) in each axis, and what is below 0 is cut: the result is at most (1 + 2 x 2/27)^2 = 1.32 x the sun.
TEST(Suns, ConversionsKeepToTheRange) {
  for_each_sun(8, [](const EnvironmentMap& map, const std::string& what, const Texel&, float sun) {
    for (const Projection to : all_projections)
      for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::trilinear, Filter::ewa, Filter::area}) {
        SCOPED_TRACE(what + " -> " + name(to) + ", " + std::string(name(filter)));
        const EnvironmentMap made =
            convert(map, {.to = to, .size = 5, .filter = filter, .rotation = rotation(31, 17, 5)});
        const auto [least, most] = extremes::range(made.base());
        EXPECT_GE(least, 1 - 16 * half_ulp);
        EXPECT_LE(most / sun, 1 + 16 * half_ulp);
      }
  });
}

// Interpolated at its texels' own centres a map is copied, on a rim, too, where those lie outside the disc.
TEST(Suns, SameFrameIsACopy) {
  for_each_sun(8, [](const EnvironmentMap& map, const std::string& what, const Texel&, float) {
    SCOPED_TRACE(what);
    for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::bicubic})
      EXPECT_EQ(compare(convert(map, {.to = map.frame(), .size = 8, .filter = filter}).base(), map.base()).maximum, 0);
  });
}

// Against itself 0; against a sun brighter by a millionth, max is a millionth there, rms that x the sun's share.
TEST(Suns, CompareSeesAMillionthOfTheSun) {
  for_each_sun(16, [](const EnvironmentMap& map, const std::string& what, const Texel& at, float sun) {
    SCOPED_TRACE(what);
    EXPECT_EQ(compare(map.base(), map.base()).rms, 0);
    EnvironmentMap other = map.clone();
    Colour& c = *other.base().texel(at.face, at.i, at.j);
    c.x *= 1 + 1e-6F;
    const double step = (double(c.x) - sun) / sun;
    const Difference d = compare(other.base(), map.base());
    EXPECT_NEAR(d.maximum, step, 1e-12);
    EXPECT_EQ(d.worst.i, at.i);
    const double w = solid_angle(map.base(), at), s = sun;
    EXPECT_NEAR(d.flux.x, step * s * w / (s * w + 4 * pi - w), 1e-9 * step + 1e-12);
    EXPECT_TRUE(std::isfinite(d.rms));  // Squares of 3e38 are 9e76: far from float64's end.
  });
}

// Y_00 is constant, 1 / sqrt(4 pi): its coefficient is the flux over that. All others are at most flux x max |Y|, which
// is sqrt((2 l + 1) / (4 pi)) by the addition theorem (Unsoeld 1927). The integral over a texel is right to 1e-6.
TEST(Suns, Harmonics) {
  for_each_sun(8, [](const EnvironmentMap& map, const std::string& what, const Texel&, float) {
    SCOPED_TRACE(what);
    const Harmonics h = project(map, 4);
    const Flux total = flux(map.base());
    const double allowed = 1e-6 + extremes::flux_error_of_cube(map.projection());
    EXPECT_NEAR(h.coefficients[0].x / total.x * std::sqrt(4 * pi), 1, allowed);
    for (int l = 0; l <= 4; ++l)
      for (int m = -l; m <= l; ++m)
        EXPECT_LE(std::abs(h.coefficients[std::size_t(l * (l + 1) + m)].x) / total.x,
                  std::sqrt((2 * l + 1) / (4 * pi)) * (1 + allowed));
  });
}

// Lobes are not negative and have weight 1: the result keeps to the range of the source, but for the method's own
// error, 1e-3 at most, relative to the texel (that of the mean where the texel is below a thousandth of it).
TEST(Suns, PrefiltersKeepToTheRange) {
  for (const auto& [shape, parameter] :
       {std::pair(LobeShape::diffuse, unset_parameter), {LobeShape::phong, 50.0}, {LobeShape::ggx, 0.5}})
    for_each_sun(6, [&](const EnvironmentMap& map, const std::string& what, const Texel&, float sun) {
      SCOPED_TRACE(what + ", " + std::string(lobe_shape_names[std::size_t(shape)]));
      const Prefiltered made = Prefilterer(map).make({.lobe = Lobe(shape, parameter), .size = 2});
      EXPECT_LE(made.error, 1e-3);
      const auto [least, most] = extremes::range(made.map.base());
      EXPECT_GE(least, 1 - 1e-3 - 1e-6 * mean_radiance(map.base()));
      EXPECT_LE(most / sun, 1 + 1e-3);
    });
}

// Phong's lobe of exponent 0 is even over the half sphere, k = 1 / (2 pi): what two opposite texels show sums to the
// whole flux / (2 pi), wherever the horizon cuts the sun. Texels are floats: half an ulp each, beside the sum's 1e-7.
// Maps that are first made a cube have another flux, but the same for all texels.
TEST(Suns, OppositeHalvesSumToTheFlux) {
  for_each_sun(8, [](const EnvironmentMap& map, const std::string& what, const Texel&, float) {
    SCOPED_TRACE(what);
    const int n = 2;
    const Prefiltered made = Prefilterer(map).make({.lobe = Lobe::phong(0), .size = n, .method = Method::exact});
    const auto sum = [&](int i, int j) {  // On +X and -X: (1,t,s) and (-1,-t,-s).
      return double{made.map.base().texel(0, i, j)->x} + double{made.map.base().texel(1, i, n - 1 - j)->x};
    };
    const double texels = flux(map.base()).x / (2 * pi), error = extremes::flux_error_of_cube(map.projection());
    const double whole = error > 0 ? sum(0, 0) : texels;
    EXPECT_NEAR(whole / texels, 1, 1e-6 + error);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) EXPECT_NEAR(sum(i, j) / whole, 1, 1e-6);
  });
}

// A sun far smaller than a texel: its flux, 2 pi (1 - cos radius) x radiance, is kept at any size; 1 - cos loses all
// digits at 1e-9 degrees (it is 0 in float64), 2 sin^2(r / 2) none.
TEST(Suns, SmallSunsKeepTheirFlux) {
  for (const double degrees : {1e-3, 1e-6})
    for (const Direction& towards : {Direction(0, 1, 0), Direction(0, 0, -1), glm::normalize(Direction(1, 1, 1))})
      for (const Projection p : {Projection::latlong, Projection::cube, Projection::sphere}) {
        const double radius = degrees * pi / 180, cap = 4 * pi * std::pow(std::sin(radius / 2), 2), radiance = 1e30;
        Sun sun;
        sun.towards = towards, sun.radius_degrees = degrees, sun.radiance = Rgb<double>(radiance),
        sun.sky = {Rgb<double>(0), Rgb<double>(0)};
        EXPECT_NEAR(flux(generate(sun, p, 16).base()).x / (cap * radiance), 1, 1e-5)
            << name(p) << ", " << degrees << " degrees, towards " << towards.x << " " << towards.y << " " << towards.z;
      }
}

}  // namespace
}  // namespace envmap::suns_test

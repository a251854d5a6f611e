// Conversions: every pair of projections against the plain formulae, constants, symmetry, flux.
#include "envmap/operate/convert.h"

#include <gtest/gtest.h>

#include <cstring>

#include "envmap/base/error.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/lookup.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/matching_size.h"
#include "envmap/projection/visit.h"
#include "formulae.h"

namespace envmap::convert_test {
namespace {

// A map of directions made from the plain formulae alone; where the formulae say nothing (outside the disc) it is
// poisoned: no filter may see it.
EnvironmentMap directions_map(Projection p, int size) {
  EnvironmentMap map;
  map.levels.emplace_back(p, size);
  Level& level = map.base();
  for (int f = 0; f < level.faces(); ++f)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < level.width(); ++i)
        *level.texel(f, i, j) =
            formulae::in_image(p, size, i, j)
                ? Colour(0.5 + 0.5 * formulae::rounded(
                                         formulae::direction(p, f, (i + 0.5L) / level.width(), (j + 0.5L) / size)))
                : Colour(1e30F);
  return map;
}

// f(face, i, j, direction) for the texels whose centres the formulae know.
template <class F>
void for_texels(const Level& level, F&& f) {
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i)
        if (formulae::in_image(level.projection(), level.height(), i, j))
          f(face, i, j,
            formulae::rounded(formulae::direction(level.projection(), face, (i + 0.5L) / level.width(),
                                                  (j + 0.5L) / level.height())));
}

Direction decoded(const Colour& c) { return glm::normalize(2.0 * Direction(c) - 1.0); }

std::string pair_name(const testing::TestParamInfo<std::tuple<Projection, Projection>>& p) {
  return identifier(std::get<0>(p.param)) + "_to_" + identifier(std::get<1>(p.param));
}

class EachPair : public testing::TestWithParam<std::tuple<Projection, Projection>> {
 protected:
  Projection from_ = std::get<0>(GetParam()), to_ = std::get<1>(GetParam());
};
INSTANTIATE_TEST_SUITE_P(, EachPair,
                         testing::Combine(testing::ValuesIn(all_projections), testing::ValuesIn(all_projections)),
                         pair_name);

double worst_angle_in_texels(Projection from, Projection to, int height, Filter filter) {
  EnvironmentMap source = directions_map(from, matching_size(Projection::latlong, height, from));
  const EnvironmentMap result = convert(source, {.to = to, .filter = filter});
  double worst = 0;
  for_texels(result.base(), [&](int f, int i, int j, const Direction& d) {
    worst = std::max(worst, angle_between(decoded(*result.base().texel(f, i, j)), d));
  });
  return worst / (pi / height);
}

// Interpolation cuts the corner at a crease, by a quarter of a texel times the jump of the slope there: of equal-area
// maps up to 4 rad per unit of t where the diamond meets an axis, so 2 / pi of a texel,
// and half of that of octahedral maps.
double cut_at_creases(Projection from) {
  return from == Projection::equal_area ? 2 / pi : from == Projection::octahedral ? 1 / pi : 0;
}

TEST_P(EachPair, BilinearKeepsEveryDirectionWithinATenthOfATexel) {
  EXPECT_LT(worst_angle_in_texels(from_, to_, 128, Filter::bilinear), 0.1 + cut_at_creases(from_));
}

TEST_P(EachPair, NearestKeepsDirectionsWithinItsTexel) {
  if (from_ == Projection::sphere) GTEST_SKIP() << "texels at the rim of a sphere map span tens of degrees";
  // Half the diagonal of a texel; those of a paraboloid's or cube's middle are 4 / pi wider than the mean, and the
  // widest of an octahedral map 2 x 3.07 / pi.
  const double wider = is_octahedral(from_) ? 6.14 / pi : 4 / pi;
  EXPECT_LT(worst_angle_in_texels(from_, to_, 64, Filter::nearest), 0.5 * std::numbers::sqrt2 * wider + 0.05);
}

TEST_P(EachPair, ConstantStaysConstant) {
  for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::area})
    for (const int size : {1, 2, 3, 16}) {
      EnvironmentMap source = generate(Constant{}, from_, size);
      const EnvironmentMap result = convert(source, {.to = to_, .size = size + 3, .filter = filter});
      for (int f = 0; f < result.base().faces(); ++f)
        for (int j = 0; j < result.base().height(); ++j) {
          const Columns in = columns(to_, result.base().height(), j);
          for (int i = 0; i < result.base().width(); ++i) {
            const bool weighs = i >= in.first && i < in.end;
            for (int c = 0; c < 3; ++c) ASSERT_NEAR((*result.base().texel(f, i, j))[c], weighs ? 1 : 0, 1e-6);
          }
        }
    }
}

TEST_P(EachPair, FluxOfASmoothEnvironment) {
  // 1 + x/2 + y z: the harmonics beyond the constant have no flux.
  EnvironmentMap source;
  source.levels.emplace_back(from_, matching_size(Projection::latlong, 96, from_));
  for_texels(source.base(), [&](int f, int i, int j, const Direction& d) {
    *source.base().texel(f, i, j) = Colour(float(1 + 0.5 * d.x + d.y * d.z));
  });
  // (The same texels are copied, and the rim of this source is empty.)
  if (from_ != to_) {
    EXPECT_NEAR(mean_radiance(convert(source, {.to = to_, .filter = Filter::bilinear}).base()), 1, 4e-4);
  }
  EXPECT_NEAR(mean_radiance(convert(source, {.to = to_, .filter = Filter::area, .area_error = 1e-3}).base()), 1, 3e-4);
}

// A turn of the environment moves what is seen; the other projections only have to agree with the formula.
TEST_P(EachPair, RotationMovesRadianceFromDToRotationTimesD) {
  const int height = 64;
  EnvironmentMap source = directions_map(from_, matching_size(Projection::latlong, height, from_));
  const Rotation turn = rotation(30, -50, 110);
  const EnvironmentMap result = convert(source, {.to = to_, .filter = Filter::bilinear, .rotation = turn});
  double worst = 0;
  for_texels(result.base(), [&](int f, int i, int j, const Direction& d) {
    worst = std::max(worst, angle_between(turn * decoded(*result.base().texel(f, i, j)), d));
  });
  EXPECT_LT(worst / (pi / height), 0.15 + cut_at_creases(from_));
}

// The largest step between neighbours across a seam is no larger than inside.
TEST(Seams, CubeEdgesAndLatlongSeam) {
  EnvironmentMap source = generate(Harmonic{.degree = 3, .order = 2}, Projection::latlong, 128);
  EnvironmentMap cube = convert(source, {.to = Projection::cube});
  // Walk from texel to texel in space: fine steps over edges, radiance by nearest texel, against steps within a face.
  const Level& level = cube.base();
  double inside = 0, across = 0;
  const auto value = [&](const Direction& d, int& face) {
    const auto at = Cube::locate(d);
    face = at.face;
    return double(level.texel(at.face, std::min(63, int(at.u * 64)), std::min(63, int(at.v * 64)))->x);
  };
  for (int turn = 0; turn < 500; ++turn) {
    const Rotation r = rotation(turn * 0.73, turn * 1.1, turn * 2.3);
    double last = -1;
    int last_face = 0;
    for (int k = 0; k <= 4000; ++k) {
      const double a = 2 * pi * k / 4000;
      int face = 0;
      const double v = value(r * Direction(std::cos(a), std::sin(a), 0), face);
      if (last >= 0)
        (face == last_face ? inside : across) = std::max(face == last_face ? inside : across, std::abs(v - last));
      last = v;
      last_face = face;
    }
  }
  EXPECT_GT(across, 0);
  EXPECT_LT(across, 1.05 * inside);

  const EnvironmentMap latlong = convert(cube, {.to = Projection::latlong});
  double seam = 0, within = 0;
  for (int j = 0; j < 128; ++j)
    for (int i = 0; i < 256; ++i) {
      const double step = std::abs(latlong.base().texel(0, i, j)->x - latlong.base().texel(0, (i + 1) % 256, j)->x);
      (i == 255 ? seam : within) = std::max(i == 255 ? seam : within, step);
    }
  EXPECT_LT(seam, within);
}

TEST(Forward, ChoosesTheCentreOfTheImage) {
  EnvironmentMap cube = directions_map(Projection::cube, 64);
  const std::pair<Forward, Direction> centres[] = {{Forward::plus_z, {0, 0, 1}},
                                                   {Forward::minus_z, {0, 0, -1}},
                                                   {Forward::plus_x, {1, 0, 0}},
                                                   {Forward::minus_x, {-1, 0, 0}}};
  for (const Projection to : {Projection::latlong, Projection::angular})
    for (const auto& [forward, axis] : centres) {
      const EnvironmentMap map = convert(cube, {.to = {to, forward}, .size = 129});
      const int middle = map.base().width() / 2;
      EXPECT_LT(angle_between(decoded(*map.base().texel(0, middle, 64)), axis), 0.02);
      // Up stays up, and nothing is mirrored: left of the centre lies up x forward.
      EXPECT_GT(decoded(*map.base().texel(0, middle, 50)).y, 0.1);
      EXPECT_GT(glm::dot(decoded(*map.base().texel(0, middle - 14, 64)), glm::cross(Direction(0, 1, 0), axis)), 0.1);
    }
}

TEST(Forward, AMapReadWithOneAxisAndWrittenWithItIsUnchanged) {
  EnvironmentMap map = generate(Directions{}, {Projection::latlong, Forward::minus_x}, 16);
  const EnvironmentMap same = convert(map, {.to = {Projection::latlong, Forward::minus_x}});
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 32; ++i)
      EXPECT_LT(glm::length(Direction(*same.base().texel(0, i, j)) - Direction(*map.base().texel(0, i, j))), 1e-6);
}

TEST(Convert, AMapOfTheSameFrameAndSizeIsACopy) {
  for (const Projection p : all_projections) {
    EnvironmentMap map = generate(Constant{}, p, 16);
    int number = 0;
    for_texels(map.base(),
               [&](int face, int i, int j, const auto&) { *map.base().texel(face, i, j) = Colour(++number); });
    for (const std::optional<double> max_error : {std::optional<double>(), std::optional(1e-2)}) {
      const Resampler same(map, {.to = p, .max_error = max_error});
      if (max_error) {
        EXPECT_EQ(same.choice()->trials.back().maximum, 0);
      }
      const Level level = level_of(same.rows());
      for_texels(map.base(), [&](int face, int i, int j, const auto&) {
        EXPECT_EQ(*level.texel(face, i, j), *map.base().texel(face, i, j)) << name(p) << i << ' ' << j;
      });
    }
  }
}

// A level of 45x22, as 90x45 has one, is not the grid of a map of 22 rows.
TEST(Convert, ALevelOfOddWidthIsResampled) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, 22, 45);
  for (int row = 0; row < 22; ++row)
    for (const int column : {43, 44}) *map.base().texel(0, column, row) = Colour(1);
  const EnvironmentMap out = convert(map, {.to = {Projection::latlong}, .filter = Filter::area});
  ASSERT_EQ(out.base().width(), 44);
  for (int row = 2; row < 20; ++row) {
    // Over columns of 1 / 44, lines between 0 and 1 from 42.5 / 45 to 43.5 / 45, and from 44.5 / 45 to 45.5 / 45.
    EXPECT_NEAR(out.base().texel(0, 43, row)->x, 44 * (44.5 / 45 - 43 / 44.0 + 0.75 * 0.5 / 45), 1e-5) << row;
    const double rise = 43.5 / 45 - 42 / 44.0;
    EXPECT_NEAR(out.base().texel(0, 42, row)->x, 44 * (43 / 44.0 - 43.5 / 45 + (1 - 22.5 * rise) * rise), 1e-5) << row;
  }
}

TEST(Convert, ASunOfABillionDoesNotDrownItsNeighbours) {
  EnvironmentMap source = generate(Constant{}, Projection::latlong, 32);
  *source.base().texel(0, 20, 10) = Colour(1e9F);
  const EnvironmentMap same = convert(source, {.to = Projection::latlong, .filter = Filter::bilinear});
  // At the texel's own centre, a rounding of the location leaks 1e-13 of the sun; next but one, nothing.
  EXPECT_NEAR(same.base().texel(0, 20, 10)->x / 1e9, 1, 1e-6);
  EXPECT_NEAR(same.base().texel(0, 21, 10)->x, 1, 1e-3);
  EXPECT_EQ(same.base().texel(0, 22, 10)->x, 1);
}

TEST(Convert, SubnormalRadianceStays) {
  EnvironmentMap source = generate(Constant{Direction(1e-40)}, Projection::cube, 8);
  for (const Filter filter : {Filter::bilinear, Filter::area}) {
    const EnvironmentMap map = convert(source, {.to = Projection::angular, .size = 8, .filter = filter});
    EXPECT_NEAR(map.base().texel(0, 4, 4)->x / 1e-40, 1, 1e-4);
  }
}

TEST(Convert, RadianceNextToTheLargestFloatStays) {
  constexpr float radiance = 3.3e38F;
  const EnvironmentMap source = generate(Constant{Direction(radiance)}, Projection::latlong, 64);
  for (const std::optional<Filter> filter : {std::optional<Filter>(), std::optional(Filter::bicubic)}) {
    const EnvironmentMap map = convert(source, {.to = Projection::cube, .size = 4, .filter = filter});
    for (int i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(map.base().texel(2, i, 1)->x, radiance);
  }
}

TEST(Convert, AutomaticIsAreaOnlyWhereItMinifies) {
  EnvironmentMap source = generate(Constant{}, Projection::latlong, 64);
  const Resampler same(source, {.to = Projection::cube}), coarser(source, {.to = Projection::cube, .size = 16});
  EXPECT_EQ(same.filter().filter, Filter::bilinear);
  EXPECT_EQ(same.size(), 32);
  EXPECT_EQ(coarser.filter().filter, Filter::area);
}

// Turns that take texels to texels: each bit of the source is there, at its place by the formula.
TEST(Convert, TurnsByWholeTexelsAreExactCopies) {
  EnvironmentMap latlong = generate(Directions{}, Projection::latlong, 90);
  *latlong.base().texel(0, 17, 40) = Colour(6e4F);
  for (const double degrees : {90.0, -2.0, 178.0, 360.0 * 1e6 + 4}) {
    const EnvironmentMap turned =
        convert(latlong, {.to = Projection::latlong, .max_error = 1e-2, .rotation = rotation(degrees, 0, 0)});
    const int left = int(std::lround(degrees / 2)) % 180;  // A texel spans two degrees; +X lies to the left.
    for (int j = 0; j < 90; ++j)
      for (int i = 0; i < 180; ++i)
        ASSERT_EQ(*turned.base().texel(0, i, j), *latlong.base().texel(0, (i + left + 180) % 180, j)) << degrees;
  }
  const EnvironmentMap cube = generate(Directions{}, Projection::cube, 7);
  for (const Rotation& turn : {rotation(90, 0, 0), rotation(180, 90, 0), rotation(-90, 180, 270)}) {
    const EnvironmentMap turned = convert(cube, {.to = Projection::cube, .rotation = turn});
    for_texels(turned.base(), [&](int f, int i, int j, const Direction& d) {
      const auto at = Cube::locate(glm::transpose(turn) * d);
      ASSERT_EQ(*turned.base().texel(f, i, j), *cube.base().texel(at.face, int(at.u * 7), int(at.v * 7)));
    });
  }
}

// Radiance from d comes out from d with one coordinate negated, after the rotation; twice is nothing.
TEST(Convert, MirroringNegatesAnAxis) {
  const EnvironmentMap source = generate(Directions{}, {Projection::latlong, Forward::minus_x}, 64);
  const Rotation turn = rotation(20, -30, 50);
  for (const Projection p : all_projections)
    for (const Forward forward : {Forward::plus_z, Forward::minus_z, Forward::plus_x, Forward::minus_x})
      for (const MirroredAxis axis : {MirroredAxis::x, MirroredAxis::y, MirroredAxis::z}) {
        const Frame frame(p, forward);
        const ConvertOptions how{.to = frame, .size = 8, .filter = Filter::bilinear, .rotation = turn, .mirror = axis};
        const EnvironmentMap map = convert(source, how);
        double worst = 0;
        for_texels(map.base(), [&](int f, int i, int j, const Direction& d) {
          Direction negated = image_to_world(frame.forward) * d;
          negated[int(axis) - 1] *= -1;
          const Direction expected = glm::transpose(turn) * negated;
          worst = std::max(worst, glm::length(2.0 * Direction(*map.base().texel(f, i, j)) - 1.0 - expected));
        });
        EXPECT_LT(worst, p == Projection::sphere ? 0.5 : 0.01) << name(p) << " " << int(forward) << " " << int(axis);
      }
}

// Turns by right angles and mirrors. Each texel holds a number of its own: rims and corners of discs, too.
TEST(Convert, TurnsAndMirrorsOfTheGridAreExactCopies) {
  for (const Projection p : all_projections) {
    EnvironmentMap map = blank_map(p, 8);
    float number = 0;
    for (const Texel& t : texels_of(map.base())) *map.base().texel(t.face, t.i, t.j) = Colour(++number);
    const bool disc = on_disc(p), lone = disc && p != Projection::paraboloid;
    const ConvertOptions all[] = {{.to = p, .rotation = rotation(0, 0, disc ? 90 : 180)},
                                  {.to = p, .rotation = rotation(0, lone ? 0 : 180, 180)},
                                  {.to = p, .rotation = rotation(lone ? 0 : 180, 0, disc ? -90 : 0)},
                                  {.to = p, .mirror = MirroredAxis::x},
                                  {.to = p, .mirror = MirroredAxis::y},
                                  {.to = p, .mirror = lone ? MirroredAxis::x : MirroredAxis::z}};
    for (const ConvertOptions& o : all) {
      const EnvironmentMap once = convert(map, o);
      for_texels(once.base(), [&](int f, int i, int j, Direction d) {
        if (o.mirror != MirroredAxis::none) d[int(o.mirror) - 1] *= -1;
        const Location<double> at = locate(p, glm::transpose(o.rotation) * d);
        const int width = map.base().width();
        ASSERT_EQ(*once.base().texel(f, i, j), *map.base().texel(at.face, int(at.u * width), int(at.v * 8))) << name(p);
      });
      const EnvironmentMap back = convert(once, {.to = p, .rotation = glm::transpose(o.rotation), .mirror = o.mirror});
      for (const Texel& t : texels_of(map.base()))
        ASSERT_EQ(*back.base().texel(t.face, t.i, t.j), *map.base().texel(t.face, t.i, t.j)) << name(p);
    }
  }
}

TEST(Light, AddedIsThatOfBoth) {
  EnvironmentMap sky = generate(Constant{Rgb<double>(0.25)}, {Projection::latlong, Forward::minus_z}, 32);
  const EnvironmentMap sun =
      generate(Sun{.radius_degrees = 20, .radiance = Rgb<double>(8), .sky = {Rgb<double>(0), Rgb<double>(0)}},
               Projection::cube, 64);
  const Flux expected = flux(sky.base()) + flux(sun.base());
  add_light(sky, sun);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(flux(sky.base())[c] / expected[c], 1, 2e-3);
  EXPECT_NEAR(EnvironmentLookup(sky)({0, 0, 1}).x, 8.25, 1e-3);
  EXPECT_NEAR(EnvironmentLookup(sky)({0, 0, -1}).x, 0.25, 1e-6);
}

TEST(Light, ExposureIsFitted) {
  const EnvironmentMap map = generate(Directions{}, Projection::latlong, 16);
  EnvironmentMap brighter = convert(map, {.to = Projection::latlong, .gain = 3});
  EXPECT_NEAR(best_exposure(map.base(), brighter.base()), 3, 1e-6);
  EXPECT_NEAR(best_exposure(brighter.base(), map.base()), 1 / 3.0, 1e-7);
  const EnvironmentMap black = generate(Constant{Rgb<double>(0)}, Projection::latlong, 16);
  EXPECT_EQ(best_exposure(black.base(), map.base()), 1);
  EXPECT_EQ(best_exposure(map.base(), black.base()), 1);
  EXPECT_THROW((void)best_exposure(map.base(), Level(Projection::cube, 4)), UsageError);
}

TEST(Convert, GainIsAPlainFactor) {
  EnvironmentMap source = generate(Constant{Direction(0.25)}, Projection::latlong, 4);
  EXPECT_EQ(convert(source, {.to = Projection::cube, .gain = 8}).base().texel(0, 0, 0)->x, 2);
}

}  // namespace
}  // namespace envmap::convert_test

// Radiance at the ends of what floats hold, and lobes at the ends of their parameters.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/io/read.h"
#include "envmap/io/write.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/levels.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/prefilter.h"
#include "suns.h"

namespace envmap::radiance_test {
namespace {

EnvironmentMap constant(Projection p, int size, float value) {
  EnvironmentMap map = blank_map(p, size);
  for (const Texel& t : texels_of(map.base())) *map.base().texel(t.face, t.i, t.j) = Colour(value);
  return map;
}

// ---- nothing, and next to nothing -----------------------------------------------------------------------------------

TEST(Black, StaysBlack) {
  for (const Projection from : all_projections) {
    EnvironmentMap map = constant(from, 8, 0);
    for (const Projection to : all_projections)
      for (const FilterInfo& filter : filters())
        EXPECT_EQ(extremes::range(convert(map, {.to = to, .size = 5, .filter = filter.filter}).base()),
                  std::pair(0.0F, 0.0F));
    for (const Method method : {Method::automatic, Method::exact, Method::treecode})
      EXPECT_EQ(extremes::range(Prefilterer(map).make({.size = 2, .method = method}).map.base()),
                std::pair(0.0F, 0.0F));
    for (const Flux& c : project(map, 3).coefficients) EXPECT_EQ(c, Flux(0));
    EXPECT_EQ(compare(map.base(), map.base()).maximum, 0);
    add_levels(map.levels);
    EXPECT_EQ(extremes::range(map.levels.back()), std::pair(0.0F, 0.0F));
    const Measures m = measure(map);
    EXPECT_EQ(m.brightest, 0);
  }
}

// Subnormal floats are multiples of 2^-149: a mean in float64 is rounded to the nearest of them, in float32 every step
// is. A dozen steps of bilinear weights: 12 x 2^-149. Flushed to 0, as fast-math would have it, the map would be black.
TEST(Subnormal, ConstantsStay) {
  const float value = 1e-40F;
  const double step = std::numeric_limits<float>::denorm_min();
  for (const Projection from : all_projections) {
    SCOPED_TRACE(name(from));
    EnvironmentMap map = constant(from, 8, value);
    EXPECT_NEAR(flux(map.base()).x / (4 * pi * double{value}), 1, 1e-12);
    for (const Projection to : all_projections)
      for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::trilinear, Filter::ewa, Filter::area}) {
        const auto [least, most] = extremes::range(convert(map, {.to = to, .size = 5, .filter = filter}).base());
        EXPECT_GE(least, value - 12 * step) << name(to) << ", " << name(filter);
        EXPECT_LE(most, value + 12 * step) << name(to) << ", " << name(filter);
      }
    const auto [least, most] = extremes::range(Prefilterer(map).make({.size = 2}).map.base());
    EXPECT_NEAR(least / value, 1, 1e-3);
    EXPECT_NEAR(most / value, 1, 1e-3);
    EXPECT_NEAR(project(map, 0).coefficients[0].x / (double{value} * std::sqrt(4 * pi)), 1, 1e-6);
    add_levels(map.levels);
    EXPECT_EQ(extremes::range(map.levels.back()), std::pair(value, value));
  }
}

// ---- files ----------------------------------------------------------------------------------------------------------

class Files : public testing::Test {
 protected:
  Files() { std::filesystem::create_directories(folder_); }
  ~Files() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("envmap_extremes_" + std::to_string(::getpid()));
};

// Formats of floats hold every float; others refuse what they would change by more than their rounding.
TEST_F(Files, HoldEveryFloatOrRefuse) {
  EnvironmentMap map = constant(Projection::latlong, 8, 1);
  const float values[] = {std::numeric_limits<float>::max(),
                          std::numeric_limits<float>::denorm_min(),
                          1e-40F,
                          1e-30F,
                          0,
                          1e9F,
                          65504,
                          1e-8F};
  for (int k = 0; k < 8; ++k) *map.base().texel(0, k, 4) = Colour(values[k], values[7 - k], 0);
  for (const char* name : {"a.exr", "a.pfm", "a.tif", "a.ktx2", "a.ktx", "a.dds"}) {
    write(path(name), rows_of(map), {.depth = Depth::single});
    const Source back = read(path(name), {.projection = Projection::latlong});
    EXPECT_EQ(compare(back.map.base(), map.base()).maximum, 0) << name;
    for (int k = 0; k < 8; ++k) EXPECT_EQ(back.map.base().texel(0, k, 4)->x, values[k]) << name;
  }
  for (const auto& [name, depth] :
       {std::pair("h.exr", Depth::half), {"h.ktx2", Depth::rgb9e5}, {"h.dds", Depth::half}, {"h.png", Depth::uint16}}) {
    EXPECT_THROW(write(path(name), rows_of(map), {.depth = depth}), OutputError) << name;
    EXPECT_FALSE(std::filesystem::exists(path(name)));
    const Written cut = write(path(name), rows_of(map), {.depth = depth, .clamp = true});
    EXPECT_NEAR(cut.flux_lost, 1, 1e-6);  // Nearly all flux is in the texel of 3.4e38.
  }
}

// ---- lobes ----------------------------------------------------------------------------------------------------------

// White stays white (the normalisation of each lobe), from the half sphere to lobes of 1e-4 rad: exact sums to 1e-7,
// and the file's float rounds by 2^-24.
TEST(Lobes, WhiteStaysWhiteAtEveryWidth) {
  for (const Projection from : all_projections) {
    const EnvironmentMap white = constant(from, 8, 1);
    const Prefilterer source(white);
    for (const auto& [shape, parameter] : {std::pair(LobeShape::phong, 0.0),
                                           {LobeShape::phong, 1e-9},
                                           {LobeShape::phong, 1.0},
                                           {LobeShape::phong, 1e3},
                                           {LobeShape::phong, 1e8},
                                           {LobeShape::ggx, 0.0},
                                           {LobeShape::ggx, 1e-3},
                                           {LobeShape::ggx, 0.5},
                                           {LobeShape::ggx, 1.0},
                                           {LobeShape::diffuse, unset_parameter}}) {
      const Prefiltered made = source.make({.lobe = Lobe(shape, parameter), .size = 2, .method = Method::exact});
      const auto [least, most] = extremes::range(made.map.base());
      EXPECT_NEAR(least, 1, 1e-6) << name(from) << " " << parameter;
      EXPECT_NEAR(most, 1, 1e-6) << name(from) << " " << parameter;
    }
  }
}

// A lobe narrower than a texel lies inside one where it looks at its middle: the map itself, to the tail beyond half a
// texel. cos^1e8 at 0.04 rad is e^(-1e8 x 0.0008): nothing. (cos(x) = 1 - 8e-4 exactly would be needed to see it; x^2 /
// 2 from the angle is what does not cancel: cos of 1e-5 is 1 - 5e-11, of which float64 keeps 6 digits.)
TEST(Lobes, OfExponent1e8IsAMirror) {
  const int n = 8;  // Texels of 0.2 rad; odd multiples of their halves look at middles.
  for (const Method method : {Method::exact, Method::automatic}) {
    const EnvironmentMap map = generate(Directions{}, Projection::cube, n);
    const Prefiltered made = Prefilterer(map).make({.lobe = Lobe::phong(1e8), .size = n, .method = method});
    EXPECT_LE(made.error, 1e-3);
    EXPECT_LT(compare(made.map.base(), map.base()).maximum, method == Method::exact ? 1e-6 : 1e-3);
  }
}

}  // namespace
}  // namespace envmap::radiance_test

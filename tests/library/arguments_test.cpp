// Numbers that are no enumerators, spans that are too short, pictures without rows: errors of the library.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "envmap/envmap.h"

namespace arguments_test {
namespace {

using namespace envmap;

const EnvironmentMap& sky(Projection p = Projection::cube) {
  static const EnvironmentMap cube = generate(Sky{}, Projection::cube, 4),
                              latlong = generate(Sky{}, Projection::latlong, 8);
  return p == Projection::cube ? cube : latlong;
}

void refuses(const std::string& words, const std::function<void()>& call) {
  try {
    call();
    ADD_FAILURE() << "no error: " << words;
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << words << ": another error: " << e.what();
  }
}

// Calls with a value that is none of the type, above and below.
template <class Enum, class Call>
void refuse_others(const std::string& field, const Call& call) {
  for (const int number : {99, -1, int(enumerators<Enum>)})
    refuses(field + " must be an enumerator, 0 to " + std::to_string(enumerators<Enum> - 1) + ", not " +
                std::to_string(number),
            [&] { call(static_cast<Enum>(number)); });
}

TEST(Enumerators, OfMapsAndOperations) {
  const Prefilterer source(sky());
  refuse_others<Projection>("projection", [](Projection p) { (void)Level(p, 4); });
  refuse_others<Projection>("projection", [](Projection p) { (void)name(p); });
  refuse_others<Projection>("projection", [](Projection p) { (void)convert(sky(), {.to = p}); });
  refuse_others<Projection>("to", [&](Projection p) { (void)source.make({.to = p, .size = 4}); });
  refuse_others<Projection>("projection", [](Projection p) { (void)locate(p, Direction(0, 0, 1)); });
  refuse_others<Forward>("forward", [](Forward f) { (void)Frame(Projection::latlong, f); });
  refuse_others<Forward>("forward", [](Forward f) { (void)image_to_world(f); });
  refuse_others<Forward>("forward", [&](Forward f) { (void)source.make({.size = 4, .forward = f}); });
  refuse_others<Forward>("forward", [](Forward f) {
    EnvironmentMap map = sky(Projection::latlong).clone();
    map.forward = f;
    (void)encode(map, {.format = "exr"});
  });
  refuse_others<Forward>("forward", [](Forward f) {
    EnvironmentMap map = sky(Projection::latlong).clone();
    map.forward = f;
    (void)convert(map, {});
  });
  refuse_others<MirroredAxis>("mirror", [](MirroredAxis m) { (void)convert(sky(), {.mirror = m}); });
  refuse_others<Filter>("filter", [](Filter f) { (void)convert(sky(), {.filter = f}); });
  refuse_others<Filter>("filter", [](Filter f) { (void)name(f); });
  refuse_others<AreaSides>("area_sides",
                           [](AreaSides s) { (void)convert(sky(), {.filter = Filter::area, .area_sides = s}); });
  refuse_others<Weights>("weights", [](Weights w) {
    EnvironmentMap map = sky().clone();
    add_levels(map, w);
  });
  refuse_others<Weights>("weights", [](Weights w) { (void)half_level(sky().base(), w); });
  refuse_others<Scattering>("scattering",
                            [](Scattering s) { (void)generate(Atmosphere{.scattering = s}, Projection::cube, 4); });
  refuse_others<CameraModel>("lens", [](CameraModel m) { (void)photograph(sky().clone(), {.lens = m}); });
  refuse_others<Filter>("filter", [](Filter f) { (void)photograph(sky().clone(), {.filter = f}); });
  refuse_others<LobeShape>("shape", [](LobeShape s) { (void)Lobe(s); });
  refuse_others<Method>("method", [&](Method m) { (void)source.make({.size = 4, .method = m}); });
}

TEST(Enumerators, OfFilesAndTextures) {
  refuse_others<PixelFormat>("format", [](PixelFormat f) { (void)pack(sky(), {.format = f}); });
  refuse_others<FaceOrientation>("orientation", [](FaceOrientation o) { (void)pack(sky(), {.orientation = o}); });
  refuse_others<Depth>("depth", [](Depth d) { (void)encode(sky(), {.format = "exr", .depth = d}); });
  refuse_others<Depth>("source_depth", [](Depth d) { (void)encode(sky(), {.format = "exr", .source_depth = d}); });
  refuse_others<Depth>("depth", [](Depth d) { (void)name(d); });
  refuse_others<Layout>("layout", [](Layout l) { (void)encode(sky(), {.layout = l, .format = "exr"}); });
  refuse_others<Layout>("layout", [](Layout l) { (void)name(l); });
  refuse_others<Layout>("layout", [](Layout l) { (void)grid(l); });
  refuse_others<Layout>("layout", [](Layout l) { (void)read("none.exr", {.layout = l}); });
  refuse_others<Projection>("projection", [](Projection p) { (void)read("none.exr", {.projection = p}); });
  refuse_others<Forward>("forward", [](Forward f) { (void)read("none.exr", {.forward = f}); });
  refuse_others<Forward>("forward", [](Forward f) { (void)read("none.exr", {.assumed_forward = f}); });
  refuse_others<FlawPolicy>("flaws", [](FlawPolicy f) { (void)read("none.exr", {.flaws = f}); });
  const std::vector<Colour> pixels(4, Colour(1));
  refuse_others<Display>("display", [&](Display d) { write_picture("x.png", 2, pixels, {.display = d}); });
  refuse_others<Display>("display", [&](Display d) {
    std::vector<Colour> copy = pixels;
    show(copy, d);
  });
  refuse_others<Depth>("depth", [&](Depth d) { write_stored("x.png", 2, pixels, d); });
  Engine engine = engine_named("filament");
  refuse_others<IrradianceForm>("irradiance", [&](IrradianceForm f) {
    for (EngineMap& map : engine.maps)
      if (map.chain) map.chain->irradiance = f;
    (void)bake(sky().clone(), engine, "none");
  });
  EXPECT_FALSE(std::filesystem::exists("none"));
}

TEST(Enumerators, HaveWords) {
  std::set<std::string> names, texts;
  for (std::size_t k = 0; k < enumerators<ErrorCode>; ++k) {
    names.emplace(name(ErrorCode(k)));
    texts.emplace(words(ErrorCode(k)));
  }
  for (std::size_t k = 0; k < enumerators<Remedy>; ++k) {
    names.emplace(name(Remedy(k)));
    texts.emplace(words(Remedy(k)));
  }
  EXPECT_EQ(names.size(), enumerators<ErrorCode> + enumerators<Remedy>);
  EXPECT_EQ(texts.size(), enumerators<ErrorCode> + enumerators<Remedy>);
  EXPECT_EQ(words(Remedy::none), "");
  EXPECT_EQ(name(Remedy::make_all_levels), "make_all_levels");
  EXPECT_EQ(words(Remedy::drop_channels), "set ReadOptions::drop_channels to leave them behind");
  EXPECT_EQ(name(ErrorCode::accuracy), "accuracy");
  refuse_others<ErrorCode>("code", [](ErrorCode c) { (void)words(c); });
  refuse_others<Remedy>("remedy", [](Remedy r) { (void)name(r); });
  EXPECT_GE(ENVMAP_VERSION, 10000);
}

// A canary after each span: nothing is written beyond what was given.
template <class T>
struct Guarded {
  std::array<T, 8> all{};
  std::span<T> first(std::size_t n) { return std::span(all).first(n); }
};

TEST(Spans, OfAnotherLengthAreRefused) {
  Guarded<Direction> directions_out;
  Guarded<Location<double>> places;
  Guarded<double> numbers;
  Guarded<Colour> colours;
  const std::vector<Direction> towards(4, Direction(0, 0, 1));
  const std::vector<Point2> points(4, Point2(0.5));
  for (const std::size_t length : {0U, 3U, 5U}) {
    const std::string words = "out must hold 4 elements, not " + std::to_string(length);
    for (const Projection p : all_projections) {
      refuses(words, [&] { locate(p, towards, places.first(length)); });
      refuses(words, [&] { directions(p, 0, points, directions_out.first(length)); });
      refuses(words, [&] { densities(p, points, numbers.first(length)); });
      refuses(words, [&] { facet_densities(p, 0, points, numbers.first(length)); });
    }
    refuses(words, [&] {
      const EnvironmentLookup look(sky());
      look(towards, colours.first(length));
    });
    for (const Rows& rows :
         {rows_of(sky()), rows_of(sky().clone()), Resampler(sky(), {.size = 4}).rows(),
          Resampler(sky(), {.size = 4, .mirror = MirroredAxis::x}).rows(), with_x_negated(rows_of(sky()))})
      refuses(words, [&] { rows.fill(0, 0, colours.first(length)); });
    refuses("edges must hold " + std::to_string(length + 1) + " elements, not 5", [&] {
      if (length == 3U || length == 5U || length == 0U)
        solid_angles(Projection::cube, std::array{0.0, 0.1, 0.2, 0.3, 0.4}, 0, 1, numbers.first(length));
    });
  }
  EXPECT_EQ(colours.all, Guarded<Colour>().all);
  EXPECT_EQ(numbers.all, Guarded<double>().all);
}

TEST(Spans, OfRowsAndFacesThatAreNotThere) {
  std::vector<Colour> out(4);
  std::vector<Direction> towards(4);
  for (const Rows& rows : {rows_of(sky()), Resampler(sky(), {.size = 4}).rows()}) {
    for (const int face : {-1, 6, 99}) refuses("face must be 0 to 5", [&] { rows.fill(face, 0, out); });
    for (const int row : {-1, 4, 99}) refuses("row must be 0 to 3", [&] { rows.fill(0, row, out); });
  }
  for (const int face : {-1, 6, 9}) {
    refuses("face must be 0 to 5", [&] { texel_directions(Projection::cube, 4, face, 0, 0, towards); });
    refuses("face must be 0 to 5", [&] { (void)direction_at(Projection::cube, face, Point2(0.5)); });
    refuses("face must be 0 to 5", [&] { (void)facet(Projection::cube, {face, 0.5, 0.5}); });
    refuses("face must be 0 to 5", [&] { (void)derivative(Projection::cube, {face, 0.5, 0.5}, 0.1); });
  }
  refuses("row must be 0 to 3", [&] { texel_directions(Projection::cube, 4, 0, 4, 0, towards); });
  refuses("size must be", [&] { texel_directions(Projection::cube, 0, 0, 0, 0, towards); });
}

TEST(Pictures, HaveWholeRowsOfColours) {
  const std::vector<Colour> pixels(100, Colour(0.5F));
  for (const char* file : {"refused.png", "refused.exr", "refused.jpg", "refused.hdr"}) {
    for (const int width : {0, -1, std::numeric_limits<int>::min(), 65537})
      refuses("width must be 1 to 65536", [&] { write_picture(file, width, pixels); });
    refuses("100 pixels are no rows of 7", [&] { write_picture(file, 7, pixels); });
    refuses("0 pixels are no rows of 7", [&] { write_picture(file, 7, {}); });
    refuses("100 pixels are no rows of 7", [&] { write_stored(file, 7, pixels, Depth::uint8); });
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      std::vector<Colour> flawed = pixels;
      flawed[23].y = flawed[57].x = bad;
      refuses("2 of 100 pixels are NaN or infinite, the first at (3,2)", [&] { write_picture(file, 10, flawed); });
    }
    EXPECT_FALSE(std::filesystem::exists(file));
  }
}

TEST(Quality, HasBounds) {
  const auto baked = [](const Quality& q) {
    (void)bake(sky().clone(), engine_named("filament"), "none", {.quality = q});
  };
  for (const int doublings : {100, 9, -9, std::numeric_limits<int>::min()}) {
    refuses("quality must be -8 to 8", [&] { baked({"mine", doublings, 0, 1e-3}); });
    refuses("quality must be -8 to 8", [&] { baked({"mine", 0, doublings, 1e-3}); });
  }
  for (const double error : {0.0, -1.0, 11.0, std::nan("")})
    refuses("max_error must be", [&] { baked({"mine", 0, 0, error}); });
  Engine engine;
  engine.name = "mine";
  refuses("the engine 'mine' takes no maps", [&] { (void)bake(sky().clone(), engine, "none"); });
  engine = engine_named("filament");
  for (EngineMap& map : engine.maps)
    if (map.chain) map.chain->roughness = nullptr;
  refuses("needs a function roughness", [&] { (void)bake(sky().clone(), engine, "none"); });
  EXPECT_FALSE(std::filesystem::exists("none"));
}

TEST(Lookups, RefuseNan) {
  EnvironmentMap map = sky().clone();
  add_levels(map);
  map.levels[1].texel(2, 1, 0)->z = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(EnvironmentLookup{map}, InputError);
}

TEST(Parameters, OfLobesAreNamedAsTheField) {
  refuses("ggx needs a parameter, its roughness", [] { (void)Lobe(LobeShape::ggx); });
  refuses("phong needs a parameter, its exponent", [] { (void)Lobe(LobeShape::phong); });
  refuses("diffuse takes no parameter: leave it unset, not 0.5", [] { (void)Lobe(LobeShape::diffuse, 0.5); });
}

}  // namespace
}  // namespace arguments_test

// Every public function with every bad value of every field: an error of the library, and neither a crash nor nonsense.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "envmap/envmap.h"

namespace bad_values_test {
namespace {

using namespace envmap;

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

const EnvironmentMap& sky(Projection p = Projection::latlong) {
  static const EnvironmentMap latlong = generate(Sky{}, Projection::latlong, 8),
                              cube = generate(Sky{}, Projection::cube, 4);
  return p == Projection::cube ? cube : latlong;
}

struct Call {
  std::string name;
  std::function<void()> call;
  std::string words;       // That the error has.
  std::string field = {};  // Of the range that the error has; empty: none.
};

// A call for each bad value of a field with a range.
template <class T, class F>
void add(std::vector<Call>& calls, const std::string& what, const std::string& field, std::vector<T> values, F&& call) {
  for (const T value : values)
    calls.push_back(
        {what + " " + field + " " + std::to_string(value), [=] { call(value); }, field + " must be", field});
}

const std::vector<int> bad_sizes{0, -1, std::numeric_limits<int>::min(), 65537, std::numeric_limits<int>::max()};
const std::vector<double> bad_errors{0, -1, nan, inf, 11}, bad_gains{-1, nan, inf};

std::vector<Call> of_convert() {
  std::vector<Call> calls;
  const auto with = [](const ConvertOptions& o) { (void)convert(sky(), o); };
  add(calls, "convert", "size", bad_sizes, [=](int v) { with({.size = v}); });
  add(calls, "convert", "samples", std::vector{0, -1, 65}, [=](int v) { with({.samples = v}); });
  add(calls, "convert", "area_error", std::vector<double>{0, -1, nan, 2}, [=](double v) { with({.area_error = v}); });
  add(calls, "convert", "max_error", bad_errors, [=](double v) { with({.max_error = v}); });
  add(calls, "convert", "gain", bad_gains, [=](double v) { with({.gain = v}); });
  calls.push_back({"convert overflow", [=] { with({.gain = 1e300}); }, "largest float, at a gain of 1e+300"});
  for (const Rotation& bad :
       {Rotation(0), Rotation(2), Rotation(nan), glm::transpose(Rotation(0, 1, 0, 1, 0, 0, 0, 0, 1))})
    calls.push_back({"convert rotation", [=] { with({.rotation = bad}); }, "rotation must be"});
  calls.push_back({"convert ball", [=] { with({.ball = BallCamera{4}}); }, "sphere maps"});
  calls.push_back({"keeps_texels", [] { (void)keeps_texels(sky(), {.size = 0}); }, "size must be", "size"});
  return calls;
}

std::vector<Call> of_prefilter() {
  std::vector<Call> calls;
  const auto with = [](const PrefilterOptions& p) { (void)Prefilterer(sky()).make(p); };
  for (const Lobe& lobe : {Lobe::diffuse(), Lobe::phong(1), Lobe::ggx(1)})
    add(calls, "prefilter", "size", bad_sizes, [=](int v) { with({.lobe = lobe, .size = v}); });
  add(calls, "prefilter", "max_error", bad_errors, [=](double v) { with({.size = 4, .max_error = v}); });
  add(calls, "prefilter", "scale", bad_gains, [=](double v) { with({.scale = v, .size = 4}); });
  calls.push_back({"prefilter overflow",
                   [] {
                     const EnvironmentMap bright = generate(Constant{Rgb<double>(1e30)}, Projection::latlong, 4);
                     (void)Prefilterer(bright).make({.scale = 1e30, .size = 4});
                   },
                   "largest float, at a scale of 1e+30"});
  for (const LobeShape shape : {LobeShape::phong, LobeShape::blinn_phong})
    add(calls, "lobe", "parameter", std::vector<double>{-1, inf, 2e9}, [=](double v) { (void)Lobe(shape, v); });
  for (const LobeShape shape : {LobeShape::ggx, LobeShape::charlie}) {
    add(calls, "lobe", "parameter", std::vector<double>{-0.1, inf, 2}, [=](double v) { (void)Lobe(shape, v); });
    calls.push_back({"lobe without a parameter", [=] { (void)Lobe(shape); }, "needs a parameter"});
  }
  for (const std::size_t length : {1, 23, 25})
    calls.push_back({"prefilter rows", [=] { with({.size = 4, .rows = std::vector<char>(length)}); }, "24 flags"});
  return calls;
}

std::vector<Call> of_measures() {
  std::vector<Call> calls;
  const EnvironmentMap &latlong = sky(), &cube = sky(Projection::cube);
  calls.push_back({"compare", [&] { (void)compare(latlong.base(), cube.base()); }, "one projection and size"});
  calls.push_back({"compare", [&] { (void)compare(cube.base(), latlong.base()); }, "one projection and size"});
  calls.push_back({"compare sizes", [&] { (void)compare(latlong, generate(Sky{}, Projection::latlong, 4)); },
                   "one projection and size"});
  calls.push_back({"compare axes",
                   [&] {
                     (void)compare(latlong, generate(Sky{}, {Projection::latlong, Forward::minus_z}, 8));
                   },
                   "forward axis"});
  calls.push_back({"compare shown",
                   [&] {
                     Level shown(Projection::cube, 2);
                     (void)compare(cube.base(), cube.base(), &shown);
                   },
                   "one projection and size"});
  add(calls, "project", "order", std::vector{-1, 201}, [&](int v) { (void)project(latlong, v); });
  for (const auto& f : {irradiance_factors, hann_window})
    add(calls, "factors", "order", std::vector{-1, 201}, [=](int v) { (void)f(v); });
  add(calls, "laplacian_window", "lambda", std::vector<double>{-1, nan, inf},
      [](double v) { (void)laplacian_window(2, v); });
  add(calls, "zonal", "order", std::vector{-1}, [](int v) { (void)zonal(Lobe::diffuse(), v); });
  add(calls, "weakest_window", "order", std::vector{-1, 21}, [](int v) {
    (void)weakest_window({v, std::vector<Flux>(484)});
  });
  calls.push_back({"evaluate",
                   [] {
                     (void)evaluate(Harmonics{2, std::vector<Flux>(4)}, Direction(0, 0, 1));
                   },
                   "coefficients"});
  calls.push_back({"scale_degrees",
                   [] {
                     Harmonics h{1, std::vector<Flux>(4)};
                     scale_degrees(h, std::vector<double>(1));
                   },
                   "factors must"});
  calls.push_back({"harmonics_at",
                   [] {
                     std::vector<double> out(3);
                     harmonics_at(1, Direction(0, 0, 1), out);
                   },
                   "out must hold 4"});
  add(calls, "radiance_within", "degrees", std::vector<double>{-1, nan, 181},
      [](double v) { (void)radiance_within(sky(), Direction(0, 1, 0), v); });
  return calls;
}

std::vector<Call> of_the_rest() {
  std::vector<Call> calls;
  add(calls, "generate", "size", bad_sizes, [](int v) { (void)generate(Sky{}, Projection::cube, v); });
  add(calls, "evaluate", "size", bad_sizes, [](int v) {
    (void)evaluate(Harmonics{0, {Flux(1)}}, Projection::cube, v, Forward::plus_z);
  });
  add(calls, "Level", "size", std::vector{0, -1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()},
      [](int v) { (void)Level(Projection::cube, v); });
  add(calls, "Level", "width", std::vector{-1, std::numeric_limits<int>::max()},
      [](int v) { (void)Level(Projection::latlong, 4, v); });
  add(calls, "photograph", "width", bad_sizes, [](int v) { (void)photograph(sky().clone(), {.width = v}); });
  add(calls, "photograph", "height", bad_sizes, [](int v) { (void)photograph(sky().clone(), {.height = v}); });
  add(calls, "photograph", "samples", std::vector{0, -1, 65},
      [](int v) { (void)photograph(sky().clone(), {.samples = v}); });
  add(calls, "photograph", "gain", bad_gains, [](double v) { (void)photograph(sky().clone(), {.gain = v}); });
  add(calls, "photograph", "field_radians", std::vector{0.0, -1.0, nan, pi, 7.0},
      [](double v) { (void)photograph(sky().clone(), {.field_radians = v}); });
  for (const double bad : {0.0, 0.5, 1.0, -2.0, 1e7, nan}) {
    calls.push_back({"BallCamera", [=] { (void)BallCamera{bad}.blind_angle(); }, "distance must be", "distance"});
    calls.push_back({"BallCamera",
                     [=] {
                       (void)BallCamera{bad}.seen_from_afar({0, 0, 1});
                     },
                     "distance must be", "distance"});
    calls.push_back(
        {"convert ball", [=] { (void)convert(sky(), {.ball = BallCamera{bad}}); }, "distance must be", "distance"});
  }
  add(calls, "BallCamera", "degrees", std::vector{-1.0, nan, 181.0},
      [](double v) { (void)BallCamera::of_field_of_view(v); });
  add(calls, "black_body", "kelvin", std::vector{0.0, 999.0, nan, inf}, [](double v) { (void)black_body(v); });
  add(calls, "white_balance", "kelvin", std::vector{0.0, nan}, [](double v) { (void)white_balance(v, rec709); });
  add(calls, "checker", "squares", std::vector{0, -1}, [](int v) { (void)generate(Checker{v}, Projection::cube, 4); });
  add(calls, "atmosphere", "turbidity", std::vector{0.5, 11.0, nan},
      [](double v) { (void)generate(Atmosphere{.turbidity = v}, Projection::cube, 4); });
  add(calls, "atmosphere", "altitude", std::vector{-1.0, nan},
      [](double v) { (void)generate(Atmosphere{.altitude = v}, Projection::cube, 4); });
  add(calls, "atmosphere", "radius_degrees", std::vector{0.0, nan},
      [](double v) { (void)generate(Atmosphere{.radius_degrees = v}, Projection::cube, 4); });
  for (const double bad : {-1.0, 2.0, nan})
    calls.push_back({"atmosphere", [=] { (void)generate(Atmosphere{.ground = Rgb<double>(bad)}, Projection::cube, 4); },
                     "ground must"});
  for (const double bad : {-1.0, 1e39, nan})
    calls.push_back(
        {"constant", [=] { (void)generate(Constant{Rgb<double>(bad)}, Projection::cube, 4); }, "infinite radiance"});
  calls.push_back({"harmonic", [] { (void)generate(Harmonic{.degree = 2, .base = 0}, Projection::cube, 4); },
                   "negative or infinite radiance"});
  calls.push_back({"photograph", [] { (void)photograph(sky().clone(), {.filter = Filter::sat}); }, "filter"});
  calls.push_back({"photograph",
                   [] { (void)photograph(sky().clone(), {.lens = CameraModel::fisheye, .field_radians = 7}); },
                   "field_radians must be"});
  calls.push_back(
      {"photograph",
       [] {
         (void)photograph(sky().clone(),
                          {.lens = CameraModel::cylinder, .field_radians = pi / 2, .width = 2000, .height = 480});
       },
       "width"});
  add(calls, "sun", "radius_degrees", std::vector{0.0, -1.0, nan, 181.0},
      [](double v) { (void)generate(Sun{.radius_degrees = v}, Projection::cube, 4); });
  add(calls, "harmonic", "degree", std::vector{-1, 101},
      [](int v) { (void)generate(Harmonic{v}, Projection::cube, 4); });
  add(calls, "harmonic", "order", std::vector{-3, 3}, [](int v) {
    (void)generate(Harmonic{2, v}, Projection::cube, 4);
  });
  add(calls, "real_harmonic", "order", std::vector{-3, 3}, [](int v) { (void)real_harmonic(2, v, {0, 0, 1}); });
  add(calls, "show", "exposure", std::vector{-1.0, nan, inf}, [](double v) { show({}, Display::clip, v); });
  add(calls, "brdf_table", "size", std::vector{0, -1, 1025}, [](int v) { (void)brdf_table(v); });
  add(calls, "sheen_table", "size", std::vector{0, -1, 1025}, [](int v) { (void)sheen_table(v); });
  add(calls, "brdf", "roughness", std::vector<double>{-1, nan, 2}, [](double v) { (void)brdf(std::vector{0.5}, v); });
  add(calls, "brdf", "cosine", std::vector<double>{0, nan, 2}, [](double v) { (void)brdf(std::vector{v}, 0.5); });
  add(calls, "sheen_albedo", "cosine", std::vector<double>{0, nan, 2},
      [](double v) { (void)sheen_albedo(v, std::vector{0.5}); });
  add(calls, "add_levels", "levels", std::vector{-1, 33}, [](int v) {
    EnvironmentMap m = sky().clone();
    add_levels(m, Weights::solid_angle, v);
  });
  add(calls, "coarser_level", "width", std::vector{0, -1, 17}, [](int v) { (void)coarser_level(sky().base(), v, 4); });
  add(calls, "coarser_level", "height", std::vector{0, -1, 9}, [](int v) { (void)coarser_level(sky().base(), 8, v); });
  add(calls, "apply", "saturation", std::vector<double>{-1, nan, inf}, [](double v) {
    Level l = sky().base().clone();
    apply({.saturation = v}, l);
  });
  for (const double gain : bad_gains)
    calls.push_back({"apply gain",
                     [=] {
                       Level l = sky().base().clone();
                       apply({.gain = Flux(1, gain, 1)}, l);
                     },
                     "gain must be"});
  calls.push_back({"white_balance", [] { (void)white_balance(Flux(nan), Flux(1)); }, "colour must be"});
  add(calls, "columns", "size", std::vector{0, -1}, [](int v) { (void)columns(Projection::sphere, v, 0); });
  add(calls, "matching_size", "size", std::vector{0, -1},
      [](int v) { (void)matching_size(Projection::cube, v, Projection::sphere); });
  add(calls, "solid_angles", "row", std::vector{-1, 4}, [](int v) {
    std::vector<double> out(4);
    solid_angles(Projection::cube, 4, v, out);
  });
  add(calls, "pack", "row_alignment", std::vector{0, -1, 5000}, [](int v) { (void)pack(sky(), {.row_alignment = v}); });
  add(calls, "PackedMap", "level", std::vector{-1, 1}, [](int v) { (void)pack(sky()).part(v, 0); });
  add(calls, "PackedMap", "face", std::vector{-1, 1}, [](int v) { (void)pack(sky()).part(0, v); });
  return calls;
}

std::vector<Call> of_engines() {
  std::vector<Call> calls;
  const auto baked = [](const BakeOptions& o) { (void)bake(sky().clone(), engine_named("filament"), "none", o); };
  add(calls, "bake", "size", bad_sizes, [=](int v) { baked({.size = v}); });
  add(calls, "bake", "chain_size", std::vector{0, -1, 4097}, [=](int v) { baked({.chain_size = v}); });
  add(calls, "bake", "max_error", bad_errors, [=](double v) { baked({.max_error = v}); });
  add(calls, "bake", "exposure", std::vector<double>{-101, nan, inf}, [=](double v) { baked({.exposure = v}); });
  calls.push_back({"engine_named", [] { (void)engine_named("maya"); }, "none of the engines babylon, "});
  calls.push_back({"chain_of", [] { (void)chain_of(engine_named("unity")); }, "no levels"});
  calls.push_back({"level_roughnesses", [] { (void)level_roughnesses(engine_named("unity").maps[0], 8); }, "no chain"});
  const EngineMap& chain = chain_of(engine_named("filament"));
  add(calls, "level_roughnesses", "size", bad_sizes, [&chain](int v) { (void)level_roughnesses(chain, v); });
  calls.push_back({"level_roughnesses", [&chain] { (void)level_roughnesses(chain, 4, 5); }, "has 5 levels"});
  const auto chained = [](std::vector<double> roughnesses, const PrefilterOptions& p) {
    (void)Prefilterer(sky()).make_chain(lobes_of(LobeShape::ggx, roughnesses), p);
  };
  calls.push_back({"make_chain", [=] { chained({}, {}); }, "lobes must not be empty"});
  calls.push_back(
      {"make_chain rows", [=] { chained({0.5}, {.size = 4, .rows = std::vector<char>(24)}); }, "rows must be empty"});
  calls.push_back({"make_chain lobe", [=] { chained({0.5}, {.lobe = Lobe::ggx(0.5), .size = 4}); },
                   "the lobes of a chain are those of its levels"});
  add(calls, "make_chain", "parameter", std::vector<double>{-1, 2}, [=](double v) { chained({0.5, v}, {.size = 4}); });
  add(calls, "make_chain", "size", bad_sizes, [=](int v) { chained({0.5}, {.size = v}); });
  return calls;
}

std::vector<Call> of_files() {
  std::vector<Call> calls;
  add(calls, "read", "level", std::vector{-1, 32}, [](int v) { (void)read("none.exr", {.level = v}); });
  add(calls, "read", "border", std::vector{-1, 1025}, [](int v) { (void)read("none.exr", {.border = v}); });
  calls.push_back({"read all", [] { (void)read("none.exr", {.level = 1, .all_levels = true}); }, "level must be 0"});
  calls.push_back({"write nothing", [] { (void)write("x.ktx2", std::vector<Rows>{}); }, "no levels"});
  calls.push_back({"encode nothing", [] { (void)encode(EnvironmentMap{}, {.format = "exr"}); }, "no levels"});
  calls.push_back({"encode without format", [] { (void)encode(sky(), {}); }, "no file type"});
  calls.push_back({"encode junk", [] { (void)encode(sky(), {.format = "junk"}); }, "cannot write .junk files"});
  calls.push_back({"write rows without fill",
                   [] {
                     (void)write("x.exr", Rows{Projection::cube, 4, Forward::plus_z, {}});
                   },
                   "function"});
  add(calls, "write rows", "size", std::vector{0, -1}, [](int v) {
    (void)write("x.exr", Rows{Projection::cube, v, Forward::plus_z, [](int, int, std::span<Colour>) {}});
  });
  add(calls, "write", "border", std::vector{-1, 1025}, [](int v) { (void)write("x.exr", sky(), {.border = v}); });
  for (const RowRange rows : {RowRange{-1, 2}, RowRange{3, 3}, RowRange{4, 2}, RowRange{0, 9}})
    calls.push_back(
        {"write rows of a map", [=] { (void)write("x.exr", sky(), {.rows = {rows}}); }, "rows must lie within"});
  calls.push_back({"write rows of more levels than there are",
                   [] {
                     (void)write("x.exr", sky(), {.rows = {{0, 2}, {0, 1}}});
                   },
                   "2 ranges of rows for 1 levels"});
  return calls;
}

TEST(BadValues, AreUsageErrorsWithFieldAndRange) {
  for (const auto& calls : {of_convert(), of_prefilter(), of_measures(), of_the_rest(), of_engines(), of_files()})
    for (const Call& c : calls) {
      try {
        c.call();
        ADD_FAILURE() << c.name << ": no error";
      } catch (const UsageError& e) {
        const std::string text = e.what();
        EXPECT_NE(text.find(c.words), std::string::npos) << c.name << ": " << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        if (c.field.empty()) continue;
        ASSERT_TRUE(e.range()) << c.name;
        EXPECT_EQ(e.range()->field, c.field) << c.name;
        EXPECT_LE(e.range()->least, e.range()->most) << c.name;
      } catch (const std::exception& e) {
        ADD_FAILURE() << c.name << ": another error: " << e.what();
      }
    }
}

// What belongs to another map, or holds less than it says.
TEST(BadValues, ThatDoNotFitTheirMapAreUsageErrors) {
  const auto refused = [](const std::string& what, const std::function<void()>& call, const std::string& words) {
    try {
      call();
      ADD_FAILURE() << what << ": no error";
    } catch (const UsageError& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << what << ": " << e.what();
    }
  };
  const EnvironmentMap sun = generate(Sun{.radius_degrees = 2}, Projection::cube, 64);
  const FoundLights found = find_lights(sun);
  ASSERT_FALSE(found.lights.empty());
  EnvironmentMap small = sky(Projection::cube).clone();
  refused(
      "take_out", [&] { take_out(small, found); }, "larger map");
  const EnvironmentMap& cube = sky(Projection::cube);
  std::vector<float> room(std::size_t(3 * 8 * 24));
  for (const Layout layout : {Layout::single, Layout::pair, Layout::api}) {
    refused(
        "write", [&] { (void)write("x.exr", cube, {.layout = layout}); }, "no layout of a cube");
    MutablePixelBuffer to{.pixels = reinterpret_cast<std::byte*>(room.data()), .width = 4, .height = 24};
    refused(
        "copy_to", [&] { copy_to(cube, to, {.layout = layout}); }, "a layout is");
    const PixelBuffer from{.pixels = reinterpret_cast<const std::byte*>(room.data()), .width = 16, .height = 8};
    refused(
        "map_of", [&] { (void)map_of(from, {.layout = layout}); }, "no layout of a cube");
  }
  refused(
      "facts",
      [&] {
        (void)encode(cube, {.format = "exr", .facts = {{"a b", "c"}}});
      },
      "words without spaces");
  const ImportanceSampler sampler(cube);
  refused(
      "sample",
      [&] {
        (void)sampler.sample({1, 0.5});
      },
      "below 1");
  refused(
      "distant_lights", [&] { (void)distant_lights(cube, 0); }, "count must be");
  refused(
      "distant_lights", [&] { (void)distant_lights(cube, 257); }, "count must be");
  refused(
      "irradiance_of_sun", [&] { (void)irradiance_of_sun(cube, -5); }, "illuminance");
  Harmonics two = project(cube, 2);
  refused(
      "scale_degrees", [&] { scale_degrees(two, std::vector<double>(9, 1.0)); }, "one for each degree");
  refused(
      "bake", [&] { (void)bake(cube.clone(), engine_named("three"), ""); }, "empty");
  EnvironmentMap flawed = cube.clone();
  flawed.base().texel(0, 0, 0)->x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)light_error(flawed, found, 0.5), InputError);
}

TEST(BadValues, AMovedLevelIsEmpty) {
  Level from(Projection::cube, 4);
  const Level to = std::move(from);
  EXPECT_EQ(from.faces() + from.width() + from.height(), 0);  // NOLINT: what this is about.
  EXPECT_EQ(to.faces(), 6);
}

TEST(BadValues, AnEmptyMapIsAUsageError) {
  const EnvironmentMap none;
  EXPECT_THROW((void)none.projection(), UsageError);
  EXPECT_THROW((void)none.frame(), UsageError);
  EXPECT_THROW((void)convert(none, {}), UsageError);
  EXPECT_THROW(Prefilterer{none}, UsageError);
  EXPECT_THROW((void)project(none, 2), UsageError);
  EXPECT_THROW((void)measure(none), UsageError);
  EXPECT_THROW((void)compare(none, sky()), UsageError);
  EXPECT_THROW((void)irradiance(none, Direction(0, 1, 0)), UsageError);
  EXPECT_THROW(EnvironmentLookup{none}, UsageError);
  EXPECT_THROW((void)rows_of(none), UsageError);
  EXPECT_THROW((void)pack(none), UsageError);
  EXPECT_THROW((void)photograph({}, {}), UsageError);
  EnvironmentMap more;
  EXPECT_THROW(add_levels(more), UsageError);
}

// One NaN or infinite texel: refused with the count and the place. No value of the result is looked at: there is none.
TEST(BadValues, OperationsRefuseNanAndInfinity) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EnvironmentMap map = generate(Sky{}, Projection::cube, 8);
    map.base().texel(3, 5, 2)->y = bad;
    const std::vector<std::function<void()>> calls{
        [&] { (void)convert(map, {.size = 4}); },
        [&] { (void)convert(map, {}); },
        [&] { Prefilterer source(map); },
        [&] { (void)project(map, 2); },
        [&] {
          EnvironmentMap copy = map.clone();
          add_levels(copy);
        },
        [&] { (void)compare(map, map); },
        [&] { (void)photograph(map.clone(), {.width = 4, .height = 4}); },
        [&] { apply({.saturation = 0.5}, map.base()); },
        [&] { (void)pack(map); },
    };
    for (std::size_t k = 0; k < calls.size(); ++k) try {
        calls[k]();
        ADD_FAILURE() << "call " << k;
      } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("1 of 384 texels"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("(5,2) of face 3"), std::string::npos) << e.what();
        EXPECT_EQ(e.remedy(), Remedy::repair);
      }
    for (const Depth depth : {Depth::single, Depth::half, Depth::bc6h, Depth::uastc_hdr, Depth::rgb9e5})
      EXPECT_THROW((void)encode(map, {.format = "ktx2", .depth = depth}), OutputError);
    // Measures leave the texel out.
    EXPECT_TRUE(std::isfinite(measure(map).flux.y));
    EXPECT_TRUE(std::isfinite(irradiance(map, Direction(0, 1, 0)).y));
    EXPECT_EQ(repair(map.base()), 1);
    EXPECT_NO_THROW((void)convert(map, {.size = 4}));
  }
}

// What lies beside the disc is no texel of the map.
TEST(BadValues, PrefilteringRefusesNegativeRadiance) {
  EnvironmentMap map = sky().clone();
  map.base().texel(0, 3, 2)->y = -1;
  EXPECT_THROW(Prefilterer{map}, InputError);
  EXPECT_NO_THROW((void)convert(map, {.size = 4}));
}

TEST(BadValues, TexelsBesideADiscMayHoldAnything) {
  EnvironmentMap map = generate(Sky{}, Projection::sphere, 16);
  map.base().texel(0, 0, 0)->x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NO_THROW((void)project(map, 1));
}

TEST(BadValues, ALookupOfNoDirectionIsBlack) {
  for (const Projection p : all_projections) {
    const EnvironmentLookup look(generate(Constant{}, p, 8));
    for (const Direction& d :
         {Direction(0), Direction(nan), Direction(nan, 0, 1), Direction(inf, 0, 0), Direction(-inf, 0, nan)})
      EXPECT_EQ(look(d), Colour(0)) << name(p);
    EXPECT_EQ(look(Direction(0, 0, 5)), look(Direction(0, 0, 1))) << name(p);
    for (const Direction& d : {Direction(1e-100, 0, 0), Direction(1e100, 1e100, 0)})
      EXPECT_EQ(look(d), Colour(1)) << name(p);
  }
}

TEST(Types, MapsAreMovedAndNotCopied) {
  static_assert(!std::is_copy_constructible_v<EnvironmentMap> && !std::is_copy_assignable_v<EnvironmentMap>);
  static_assert(!std::is_copy_constructible_v<Source> && std::is_nothrow_move_constructible_v<EnvironmentMap>);
  static_assert(std::is_move_assignable_v<EnvironmentMap> && std::is_aggregate_v<EnvironmentMap>);
}

}  // namespace
}  // namespace bad_values_test

// Calls of the public functions, made of bytes: each returns, or throws one of the library's errors.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "envmap/engine/level_roughness.h"
#include "envmap/envmap.h"
#include "targets.h"

namespace {

using namespace envmap;

// Values out of bytes; zeros where these end.
class Values {
 public:
  explicit Values(Bytes bytes) : bytes_(bytes) {}

  unsigned byte() { return at_ < bytes_.size() ? unsigned(bytes_[at_++]) : 0; }

  // One in sixteen breaks things: calls have many values, and shall often go through.
  double number() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    constexpr std::array odd{0.0,  -0.0, -1.0, 1.0,          1e-300, -1e-300, 1e300, 1e30,
                             1e-9, inf,  -inf, std::nan(""), 0.5,    2.0,     1e9,   3e9};
    const unsigned kind = byte();
    return kind < 16 ? odd[kind % odd.size()] : 0.01 + byte() / 256.0;
  }
  // What is in range is small, so that no call takes long.
  int integer() {
    constexpr std::array odd{0, -1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), 65537, 1 << 20};
    const unsigned kind = byte();
    return kind < 16 ? odd[kind % odd.size()] : 1 + int(kind % 12);
  }
  bool flag() { return byte() % 2 == 1; }
  bool seldom() { return byte() < 16; }
  template <class T>
  std::optional<T> maybe(T value) {
    return byte() < 64 ? std::optional<T>(value) : std::nullopt;
  }
  // One of the enumerators up to `last`, and rarely a number that is none.
  template <class Enum>
  Enum of(Enum last) {
    const unsigned number = byte();
    return Enum(number == 255 ? 99 : number % (unsigned(last) + 1));
  }
  Projection projection() { return of(Projection::equal_area); }
  Direction direction() { return {number(), number(), number()}; }
  Rgb<double> rgb() { return {number(), number(), number()}; }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

// Mostly sound maps; some have no level, levels of several kinds, or texels of any value.
EnvironmentMap map_of(Values& v) {
  EnvironmentMap map{.levels = {}, .forward = v.of(Forward::minus_x)};
  const Projection p = v.projection();
  const unsigned kind = v.byte();
  const int levels = kind < 8 ? 0 : 1 + int(kind % 3);
  for (int k = 0; k < levels; ++k) {
    Level& level = map.levels.emplace_back(kind < 24 ? v.projection() : p, std::max(1, (1 + int(kind % 16)) >> k));
    for (int face = 0; face < level.faces(); ++face)
      for (int j = 0; j < level.height(); ++j)
        for (Colour& c : level.row(face, j)) c = Colour(0.1F * float((face + j + k) % 7));
    *level.texel(0, level.width() / 2, level.height() / 2) = Colour(v.seldom() ? v.rgb() : Rgb<double>(1000));
  }
  return map;
}

Lobe lobe_of(Values& v) {
  const LobeShape shape = v.of(LobeShape::charlie);
  return shape == LobeShape::diffuse && v.flag() ? Lobe(shape) : Lobe(shape, v.number());
}

PrefilterOptions prefilter_of(Values& v) {
  return {.scale = v.maybe(v.number()),
          .to = v.projection(),
          .size = v.integer(),
          .forward = v.of(Forward::minus_x),
          .method = v.of(Method::multilevel),
          .rows = std::vector<char>(v.seldom() ? v.byte() : 0, 1),
          .max_error = v.number()};
}

ConvertOptions convert_of(Values& v) {
  return {.to = Frame(v.projection(), v.of(Forward::minus_x)),
          .size = v.maybe(v.integer()),
          .filter = v.maybe(v.of(Filter::area)),
          .samples = v.integer(),
          .area_error = v.maybe(1e-3 + std::abs(v.number())),  // Smaller ones take minutes.
          .max_error = v.maybe(v.number()),
          .rotation = v.seldom() ? Rotation(v.number()) : rotation(v.number(), v.number(), v.number()),
          .gain = v.number(),
          .ball = v.seldom() ? std::optional(BallCamera{v.number()}) : std::nullopt};
}

void write_and_read(Values& v) {
  const std::array<std::string, 9> formats{"exr", "hdr", "pfm", "ktx", "ktx2", "dds", "env", "glb", ""};
  const std::vector<std::byte> file =
      encode(map_of(v), {.layout = v.seldom() ? std::optional(v.of(Layout::files)) : std::nullopt,
                         .format = formats[v.byte() % formats.size()],
                         .depth = v.seldom() ? std::optional(v.of(Depth::single)) : std::nullopt,
                         .clamp = v.flag(),
                         .openexr_envmap = v.seldom(),
                         .border = v.seldom() ? v.integer() : 0,
                         .zstd = v.seldom()});
  (void)read(file,
             {.projection = v.maybe(v.projection()), .level = v.seldom() ? v.integer() : 0, .all_levels = v.flag()});
}

void look_up(Values& v) {
  const EnvironmentLookup look(map_of(v));
  const std::vector<Direction> directions{v.direction(), v.direction()};
  std::vector<Colour> found(v.seldom() ? 1 : 2);
  look(directions, found, v.number());
}

void evaluate_harmonics(Values& v) {
  Harmonics h = project(map_of(v), v.integer());
  if (v.seldom()) h.order = v.integer();
  scale_degrees(h, irradiance_factors(v.seldom() ? v.integer() : h.order));
  if (h.order <= 8) (void)weakest_window(h);
  (void)evaluate(h, v.direction());
  (void)evaluate(h, v.projection(), v.integer(), v.of(Forward::minus_x));
}

void measure_map(Values& v) {
  EnvironmentMap a = map_of(v);
  const EnvironmentMap b = v.seldom() ? map_of(v) : a.clone();
  (void)measure(a), (void)find_flaws(a.base()), (void)irradiance(a, v.direction());
  (void)radiance_within(a, v.direction(), v.number());
  apply({.gain = v.rgb(), .saturation = v.number()}, a.base());
  (void)repair(a.base());
  (void)compare(a, b);
}

void take_pictures(Values& v) {
  (void)photograph(map_of(v), {.lens = v.of(CameraModel::cylinder),
                               .field_radians = v.number(),
                               .width = v.integer(),
                               .height = v.integer(),
                               .towards = v.direction(),
                               .filter = v.seldom() ? v.of(Filter::area) : v.of(Filter::bicubic),
                               .samples = v.maybe(v.integer()),
                               .gain = v.number()});
}

void make_levels(Values& v) {
  EnvironmentMap map = map_of(v);
  add_levels(map, v.of(Weights::uniform), v.integer() % 4);
  (void)pack(map, {.format = v.of(PixelFormat::bc6h), .clamp = v.flag(), .row_alignment = v.integer()});
  const auto below = [&v](int size) { return v.seldom() ? v.integer() : std::max(1, size / 3); };
  (void)coarser_level(map.base(), below(map.base().width()), below(map.base().height()));
}

void make_tables(Values& v) {
  const std::vector<double> values{v.number(), v.number()};
  (void)brdf(values, v.number());
  (void)sheen_albedo(v.number(), values);
  const Engine& engine = engines()[v.byte() % engines().size()];
  (void)level_roughnesses(chain_of(engine), v.integer(), v.maybe(v.integer()));
}

void generate_map(Values& v) {
  const std::array<Pattern, 5> patterns{
      Constant{v.rgb()}, Gradient{v.rgb(), v.rgb()}, Checker{v.integer(), v.rgb(), v.rgb()},
      Sun{.towards = v.direction(), .radius_degrees = v.number(), .radiance = v.rgb()},
      Harmonic{v.integer(), v.integer(), v.number(), v.number()}};
  (void)generate(patterns[v.byte() % patterns.size()], Frame(v.projection(), v.of(Forward::minus_x)), v.integer());
}

void prefilter_chain(Values& v) {
  const Prefilterer source(map_of(v));
  const std::vector<Lobe> lobes(v.byte() % 4, lobe_of(v));
  (void)source.make_chain(lobes, prefilter_of(v));
}

}  // namespace

void fuzz_library(Bytes bytes) {
  Values v(bytes);
  const std::array<std::function<void(Values&)>, 11> calls{[](Values& w) {
                                                             (void)convert(map_of(w), convert_of(w),
                                                                           {.threads = w.seldom() ? w.integer() : 0});
                                                           },
                                                           [](Values& w) {
                                                             PrefilterOptions options = prefilter_of(w);
                                                             options.lobe = lobe_of(w);
                                                             (void)Prefilterer(map_of(w)).make(options);
                                                           },
                                                           prefilter_chain,
                                                           write_and_read,
                                                           look_up,
                                                           evaluate_harmonics,
                                                           measure_map,
                                                           take_pictures,
                                                           make_levels,
                                                           make_tables,
                                                           generate_map};
  try {
    calls[v.byte() % calls.size()](v);
  } catch (const Error& e) {
    expect_harmless(e.what());
  }
}

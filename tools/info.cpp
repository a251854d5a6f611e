#include <fmt/format.h>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/sampling.h"
#include "facts.h"

namespace tools {
namespace {

using namespace envmap;
using nlohmann::ordered_json;

struct Options {
  std::string input;
  ReadOptions read;
  bool sampling = false, levels = false;
  std::optional<Direction> towards;
};

void print_facts(const ordered_json& j) {
  for (const auto& [what, value] : lines_of(j)) print(fmt::format("{:15}{}\n", what, value));
}

// Size and flux of each level, and how far the flux is off that of the first.
ordered_json levels(const EnvironmentMap& map) {
  ordered_json table;
  for (const Level& level : map.levels) {
    const Flux off = flux_difference(level, map.base());
    table.push_back({{"face_width", level.width()},
                     {"face_height", level.height()},
                     {"flux", to_json(flux(level))},
                     {"flux_difference", to_json(off)}});
  }
  return table;
}

void print_levels(const EnvironmentMap& map) {
  print(fmt::format("\n{:>5} {:>11}  {:>12} {:>12} {:>12}  {:^32}\n", "level", "faces", "flux R", "G", "B",
                    "difference from level 0"));
  for (std::size_t k = 0; k < map.levels.size(); ++k) {
    const Level& level = map.levels[k];
    const Flux f = flux(level), off = flux_difference(level, map.base());
    print(fmt::format("{:5} {:>11}  {:12.6g} {:12.6g} {:12.6g}  {:+.2e}  {:+.2e}  {:+.2e}\n", k,
                      fmt::format("{}x{}", level.width(), level.height()), f.x, f.y, f.z, off.x, off.y, off.z));
  }
}

int run(Options& o, const Common& common) {
  if (o.levels && o.read.level > 0) throw UsageError("--levels shows all of them: leave out --level");
  o.read.all_levels = o.levels;
  const Source source = read_map(o.input, o.read, common);
  ordered_json j = facts(source, o.input, o.read.colour.space, o.towards);
  if (o.levels) j["level_table"] = levels(source.map);
  std::vector<SamplingRow> table;
  if (o.sampling) table = sampling_table(source.map.projection(), source.map.base().height());
  if (common.json) {
    for (const SamplingRow& r : table)
      j["sampling"].push_back({{"texel", {r.i, r.j}},
                               {"degrees", r.angle},
                               {"solid_angle", r.solid_angle},
                               {"relative", r.relative},
                               {"anisotropy", r.anisotropy}});
    print_report(j);
    return 0;
  }
  print_facts(j);
  if (o.levels) print_levels(source.map);
  if (o.sampling)
    print(fmt::format("\n{:>14} {:>10} {:>14} {:>10} {:>11}\n", "texel", "degrees", "solid angle/sr", "/ mean",
                      "anisotropy"));
  for (const SamplingRow& r : table)
    print(fmt::format("{:>14} {:10.3f} {:14.5e} {:10.4f} {:11.4g}\n", fmt::format("({},{})", r.i, r.j), r.angle,
                      r.solid_angle, r.relative, r.anisotropy));
  return 0;
}

}  // namespace

Command info_command() {
  return {
      .name = "info",
      .summary = "Show what an environment map holds: projection, radiance, flux, brightest direction, flaws",
      .description =
          "Means are weighted by solid angle; flux is the sum of radiance x solid angle per channel. The dynamic range "
          "is that "
          "of luminance (Rec. 709), from the darkest texel above 0. Directions are in the world frame: right-handed, "
          "+Y up. Values are those in linear Rec.709, whatever the file holds. The illuminance is that of a plane, in lux where 1 is "
          "a candela a square metre or what whiteLuminance says. NaN, infinite and negative texels are counted, and NaN and infinite ones left out of the sums.\n\n"
          "--sampling shows how evenly the projection samples the sphere: solid angle and anisotropy of texels from "
          "the "
          "centre of a face to the pole (latlong), the corner (cube) or the rim.",
      .examples = {{"envmap info probe.hdr", "facts as text"},
                   {"envmap info probe.exr --json | jq .flux", "one fact for a script"},
                   {"envmap info chain.ktx2 --levels", "with the flux of every mip level"},
                   {"envmap info ball.exr --from sphere --sampling", "with the table of texel solid angles"}},
      .keys = {{"file", "text", "INPUT"},
               {"format", "text", "openexr, hdr, ktx2, ktx, dds or what OpenImageIO calls it"},
               {"depth", "text", "uint8, uint16, bc6h, rgb9e5, half or float"},
               {"width", "count", "of the image in texels"},
               {"height", "count", "of the image in texels"},
               {"projection", "text", "latlong, cube, sphere, paraboloid or angular"},
               {"layout", "text", "where faces lie in the image"},
               {"forward", "text?", "world axis at the centre of latlong and angular images, else absent"},
               {"border", "count?", "texels on each side of an octahedral map that repeat others, left out here; else absent"},
               {"border_samples", "boolean?", "true where samples lie on the border (OpenEXR's envmap attribute), else absent"},
               {"levels", "count", "mip levels in the file"},
               {"space", "text", "colour space of the file's values, and in brackets what says so; all values here are linear Rec.709"},
               {"faces", "count", "of the map"},
               {"face_width", "count", "in texels"},
               {"face_height", "count", "in texels"},
               {"minimum", "triple", "of each channel: red, green, blue"},
               {"maximum", "triple", "of each channel"},
               {"mean", "triple", "radiance of each channel over the sphere"},
               {"flux", "triple", "sum of radiance x solid angle, of each channel"},
               {"solid_angle", "number", "of all texels, in steradians"},
               {"illuminance.towards", "triple", "unit vector that the plane faces: --towards, else up"},
               {"illuminance.lux", "number", "luminance x cosine x solid angle over its half of the sphere, of white_luminance or 1 cd/m^2"},
               {"white_luminance", "number?", "of radiance 1 in cd/m^2, as the file says; else absent"},
               {"dynamic_range", "number", "luminance of the brightest texel over that of the darkest above 0; null where there is none"},
               {"stops", "number", "its logarithm to base 2"},
               {"brightest.direction", "triple", "of the brightest texel: x, y, z in the world frame"},
               {"brightest.value", "triple", "its radiance"},
               {"brightest.face", "count", "where it is"},
               {"brightest.texel", "texel", "column and row there"},
               {"brightest.azimuth", "number", "of its direction: degrees about +Y from +Z towards +X, as --rotate counts them"},
               {"brightest.elevation", "number", "degrees above the horizon"},
               {"metadata", "words?", "further words that the file carries, such as the lobe; else absent"},
               {"texels_at_maximum", "count", "texels with a channel at the largest value of all: many where a map was clipped"},
               {"nan", "count", "texels that hold NaN"},
               {"infinite", "count", "texels that hold infinities"},
               {"negative", "count", "texels that hold values below 0"},
               {"first_flaw", "object?", "the first texel of these; absent where there is none"},
               {"first_flaw.face", "count", "where it is"},
               {"first_flaw.texel", "texel", "column and row there"},
               {"level_table[]", "object?", "a row for each level, with --levels; else absent"},
               {"level_table[].face_width", "count", "in texels"},
               {"level_table[].face_height", "count", "in texels"},
               {"level_table[].flux", "triple", "of each channel"},
               {"level_table[].flux_difference", "triple", "relative to that of level 0"},
               {"sampling[]", "object?", "with --sampling; else absent"},
               {"sampling[].texel", "texel", "column and row"},
               {"sampling[].degrees", "number", "from the centre of the face"},
               {"sampling[].solid_angle", "number", "in steradians"},
               {"sampling[].relative", "number", "that over the mean of all texels"},
               {"sampling[].anisotropy", "number", "longest over shortest side of the texel on the sphere"}},
      .reports = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("INPUT", o->input, "File to read, '-' for standard input; {face} in the name reads six files")->required();
        app.add_flag("--levels", o->levels, "Add the table of mip levels and how far the flux of each is off");
        app.add_flag("--sampling", o->sampling, "Add the table of texel solid angle and anisotropy from centre to rim");
        add_triple(app, "--towards", o->towards, "X,Y,Z", false, "What the plane of the illuminance faces (default: up, 0,1,0)");
        add_read_options(app, o->read);
        add_max_memory(app, o->read);
        o->read.flaws = FlawPolicy::keep;
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools

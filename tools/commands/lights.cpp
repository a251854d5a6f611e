#include "envmap/light/lights.h"

#include <fmt/format.h>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/engine/suns.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/light/distant_lights.h"
#include "envmap/light/light_error.h"
#include "envmap/maths/luminance.h"
#include "maps/map_facts.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

struct LightsRequest {
  std::string input, remainder, gltf;
  ReadOptions read;
  WriteOptions write;
  LightOptions find;
  double roughness = 0.5;
  std::optional<int> count;
};

// Lights without a size by median cut, as lights that other functions take.
FoundLights by_median_cut(const EnvironmentMap& map, int count) {
  FoundLights found;
  double all = 0;
  for (const DistantLight& light : distant_lights(map, count)) {
    DiscLight& one = found.lights.emplace_back();
    one.towards = light.from;
    one.flux = one.irradiance = Flux(light.irradiance);
    all += luminance_of(one.irradiance);
  }
  for (DiscLight& light : found.lights) light.share = luminance_of(light.irradiance) / all;
  return found;
}

std::string radius_words(const DiscLight& light) {
  return fmt::format("{}{:.4f}", light.radius_is_bound ? "<" : "", light.radius_degrees);
}

std::string table(const std::vector<DiscLight>& lights, double lux) {
  std::string text = fmt::format("{:>4} {:>9} {:>9} {:>9} {:>11} {:>11} {:>11} {:>11} {:>7}\n", "", "azimuth",
                                 "elevation", "radius", "lux", "red", "green", "blue", "share");
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const DiscLight& light = lights[k];
    const auto [azimuth, elevation] = angles_of(light.towards);
    text += fmt::format("{:>4} {:>9.3f} {:>9.3f} {:>9} {:>11.6g} {:>11.6g} {:>11.6g} {:>11.6g} {:>6.2f}%\n", k + 1,
                        azimuth, elevation, radius_words(light), lux * luminance_of(light.irradiance),
                        light.irradiance.x, light.irradiance.y, light.irradiance.z, 100 * light.share);
  }
  return text;
}

void add(Report& report, const std::vector<DiscLight>& lights, double lux, bool are_discs) {
  report.put_array("lights");
  for (const DiscLight& light : lights) {
    const auto [azimuth, elevation] = angles_of(light.towards);
    report.append("lights[]");
    report.put("lights[].towards", light.towards);
    report.put("lights[].azimuth", azimuth);
    report.put("lights[].elevation", elevation);
    report.put("lights[].irradiance", Direction(light.irradiance));
    report.put("lights[].lux", lux * luminance_of(light.irradiance));
    report.put("lights[].share", light.share);
    const auto of_disc = [&](std::string_view key, const ReportValue& value) {
      report.put(fmt::format("lights[].{}", key), are_discs ? value : ReportValue(nullptr));
    };
    of_disc("within", light.within_degrees);
    of_disc("radius", light.radius_degrees);
    of_disc("radius_is_bound", light.radius_is_bound);
    of_disc("radius_within", light.radius_within_degrees);
    of_disc("radiance", Direction(light.radiance));
    of_disc("flux", Direction(light.flux));
    of_disc("contrast", light.contrast);
    of_disc("misfit", light.misfit);
    of_disc("texels_at_peak", light.texels_at_peak);
  }
}

std::string error_words(const LightError& error, double roughness) {
  return fmt::format(
      "Without a size, with the remainder, in every direction: irradiance within {:.2g}% of its largest, "
      "GGX of roughness {:g} within {:.2g}%.\n",
      100 * error.irradiance, roughness, 100 * error.ggx);
}

int tell_none(const LightsRequest& o) {
  warn(fmt::format(
      "envmap lights: {}: no light: nothing round of up to {:g} degrees has {:g}% of the map's light and {:g} "
      "times the luminance around it",
      o.input, o.find.max_radius_degrees, 100 * o.find.min_share, o.find.contrast));
  return 1;
}

void write_remainder(LightsRequest& o, Source& source, const FoundLights& found, Report& report) {
  take_out(source.map, found);
  o.write.source_depth = source.depth;
  o.write.provenance = source.provenance;
  const Written written = write_map(o.remainder, rows_of(source.map), o.write, "write");
  tell_lost_facts(o.remainder, source.map.frame(), o.write);
  report.put_written(o.remainder, written);
}

void check(LightsRequest& o, const Options& options) {
  if (o.count)
    for (const char* const option : {"--remainder", "--min-share", "--max-radius", "--contrast", "--roughness"})
      if (options.given(option))
        throw UsageError(fmt::format("--count makes lights of the whole map: remove {}", option));
  if (!o.gltf.empty() && o.gltf != "-" && extension_of(o.gltf) != "gltf")
    throw UsageError(o.gltf, "--gltf writes .gltf files");
  if (o.gltf == "-" && settings().json) throw UsageError("--gltf - and --json both write to standard output");
}

int run(LightsRequest& o, const Options& options, Report& report) {
  check(o, options);
  Source source = read_map(o.input, o.read);
  if (!o.remainder.empty()) check_output(o.remainder, o.write, source.map.projection());
  const double lux = source.provenance.white_luminance.value_or(1.0F);
  const FoundLights found = o.count ? by_median_cut(source.map, *o.count)
                                    : find_lights(source.map, o.find, {.progress = progress_line("lights")});
  report.put("input", o.input);
  report.put("output", nullptr);
  add(report, found.lights, lux, !o.count);
  if (found.lights.empty()) return tell_none(o);
  if (!settings().json && o.gltf != "-") print(table(found.lights, lux));
  if (!o.count) {
    const LightError error = light_error(source.map, found, o.roughness);
    report.put("error.irradiance", error.irradiance);
    report.put("error.ggx", error.ggx);
    report.put("error.roughness", o.roughness);
    if (!settings().json && o.gltf != "-") print(error_words(error, o.roughness));
  }
  if (!o.gltf.empty()) write_text(o.gltf, gltf_lights(found.lights, lux));
  if (!o.remainder.empty()) write_remainder(o, source, found, report);
  report.put_seconds();
  return 0;
}

}  // namespace

Action define_lights(Options& o) {
  const auto r = std::make_shared<LightsRequest>();
  o.reads("INPUT", r->input, "File to read, or '-' for stdin ({face} in the name reads six files)").required = true;
  o.group = "Lights";
  o.add("--min-share", "S", &r->find.min_share, range_of(limits::min_share),
        "Least share of the map's luminous flux (default: 0.01)");
  o.add("--max-radius", "DEGREES", &r->find.max_radius_degrees, range_of(limits::light_radius),
        "Largest angular radius of a light (default: 5)");
  o.add("--contrast", "C", &r->find.contrast, range_of(limits::contrast),
        "Least luminance, relative to that around the light (default: 4)");
  o.add("--most", "N", &r->find.most, range_of(limits::lights), "Largest number of lights (default: 16)");
  o.add("--roughness", "R", &r->roughness, {0.001, 1}, "GGX roughness of the printed error (default: 0.5)");
  o.add("--count", "N", &r->count, {1, max_distant_lights},
        "Instead, N distant lights that share out all light (median cut)");
  o.group = groups::output_file;
  o.add("--gltf", "OUT.gltf", &r->gltf, "Write the lights as glTF (KHR_lights_punctual)").file = File::output;
  o.add("--remainder", "OUT", &r->remainder, "Write the map without the lights").file = File::output;
  add_faces(o, r->write);
  add_write_options(o, r->write);
  o.need("--remainder", {"--faces", "--depth", "--format", "--clamp", "--openexr-envmap", "--compression", "--zstd"});
  add_read_options(o, r->read);
  add_repair(o, r->read);
  return [r, &o](Report& report) { return run(*r, o, report); };
}

}  // namespace tools

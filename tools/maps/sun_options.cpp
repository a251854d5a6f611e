#include "maps/sun_options.h"

#include <fmt/format.h>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/light/lights.h"
#include "envmap/light/restore_sun.h"
#include "envmap/operate/atmosphere.h"
#include "envmap/operate/measure.h"

namespace tools {

using namespace envmap;

namespace {

constexpr std::string_view forms[] = {"lux=", "irradiance=", "atmosphere"};

// What the sun's disc shall have, in the unit of the map.
Flux wanted_of(const Source& source, const std::string& words, double radius) {
  if (words == "atmosphere")
    return irradiance_of_sun_in_atmosphere(source.map, radius, {.progress = progress_line("sky")});
  if (words.starts_with("irradiance="))
    if (const auto triple = triple_of(words.substr(11))) return Flux(*triple);
  double lux = 0;
  if (words.starts_with("lux=") && parse_number(words.substr(4), lux) && lux >= 0)
    return irradiance_of_sun(source.map, lux / double{source.provenance.white_luminance.value_or(1.0F)});
  throw UsageError(fmt::format("--restore-sun: '{}' is none of lux=E, irradiance=R,G,B and atmosphere", words));
}

// A sun that was not clipped would become two.
void check_missing(const Source& source, const std::string& input, const Flux& wanted) {
  const ClippedSun clipped = clipped_sun(source.map);
  const double unit = source.provenance.white_luminance.value_or(1.0F);
  for (const DiscLight& light : find_lights(source.map).lights) {
    const double apart = 180 / pi * angle_between(light.towards, clipped.towards);
    if (apart < light.radius_degrees + clipped.degrees && luminance_of(light.irradiance) >= luminance_of(wanted))
      throw InputError(fmt::format("its sun gives {:.6g} lux already, and {:.6g} are wanted: no light is missing",
                                   unit * luminance_of(light.irradiance), unit * luminance_of(wanted)));
  }
  if (clipped.texels == 1)
    warn(fmt::format("{}: one texel alone holds the largest value, so nothing shows that a sun was clipped there",
                     input));
  const double rest = luminance_of(irradiance(source.map, clipped.towards));
  if (!source.provenance.white_luminance && luminance_of(wanted) > 100 * rest)
    warn(fmt::format(
        "{}: the restored sun lights {:.3g} times as much as all the rest. The file has no unit: 1 is taken "
        "for 1 cd/m^2 (--scale-to sets another)",
        input, luminance_of(wanted) / rest));
}

std::string numbers(const Flux& f) { return fmt::format("{:.6g} {:.6g} {:.6g}", f.x, f.y, f.z); }

}  // namespace

void add_restore_sun(Options& o, SunOptions& sun) {
  Option& how = o.add("--restore-sun", "lux=E|irradiance=R,G,B|atmosphere", &sun.restore,
                      "Add the light that a clipped sun lost, to this illuminance of a plane that faces it");
  how.suggested = forms, how.folded = true;
  Option& radius = o.add("--sun-radius", "DEGREES", &sun.radius, range_of(limits::sun_radius),
                         "Angular radius of the restored disc (default: 0.2666)");
  radius.needs = "--restore-sun", radius.folded = true;
}

void restore(Source& source, const std::string& input, const SunOptions& options, Report& report) {
  if (options.restore.empty()) return;
  const double radius = options.radius.value_or(sun_radius_degrees);
  const RestoredSun sun = [&] {
    try {
      const Flux wanted = wanted_of(source, options.restore, radius);
      check_missing(source, input, wanted);
      return restore_sun(source.map, wanted, radius);
    } catch (const InputError& e) {
      throw InputError(input, e.what());
    }
  }();
  const Direction& d = sun.sun.towards;
  note(fmt::format(
      "{}: sun towards ({:.5f}, {:.5f}, {:.5f}), {} texels of one value: irradiance {} before, {} after; flux of "
      "the map {} before, {} after",
      input, d.x, d.y, d.z, sun.sun.texels, numbers(sun.irradiance_before), numbers(sun.irradiance_after),
      numbers(sun.flux_before), numbers(sun.flux_after)));
  report.put("sun.towards", d);
  report.put("sun.texels", sun.sun.texels);
  report.put("sun.radius", radius);
  report.put("sun.irradiance_before", Direction(sun.irradiance_before));
  report.put("sun.irradiance_after", Direction(sun.irradiance_after));
  report.put("sun.flux_before", Direction(sun.flux_before));
  report.put("sun.flux_after", Direction(sun.flux_after));
}

}  // namespace tools

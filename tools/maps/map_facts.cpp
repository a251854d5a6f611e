#include "maps/map_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/grade.h"
#include "maps/colour_and_light_options.h"

namespace tools {

using namespace envmap;

namespace {

// What the light of the map makes of a plane, in lux where the file says what radiance 1 is, and else with 1 cd/m^2.
double illuminance(const Source& s, const Direction& normal) {
  return s.provenance.white_luminance.value_or(1.0F) * glm::dot(irradiance(s.map, normal), luminance_weights(rec709));
}

// Texels with a channel as large as any: of a map that something has cut off there are many.
std::int64_t texels_at_most(const Level& level, double most) {
  const auto rows = map_level<std::int64_t>(level, [&](std::int64_t& count, int face, int row) {
    count = std::ranges::count_if(level.weighted_columns(row).of(level.row(face, row)), [&](const Colour& c) {
      const float largest = std::max({c.x, c.y, c.z});
      return std::isfinite(largest) && largest >= float(most);
    });
  });
  return std::accumulate(rows.begin(), rows.end(), std::int64_t{0});
}

double lux_of(const MapFacts& f, const DiscLight& sun) {
  return f.source.provenance.white_luminance.value_or(1.0F) * glm::dot(sun.irradiance, luminance_weights(rec709));
}

// All in one line.
std::string suns_of(const MapFacts& f) {
  std::string words;
  for (const DiscLight& sun : f.suns) {
    const auto [azimuth, elevation] = angles_of(sun.towards);
    words += fmt::format("{}azimuth {:.2f}, elevation {:.2f}: {:.4g} lux, {:.1f}% of the light",
                         words.empty() ? "" : "; ", azimuth, elevation, lux_of(f, sun), 100 * sun.share);
  }
  return words;
}

std::string numbers(const Direction& v) { return fmt::format("{:12.6g} {:12.6g} {:12.6g}", v.x, v.y, v.z); }

std::string space_of(const MapFacts& f) {
  return f.space.empty() ? words(f.source.claimed) : f.space + " (--input-space)";
}

}  // namespace

Angles angles_of(const Direction& d) {
  return {180 / pi * portable::atan2(d.x, d.z), 180 / pi * portable::atan2(d.y, std::sqrt(d.x * d.x + d.z * d.z))};
}

MapFacts facts_of(const Source& s, const std::string& file, const std::string& space,
                  const std::optional<Direction>& towards) {
  const Direction facing = unit_or_up(towards, "--towards");
  const Flaws flaws = find_flaws(s.map.base());
  const Measures m = measure(s.map);
  const double range = m.darkest > 0 && m.brightest > 0 ? m.brightest / m.darkest : std::nan("");
  const double most = std::max({m.maximum.x, m.maximum.y, m.maximum.z});
  return {s,
          file,
          space,
          facing,
          illuminance(s, facing),
          flaws,
          m,
          range,
          std::isfinite(range) ? portable::log2(range) : range,
          texels_at_most(s.map.base(), most),
          flaws.nan + flaws.infinite > 0 ? std::vector<DiscLight>{} : find_lights(s.map).lights};
}

void add(Report& report, const MapFacts& f) {
  const Source& s = f.source;
  const Level& level = s.map.base();
  const Measures& m = f.measures;
  report.put("file", f.file);
  report.put("format", s.format);
  report.put("depth", name(s.depth));
  report.put("width", s.image_width);
  report.put("height", s.image_height);
  report.put("projection", name(s.map.projection()));
  report.put("layout", name(s.layout));
  if (has_forward(s.map.projection())) report.put("forward", forward_names[std::size_t(s.map.forward)]);
  if (s.border_samples) report.put("border_samples", true);
  if (s.border > 0) report.put("border", s.border);
  report.put("levels", s.levels);
  report.put("faces", level.faces());
  report.put("face_width", level.width());
  report.put("face_height", level.height());
  report.put("space", space_of(f));
  for (const Claim& c : s.claims) {
    report.append("claims[]");
    report.put("claims[].name", c.name);
    report.put("claims[].value", c.value);
    report.put("claims[].outcome", name(c.outcome));
    if (!c.reason.empty()) report.put("claims[].reason", c.reason);
  }
  report.put("minimum", Direction(m.minimum));
  report.put("maximum", Direction(m.maximum));
  report.put("mean", Direction(m.mean));
  report.put("flux", Direction(m.flux));
  report.put("solid_angle", m.solid_angle);
  report.put("illuminance.towards", f.towards);
  report.put("illuminance.lux", f.illuminance);
  if (s.provenance.white_luminance) report.put("white_luminance", *s.provenance.white_luminance);
  report.put("dynamic_range", f.range);
  report.put("stops", f.stops);
  report.put("brightest.direction", m.brightest_direction);
  report.put("brightest.value", Direction(m.brightest_value));
  report.put("brightest.face", m.brightest_texel.face);
  report.put("brightest.texel", ReportValue::Texel{m.brightest_texel.i, m.brightest_texel.j});
  report.put("brightest.texels", m.brightest_texels);
  const auto [azimuth, elevation] = angles_of(m.brightest_direction);
  report.put("brightest.azimuth", azimuth);
  report.put("brightest.elevation", elevation);
  report.put("texels_at_maximum", f.texels_at_maximum);
  for (const DiscLight& sun : f.suns) {
    report.append("suns[]");
    report.put("suns[].towards", sun.towards);
    report.put("suns[].lux", lux_of(f, sun));
    report.put("suns[].share", sun.share);
  }
  for (const auto& [word, text] : s.facts) report.put_word("metadata", word, text);
  report.put("nan", f.flaws.nan);
  report.put("infinite", f.flaws.infinite);
  report.put("negative", f.flaws.negative);
  if (!f.flaws.first) return;
  report.put("first_flaw.face", f.flaws.first->face);
  report.put("first_flaw.texel", ReportValue::Texel{f.flaws.first->i, f.flaws.first->j});
}

FactLines lines_of(const MapFacts& f) {
  const Source& s = f.source;
  const Level& level = s.map.base();
  const Measures& m = f.measures;
  FactLines lines;
  const auto line = [&](const std::string& what, const std::string& value) { lines.emplace_back(what, value); };
  line("file", f.file);
  line("format", fmt::format("{} {}, {}x{}", s.format, name(s.depth), s.image_width, s.image_height));
  line("projection",
       fmt::format("{}{}{}", name(s.map.projection()), level.faces() == 6 ? fmt::format(" ({})", name(s.layout)) : "",
                   has_forward(s.map.projection())
                       ? fmt::format(", {} at the centre{}", forward_names[std::size_t(s.map.forward)],
                                     s.forward_is_assumed ? " (assumed, not specified in the file)" : "")
                       : ""));
  if (s.border_samples) line("", "OpenEXR envmap attribute: samples on the border, read as cell centres");
  if (s.border > 0) line("border", fmt::format("{} texels on each side, left out", s.border));
  line("faces", fmt::format("{} of {}x{}", level.faces(), level.width(), level.height()));
  if (s.levels > 1) line("levels", std::to_string(s.levels));
  for (const auto& [word, text] : s.facts) line(word, text);
  line("space", space_of(f));
  for (const Claim& c : s.claims)
    line(&c == s.claims.data() ? "claims" : "",
         fmt::format("{}: {} ({}{}{})", c.name, c.value, name(c.outcome), c.reason.empty() ? "" : ": ", c.reason));
  line("", fmt::format("{:>12} {:>12} {:>12}", "R", "G", "B"));
  line("minimum", numbers(Direction(m.minimum)));
  line("maximum", numbers(Direction(m.maximum)));
  line("mean", numbers(Direction(m.mean)));
  line("flux", numbers(Direction(m.flux)));
  const std::optional<float>& white = s.provenance.white_luminance;
  line("illuminance", fmt::format("{:12.6g} lux on a plane facing ({:g}, {:g}, {:g}); 1 is {:g} cd/m^2 ({})",
                                  f.illuminance, f.towards.x, f.towards.y, f.towards.z, double{white.value_or(1.0F)},
                                  white ? "whiteLuminance" : "assumed"));
  line("dynamic range", std::isfinite(f.stops) ? fmt::format("{:.6g} : 1 ({:.1f} stops)", f.range, f.stops)
                                               : "none: nothing is brighter than 0");
  const Direction& d = m.brightest_direction;
  const Texel& at = m.brightest_texel;
  line("brightest", fmt::format("{}  towards ({:.5f}, {:.5f}, {:.5f}), face {}, texel ({},{})",
                                numbers(Direction(m.brightest_value)), d.x, d.y, d.z, at.face, at.i, at.j));
  const auto [azimuth, elevation] = angles_of(d);
  const std::int64_t same = f.texels_at_maximum;
  const std::int64_t touching = m.brightest_texels;
  line("",
       fmt::format("azimuth {:.1f} degrees from +Z towards +X, elevation {:.1f}{}{}", azimuth, elevation,
                   touching > 1 ? fmt::format(": the middle of {} equal texels", touching) : "",
                   same > 1 ? fmt::format("; {} texels hold the maximum: clipped (convert --restore-sun), or a light "
                                          "of one value",
                                          same)
                            : ""));
  if (m.brightest > 0)
    line("", fmt::format("convert --rotate={:.6g},0,0 turns its azimuth to +Z, --rotate sun:+z turns it to +Z",
                         0.0 - azimuth));
  if (!f.suns.empty()) line(f.suns.size() == 1 ? "sun" : "suns", suns_of(f));
  line("flaws", fmt::format("{} NaN, {} infinite, {} negative", f.flaws.nan, f.flaws.infinite, f.flaws.negative));
  return lines;
}

}  // namespace tools

#include "facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "colour_options.h"
#include "command.h"
#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/measure.h"

namespace tools {

using namespace envmap;
using nlohmann::ordered_json;

namespace {

// What the light of the map makes of a plane, in lux where the file says what radiance 1 is, and else with 1 cd/m^2.
double illuminance(const Source& s, const Direction& normal) {
  return s.provenance.white_luminance.value_or(1.0F) * glm::dot(irradiance(s.map, normal), luminance_weights(rec709));
}

// Texels with a channel as large as any: of a map that something has cut off there are many.
std::int64_t texels_at_most(const Level& level, double most) {
  const auto rows = map_rows<std::int64_t>(level.faces() * level.height(), [&](int k) {
    const int face = k / level.height(), row = k % level.height();
    level.trim();
    return std::ranges::count_if(columns(level.projection(), level.height(), row).of(level.row(face, row)), [&](const Colour& c) {
      const float largest = std::max({c.x, c.y, c.z});
      return std::isfinite(largest) && largest >= static_cast<float>(most);
    });
  });
  return std::accumulate(rows.begin(), rows.end(), std::int64_t{0});
}

std::string numbers(const ordered_json& v) {
  return fmt::format("{:12.6g} {:12.6g} {:12.6g}", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

}  // namespace

Angles angles_of(const Direction& d) {
  return {180 / pi * portable::atan2(d.x, d.z), 180 / pi * portable::atan2(d.y, std::sqrt(d.x * d.x + d.z * d.z))};
}

ordered_json facts(const Source& s, const std::string& file, const std::string& space, const std::optional<Direction>& towards) {
  const Level& level = s.map.base();
  const Flaws flaws = find_flaws(level);
  const Measures m = measure(s.map);
  const double range = m.darkest > 0 && m.brightest > 0 ? m.brightest / m.darkest : std::nan("");
  ordered_json j;
  j["file"] = file;
  j["format"] = s.format;
  j["depth"] = name(s.depth);
  j["width"] = s.image_width;
  j["height"] = s.image_height;
  j["projection"] = name(s.map.projection());
  j["layout"] = name(s.layout);
  if (has_forward(s.map.projection())) j["forward"] = forward_names[static_cast<std::size_t>(s.map.forward)];
  if (s.border_samples) j["border_samples"] = true;
  if (s.border > 0) j["border"] = s.border;
  j["levels"] = s.levels;
  j["faces"] = level.faces();
  j["face_width"] = level.width();
  j["face_height"] = level.height();
  j["space"] = space.empty() ? words(s.claimed) : space + " (--input-space)";
  const Direction facing = unit_or_up(towards, "--towards");
  j["minimum"] = to_json(m.minimum);
  j["maximum"] = to_json(m.maximum);
  j["mean"] = to_json(m.mean);
  j["flux"] = to_json(m.flux);
  j["solid_angle"] = m.solid_angle;
  j["illuminance"] = {{"towards", to_json(facing)}, {"lux", illuminance(s, facing)}};
  if (s.provenance.white_luminance) j["white_luminance"] = *s.provenance.white_luminance;
  j["dynamic_range"] = range;
  j["stops"] = std::isfinite(range) ? portable::log2(range) : range;
  j["brightest"] = {{"direction", to_json(m.brightest_direction)},
                    {"value", to_json(Direction(m.brightest_value))},
                    {"face", m.brightest_texel.face},
                    {"texel", {m.brightest_texel.i, m.brightest_texel.j}}};
  const auto [azimuth, elevation] = angles_of(m.brightest_direction);
  j["brightest"].update({{"azimuth", azimuth}, {"elevation", elevation}});
  const double most = std::max({m.maximum.x, m.maximum.y, m.maximum.z});
  j["texels_at_maximum"] = texels_at_most(level, most);
  for (const auto& [key, text] : s.facts) j["metadata"][key] = text;
  j["nan"] = flaws.nan;
  j["infinite"] = flaws.infinite;
  j["negative"] = flaws.negative;
  if (flaws.first) j["first_flaw"] = {{"face", flaws.first->face}, {"texel", {flaws.first->i, flaws.first->j}}};
  return j;
}

FactLines lines_of(const ordered_json& j) {
  FactLines lines;
  const auto text = [&](const char* key) { return j[key].get<std::string>(); };
  const auto line = [&](const char* what, const std::string& value) { lines.emplace_back(what, value); };
  line("file", text("file"));
  line("format", fmt::format("{} {}, {}x{}", text("format"), text("depth"), j["width"].get<int>(), j["height"].get<int>()));
  line("projection", fmt::format("{}{}{}", text("projection"), j["faces"] == 6 ? " (" + text("layout") + ")" : "",
                                 j.contains("forward") ? ", " + text("forward") + " at the centre" : ""));
  if (j.contains("border_samples")) line("", "OpenEXR envmap attribute: samples on the border, read as cell centres");
  if (j.contains("border")) line("border", fmt::format("{} texels on each side, left out", j["border"].get<int>()));
  line("faces", fmt::format("{} of {}x{}", j["faces"].get<int>(), j["face_width"].get<int>(), j["face_height"].get<int>()));
  if (const int count = j["levels"].get<int>(); count > 1) line("levels", std::to_string(count));
  if (j.contains("metadata"))
    for (const auto& [key, value] : j["metadata"].items()) line(key.c_str(), value.get<std::string>());
  line("space", text("space"));
  line("", fmt::format("{:>12} {:>12} {:>12}", "R", "G", "B"));
  for (const char* key : {"minimum", "maximum", "mean", "flux"}) line(key, numbers(j[key]));
  const ordered_json &lit = j["illuminance"], &n = lit["towards"];
  line("illuminance",
       fmt::format("{:12.6g} lux on a plane facing ({:g}, {:g}, {:g}); 1 is {:g} cd/m^2{}", lit["lux"].get<double>(), n[0].get<double>(),
                   n[1].get<double>(), n[2].get<double>(), j.value("white_luminance", 1.0),
                   j.contains("white_luminance") ? " (whiteLuminance)" : " (taken so)"));
  if (std::isfinite(j["stops"].get<double>()))
    line("dynamic range",
         fmt::format("{:.6g} : 1 ({:.1f} stops)", j["dynamic_range"].get<double>(), j["stops"].get<double>()));
  else
    line("dynamic range", "none: nothing is brighter than 0");
  const ordered_json& b = j["brightest"];
  line("brightest",
       fmt::format("{}  towards ({:.5f}, {:.5f}, {:.5f}), face {}, texel ({},{})", numbers(b["value"]),
                   b["direction"][0].get<double>(), b["direction"][1].get<double>(), b["direction"][2].get<double>(),
                   b["face"].get<int>(), b["texel"][0].get<int>(), b["texel"][1].get<int>()));
  const auto same = j["texels_at_maximum"].get<std::int64_t>();
  line("", fmt::format("azimuth {:.1f} degrees from +Z towards +X, elevation {:.1f}{}", b["azimuth"].get<double>(),
                       b["elevation"].get<double>(),
                       same > 1 ? fmt::format("; {} texels hold the maximum (clipped?)", same) : ""));
  line("flaws", fmt::format("{} NaN, {} infinite, {} negative", j["nan"].get<long>(), j["infinite"].get<long>(),
                            j["negative"].get<long>()));
  return lines;
}

}  // namespace tools

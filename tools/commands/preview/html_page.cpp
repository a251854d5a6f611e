#include "commands/preview/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cli/console.h"
#include "cli/embedded.h"
#include "cli/report.h"
#include "envmap/io/texels/api_orientation.h"
#include "envmap/io/texels/texture_file.h"
#include "envmap/map/rows.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/brdf_table.h"
#include "envmap/prefilter/prefilter.h"
#include "maps/map_facts.h"

namespace tools {
namespace {

using namespace envmap;

// RFC 4648, section 4.
std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const auto byte = [&](std::size_t n) {
      return k + n < bytes.size() ? std::to_integer<std::uint32_t>(bytes[k + n]) : 0U;
    };
    const std::uint32_t word = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (int d = 0; d < 4; ++d) out += digits[word >> (18 - 6 * d) & 63];
    for (std::size_t n = bytes.size() - k; n < 3; ++n) out[out.size() - (3 - n)] = '=';
  }
  return out;
}

// The faces of a cube as WebGL takes them, over `scale`.
std::string texels_of(const Level& cube, double scale) {
  const Rows rows = rows_of(cube, Forward::plus_z), stored = in_api_orientation(rows);
  const auto size = std::size_t(cube.height());
  std::vector<std::byte> bytes(6 * size * size * sizeof(std::uint32_t));
  std::vector<Colour> row(size);
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t j = 0; j < size; ++j) {
      stored.fill(int(face), int(j), row);
      for (Colour& c : row) c = glm::max(c * float(1 / scale), Colour(0));
      encode(Texels::rgb9e5, row,
             std::span(bytes).subspan((face * size + j) * size * sizeof(std::uint32_t), size * sizeof(std::uint32_t)));
    }
  return base64(bytes);
}

// A level of a texture of the page: a name, and the cube's texels where the page does not have them yet.
struct PageLevel {
  std::string name;
  int size;
  std::string texels = {};
};

PageLevel page_level(std::string name, const Level& cube, double scale) {
  return {std::move(name), cube.height(), texels_of(cube, scale)};
}

void add(Report& data, const std::string& texture, const PageLevel& level) {
  const std::string levels = "textures." + texture + ".levels[]";
  data.append(levels);
  data.put(levels + ".name", level.name);
  data.put(levels + ".size", level.size);
  if (!level.texels.empty()) data.put(levels + ".texels", level.texels);
}

// The power of 2 that brings the brightest texel into what the format holds.
double scale_for(const Source& source) {
  const Measures m = measure(source.map);
  const double most = std::max({m.maximum.x, m.maximum.y, m.maximum.z});
  return most <= largest_rgb9e5 ? 1 : portable::exp2(std::ceil(portable::log2(most / largest_rgb9e5)));
}

// The file's levels, each as a cube half as large as the one before.
void add_map(Report& data, const EnvironmentMap& map, int size, double scale) {
  for (std::size_t k = 0; k < map.levels.size() && size >> k > 0; ++k) {
    EnvironmentMap one{.levels = {}, .forward = map.forward};
    one.levels.push_back(map.levels[k].clone());
    const EnvironmentMap cube = convert(one, {.to = {Projection::cube}, .size = size >> k});
    add(data, "map", page_level(map.levels.size() > 1 ? fmt::format("level {}", k) : "the map", cube.base(), scale));
  }
}

// Roughness k / (n - 1) on faces of size / 2^k, down to 8 texels. Roughness 0 is the map, which the page has already.
void add_ggx(Report& data, const Prefilterer& source, int size, double scale) {
  constexpr int least = 8;
  int count = 2;
  while (size >> count >= least) ++count;
  add(data, "ggx", {"the map, blurred", size});
  for (int k = 1; k < count; ++k) {
    const double roughness = double(k) / (count - 1);
    const Prefiltered made =
        source.make({.lobe = Lobe::ggx(roughness), .size = std::max(1, size >> k), .max_error = 1e-2});
    add(data, "ggx", page_level(fmt::format("GGX, roughness {:.2g}", roughness), made.map.base(), scale));
  }
}

// What of white light a surface of index 1.5 reflects: columns cosine, rows roughness. Its largest error is near
// cosine 0, where Schlick's term bends most: 20 / 8 size^2.
void add_dielectric(Report& data) {
  constexpr std::size_t size = 32;
  std::vector<Colour> part = brdf_table(int(size));
  for (Colour& c : part) c = Colour(0.04F * c.x + c.y);
  std::vector<std::byte> bytes(size * size * sizeof(std::uint32_t));
  encode(Texels::rgb9e5, part, bytes);
  data.put("dielectric.size", int(size));
  data.put("dielectric.texels", base64(bytes));
}

double azimuth_of(Forward forward) {
  constexpr double degrees[] = {0, 180, 90, -90};
  return degrees[std::size_t(forward)];
}

// {{name}} becomes the text of that name.
std::string filled(std::string_view page, const std::vector<std::pair<std::string_view, std::string>>& texts) {
  std::string out;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t open = page.find("{{", at), close = page.find("}}", open);
    out += page.substr(at, open - at);
    if (open == page.npos) break;
    const auto found =
        std::ranges::find(texts, page.substr(open + 2, close - open - 2), [](const auto& t) { return t.first; });
    if (found != texts.end()) out += found->second;
    at = close + 2;
  }
  return out;
}

std::string json_in_html(const Report& data) {
  std::string out;
  for (const char c : data.line()) out += c == '<' ? "\\u003c" : std::string(1, c);
  return out;
}

}  // namespace

std::string html_page(const Source& source, const PageOptions& o) {
  const double scale = scale_for(source);
  const Prefilterer prefilter(borrowed(source.map));
  const std::string divided =
      scale > 1 ? fmt::format(", after a division by {:g} that brings the brightest into it", scale) : "";
  Report data;
  data.put("forward", azimuth_of(source.map.forward));
  data.put("scale", scale);
  data.put("exposure", std::clamp(std::round(4 * portable::log2(o.scale)) / 4, -12.0, 12.0));
  data.put("curve", display_names[std::size_t(o.display)]);
  data.put_array("facts");
  for (const auto& [what, value] : lines_of(facts_of(source, o.file, o.space)))
    data.append("facts[]", ReportValue(std::vector<std::string>{what, value}));
  data.put("honest",
           fmt::format("Cubes of {0} x {0} texels a face, made by 'envmap convert'; radiance in RGB9E5: within 1/512 "
                       "of the largest channel of a texel{1}. "
                       "GGX with n = v = r and no Fresnel term, and diffuse light, by 'envmap prefilter' within 1%; "
                       "between its levels roughness is interpolated. "
                       "Plastic reflects the part of GGX that the split sum gives for an index of 1.5, and is diffuse "
                       "below.",
                       o.size, divided));
  add_map(data, source.map, o.size, scale);
  add_ggx(data, prefilter, o.size, scale);
  const Prefiltered diffuse = prefilter.make({.lobe = Lobe::diffuse(), .size = 32, .max_error = 1e-2});
  add(data, "diffuse", page_level("diffuse light, white", diffuse.map.base(), scale));
  add_dielectric(data);
  return filled(page_source("page.html"), {{"title", in_markup(o.file)},
                                           {"style", std::string(page_source("page.css"))},
                                           {"shader", std::string(page_source("page.glsl"))},
                                           {"script", std::string(page_source("page.js"))},
                                           {"data", json_in_html(data)}});
}

}  // namespace tools

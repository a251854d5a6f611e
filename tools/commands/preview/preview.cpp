// A picture for people: maps side by side, tone mapped with one exposure, named;
// with what they light and how bright they are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "command.h"
#include "commands/preview/html_page.h"
#include "drawing/map_picture.h"
#include "envmap/base/error.h"
#include "envmap/io/claims/colour.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/images/picture.h"
#include "envmap/light/lights.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/matching_size.h"
#include "maps/depfile.h"
#include "maps/map_facts.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

struct Request {
  std::vector<std::string> names;  // Inputs, then the output.
  ReadOptions read;
  std::vector<Projection> from;  // Of all inputs, or of each.
  std::optional<double> exposure, percentile;
  std::optional<Display> display;
  std::optional<std::string> view;
  std::optional<int> face;
  std::string html;
  int height = 256, columns = 3, size = 0;
  bool levels = false, marks = false, balls = false, histogram = false, sheet = false;
};

// How all maps are shown, so that they can be compared: as is right for the first.
struct Look {
  double scale;
  Display display;  // Where no view of a config is asked for.
  Show show;
};

// Files of 8 and 16 bits are made to be looked at: white stays white.
bool is_for_screens(const Source& source) { return source.depth == Depth::uint8 || source.depth == Depth::uint16; }

double scale_for(const Source& source, const Request& o) {
  if (o.exposure) return portable::exp2(*o.exposure);
  if (o.percentile) {
    const double white = Luminances(source.map.base()).percentile(0.01 * *o.percentile);
    return white > 0 ? 1 / white : 1;
  }
  if (is_for_screens(source)) return 1;
  const double mean = mean_radiance(source.map.base());
  return mean > 0 ? 0.4 / mean : 1;
}

Look look_for(const Source& source, const Request& o) {
  const double scale = scale_for(source, o);
  if (o.view) {
    const ColourTransform view = into_view(o.read.colour, *o.view);
    settings().also_read.insert(settings().also_read.end(), view.files.begin(), view.files.end());
    return {scale, Display::reinhard, [view, scale](std::span<Colour> pixels) {
              for (Colour& c : pixels) c *= float(scale);
              if (view.apply) view.apply(pixels);
              for (Colour& c : pixels) c = glm::clamp(c, Colour(0), Colour(1));
            }};
  }
  const Display display = o.display.value_or(is_for_screens(source) ? Display::clip : Display::reinhard);
  return {scale, display, [display, scale](std::span<Colour> pixels) {
            show(pixels, display, scale);
            encode_srgb(pixels);
          }};
}

// The number of the face that was asked for: a paraboloid map has +Z and -Z.
std::optional<int> face_of(const Request& o, const Source& source, const std::string& input) {
  if (!o.face) return std::nullopt;
  constexpr int first_of_pair = 4;  // pz.
  const Projection p = source.map.projection();
  const int face = p == Projection::paraboloid ? *o.face - first_of_pair : *o.face;
  if (faces(p) == 1 || face < 0)
    throw UsageError(input, fmt::format("--face {}: a {} map has none of that name",
                                        cube_face_names[std::size_t(*o.face)], name(p)));
  return face;
}

// Of a prefiltered level, such as ", roughness 0.2".
std::string lobe_in_words(const Facts& facts, std::size_t level) {
  const auto value = [&](const char* parameter) {
    const auto found = facts.find(parameter);
    const std::vector<std::string> all = found == facts.end() ? std::vector<std::string>() : split(found->second, ',');
    return level < all.size() ? all[level] : "";
  };
  if (const std::string roughness = value("roughness"); !roughness.empty())
    return fmt::format(", roughness {:.3g}", std::strtod(roughness.c_str(), nullptr));
  const std::string exponent = value("exponent");
  return exponent.empty() ? "" : ", exponent " + exponent;
}

// The brightest direction first, then the lights that 'envmap lights' finds elsewhere.
std::vector<Direction> lights_of(const EnvironmentMap& map) {
  constexpr double apart = pi / 180;
  std::vector<Direction> lights{measure(map).brightest_direction};
  if (const Flaws flaws = find_flaws(map.base()); flaws.nan + flaws.infinite > 0) return lights;
  for (const DiscLight& light : find_lights(map).lights)
    if (angle_between(light.towards, lights.front()) > std::max(apart, light.radius_degrees * apart))
      lights.push_back(light.towards);
  return lights;
}

// The map, or all its levels.
std::vector<Tile> maps_of(const Source& source, const std::string& input, const Look& look, const Request& o) {
  const std::string name = std::filesystem::path(input).filename().string();
  const std::optional<int> face = face_of(o, source, input);
  std::vector<Tile> tiles;
  for (std::size_t k = 0; k < source.map.levels.size(); ++k) {
    MapPicture map(source.map.levels[k], face, look.show, o.height);
    std::string caption = name;
    if (o.levels && source.map.levels.size() > 1)
      caption += fmt::format(" level {}{}", k, lobe_in_words(source.facts, k));
    if (o.marks && k == 0) {
      const std::vector<Direction> lights = lights_of(source.map);
      map.mark(source.map, lights);
      const Angles at = angles_of(lights.front());
      if (!face)
        caption += fmt::format("; ring: brightest, azimuth {:.1f}, elevation {:.1f}", at.azimuth, at.elevation);
    }
    tiles.push_back({std::move(map.picture()), std::move(caption)});
  }
  return tiles;
}

// Below the maps: what one of them lights, and how bright it is. @param before captions: its name, of several.
void add_studies(std::vector<TileRow>& rows, const Source& source, const std::string& before, const Look& look,
                 int width, const Request& o) {
  constexpr int balls = 5;
  if (o.balls) {
    TileRow lit = lit_balls(source.map, look.show, (width - (balls - 1) * sheet_border) / balls);
    lit.front().caption = before + lit.front().caption;
    rows.push_back(std::move(lit));
  }
  if (!o.histogram) return;
  const double white = 1 / look.scale;
  rows.push_back(
      {{histogram(Luminances(source.map.base()), white, {width, o.height / 2}),
        fmt::format("{}stops of luminance. Grey: share of the sphere, orange: of light, line: shown white ({:.3g})",
                    before, white)}});
}

int width_of(const std::vector<TileRow>& rows) {
  int most = 640;
  for (const TileRow& row : rows) {
    int sum = -sheet_border;
    for (const Tile& tile : row) sum += tile.picture.size.width + sheet_border;
    most = std::max(most, sum);
  }
  return most;
}

void check_page(Request& o) {
  if (o.names.size() != 1) throw UsageError("--html takes exactly one map and no output image");
  if (o.sheet || o.levels || o.marks || o.balls || o.histogram || o.face || o.view)
    throw UsageError(
        "--html has all of a map: remove --sheet, --marks, --levels, --balls, --histogram, --face and --view");
  o.read.all_levels = o.read.level == 0;
}

void check(Request& o) {
  if (o.sheet) o.marks = o.balls = o.histogram = o.levels = true;
  if (o.levels && o.read.level > 0) throw UsageError("--levels shows all of them: remove --level");
  if (!o.html.empty()) return check_page(o);
  if (o.names.size() < 2) throw UsageError("needs at least one map, and last the picture to write");
  if (o.names.back() != "-" && (!is_picture(o.names.back()) || is_linear_picture(o.names.back())))
    throw UsageError(o.names.back(), "the picture must be a .png or .jpg; --html FILE writes a page");
  o.read.all_levels = o.levels;
}

// How the input of that number is read.
ReadOptions reading(const Request& o, std::size_t input) {
  ReadOptions read = o.read;
  if (!o.from.empty()) read.projection = o.from[o.from.size() == 1 ? 0 : input];
  return read;
}

int write_page(const Request& o) {
  const std::string& input = o.names.front();
  check_files({o.html}, {input}, {{}, o.read.faces});
  const Source source = read_map(input, reading(o, 0));
  const Look look = look_for(source, o);
  const int density = matching_size(source.map.projection(), source.map.base().height(), Projection::cube);
  const std::string page = html_page(source, {.file = std::filesystem::path(input).filename().string(),
                                              .space = o.read.colour.space,
                                              .scale = look.scale,
                                              .display = look.display,
                                              .size = o.size > 0 ? o.size : std::clamp(density, 16, 256)});
  open_depfile();
  write_text(o.html, page);
  note(fmt::format("{}: {:.1f} MB", o.html == "-" ? "standard output" : o.html, 1e-6 * double(page.size())));
  return 0;
}

int run(Request& o) {
  check(o);
  if (const std::size_t maps = o.html.empty() ? o.names.size() - 1 : 1; o.from.size() > 1 && o.from.size() != maps)
    throw UsageError(
        fmt::format("--from: {} projections for {} maps, not one for all or one for each", o.from.size(), maps));
  if (!o.html.empty()) return write_page(o);
  const std::string& output = o.names.back();
  const std::vector<std::string> inputs(o.names.begin(), o.names.end() - 1);
  check_files({output}, inputs, {{}, o.read.faces});
  std::vector<Tile> maps;
  std::vector<Source> sources;  // For the studies below.
  std::optional<Look> look;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const std::string& input = inputs[k];
    Source source = read_map(input, reading(o, k));
    if (!look) look = look_for(source, o);
    for (Tile& tile : maps_of(source, input, *look, o)) maps.push_back(std::move(tile));
    if (o.balls || o.histogram) sources.push_back(std::move(source));
  }
  std::vector<TileRow> rows = in_columns(std::move(maps), o.columns);
  const int width = width_of(rows);
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const std::string name = std::filesystem::path(inputs[k]).filename().string();
    add_studies(rows, sources[k], inputs.size() > 1 ? name + ": " : "", *look, width, o);
  }
  open_depfile();
  const Picture sheet = sheet_of(rows);
  write_stored(output, sheet.size.width, sheet.pixels, Depth::uint8, {.commit = settings().commit});
  return 0;
}

void add_parts(Options& o, Request& r) {
  o.group = "Picture";
  o.flag("--sheet", r.sheet, "Draw --marks, --levels, --balls and --histogram");
  o.flag("--marks", r.marks, "Mark the world axes, the horizon, cube faces and the brightest direction");
  o.flag("--levels", r.levels, "Draw all mip levels of each map");
  o.flag("--balls", r.balls, "Draw a mirror, rough metal and white diffuse balls lit by each map");
  o.flag("--histogram", r.histogram, "Draw a histogram of luminance in stops, by solid angle and by light");
  o.add("--face", one_of(r.face, cube_face_names), "Draw one face of a cube or paraboloid map: {}");
  o.add("--height", "N", &r.height, {16, 4096}, "Height of each picture (default: 256)");
  o.add("--columns", "N", &r.columns, {1, 64}, "Pictures per row (default: 3)");
}

void add_tone_curve(Options& o, Request& r) {
  o.group = "Exposure and tone curve";
  o.add("--exposure", "STOPS", &r.exposure, {-100, 100},
        "Multiply radiance by 2^STOPS (default: mean becomes middle grey)");
  o.add("--percentile", "P", &r.percentile, {0, 100}, "Expose so that P percent of the sphere is at most 1").excludes =
      "--exposure";
  add_display(o, r.display, Display::reinhard);
  o.add("--view", "VIEW", &r.view, "OpenColorIO view instead of --display: VIEW or DISPLAY:VIEW").excludes =
      "--display";
}

// --from has a word for each map, too.
void add_projections(Options& o, Request& r) {
  Option& from = o["--from"];
  from.help = "Projection of all inputs, or P1,P2,... of each (default: metadata, then image shape)";
  from.parse = [&r](const std::string& words) {
    for (const std::string& word : split(words, ',')) {
      const auto projection = projection_named(word);
      if (!projection) return false;
      r.from.push_back(*projection);
    }
    return true;
  };
}

}  // namespace

Action define_preview(Options& o) {
  const auto r = std::make_shared<Request>();
  o.files(r->names, File::inputs_then_output, "Maps, and last the .png or .jpg to write (not with --html)")
      .all_inputs_with = "--html";
  add_parts(o, *r);
  add_tone_curve(o, *r);
  o.group = "Page";
  o.add("--html", "FILE", &r->html, "Write an interactive page of one map instead of a picture").file = File::output;
  o.add("--size", "N", &r->size, {16, 2048}, "Height of the cube faces in the page (default: the map's, at most 256)")
      .needs = "--html";
  add_read_options(o, r->read);
  add_projections(o, *r);
  add_repair(o, r->read);
  return [r](Report&) { return run(*r); };
}

}  // namespace tools

#include "photos/photo.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/images/picture.h"
#include "envmap/operate/find_circle.h"
#include "envmap/operate/photo_map.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::array<std::string_view, 3> photo_words{"fisheye", "equisolid", "half-paraboloid"};

std::string words(const Circle& c) { return fmt::format("{:.2f},{:.2f},{:.2f}", c.x, c.y, c.radius); }

// Nothing of "find". @param option that it is of. @throws UsageError.
std::optional<Circle> circle_in(const std::string& text, std::string_view option = "--circle") {
  if (text == "find") return std::nullopt;
  const auto numbers = triple_of(text);
  if (!numbers || numbers->z < least_radius)
    throw UsageError(fmt::format("{}: '{}' is neither 'find' nor X,Y,R with a radius of {} pixels or more", option,
                                 text, least_radius));
  return Circle{numbers->x, numbers->y, numbers->z};
}

// The photo with the circle on it, made smaller by a whole number.
Picture with_circles(const Level& photo, std::span<const Circle> circles) {
  constexpr int longest = 1600;
  const int by = (std::max(photo.width(), photo.height()) + longest - 1) / longest;
  Picture picture({std::max(1, photo.width() / by), std::max(1, photo.height() / by)}, Colour(0));
  for (int j = 0; j < picture.size.height; ++j)
    for (int i = 0; i < picture.size.width; ++i) {
      Flux sum(0);
      for (int b = 0; b < by; ++b)
        for (int a = 0; a < by; ++a)
          sum +=
              Flux(*photo.texel(0, std::min(by * i + a, photo.width() - 1), std::min(by * j + b, photo.height() - 1)));
      picture.at(i, j) = Colour(sum / double(by * by));
    }
  show(picture.pixels, Display::neutral);
  encode_srgb(picture.pixels);
  for (const Circle& c : circles) {
    draw_ring(picture, c.x / by, c.y / by, c.radius / by);
    draw_ring(picture, c.x / by, c.y / by, 3);
  }
  return picture;
}

// Part of a picture, from (x,y) on.
struct Part {
  int x = 0, y = 0, width, height;
};

std::optional<FoundCircle> find_in(const Level& photo, const Part& part) {
  Level level(photo.projection(), part.height, part.width);
  for (int j = 0; j < part.height; ++j)
    std::ranges::copy(photo.row(0, part.y + j).subspan(std::size_t(part.x), std::size_t(part.width)),
                      level.row(0, j).begin());
  auto found = find_circle(level);
  if (found) found->circle.x += part.x, found->circle.y += part.y;
  if (found && found->rival) found->rival->x += part.x, found->rival->y += part.y;
  return found;
}

// @param option that asks for it. @throws InputError where no circle is sure; the one that was thought of is then drawn
// at once.
Circle find(const std::string& path, const PhotoOptions& photo, const Level& pixels, const Part& part,
            std::string_view option, Report& report) {
  const auto found = find_in(pixels, part);
  if (!found)
    throw InputError(path, fmt::format("no circle found: use {} X,Y,R, in pixels from the upper left corner", option));
  const FoundCircle& f = *found;
  const std::string what = fmt::format("{} (an edge follows {:.0f}% of it and scatters by {:.2f} pixels)",
                                       words(f.circle), 100 * f.support, f.spread);
  if (!f.sure()) {
    if (!photo.picture.empty()) write_circle(photo, with_circles(pixels, std::array{f.circle}));
    const std::string both = photo.of == PhotoOf::ball ? "" : ", or both: --back-circle find";
    throw InputError(path, f.rival ? fmt::format("there are two circles: use {} {} or {} {}{}", option, words(f.circle),
                                                 option, words(*f.rival), both)
                                   : fmt::format("not sure of {} {}: use {} X,Y,R", option, what, option));
  }
  note(fmt::format("envmap convert: {}: found {} {}", path, option, what));
  const std::string key = option == "--circle" ? "circle" : "back_circle";
  report.put(key + ".support", f.support);
  report.put(key + ".spread", f.spread);
  return f.circle;
}

void tell_circle(const std::string& key, const Circle& c, Report& report) {
  report.put(key + ".x", c.x);
  report.put(key + ".y", c.y);
  report.put(key + ".radius", c.radius);
}

// Halves of a picture with two lenses side by side: the left or the upper one, and the other.
std::array<Part, 2> halves(const Level& pixels) {
  const int w = pixels.width(), h = pixels.height();
  if (w >= h) return {Part{0, 0, w / 2, h}, Part{w / 2, 0, w - w / 2, h}};
  return {Part{0, 0, w, h / 2}, Part{0, h / 2, w, h - h / 2}};
}

bool in_one_picture(const PhotoOptions& photo) { return !photo.back_circle.empty() && photo.back.empty(); }

Circle circle_of(const std::string& path, const PhotoOptions& photo, const Level& pixels, Report& report) {
  const double width = pixels.width(), height = pixels.height();
  Circle c{width / 2, height / 2, std::min(width, height) / 2};
  const Part where = in_one_picture(photo) ? halves(pixels)[0] : Part{0, 0, pixels.width(), pixels.height()};
  if (!photo.circle.empty()) {
    const auto given = circle_in(photo.circle);
    c = given ? *given : find(path, photo, pixels, where, "--circle", report);
  }
  tell_circle("circle", c, report);
  return c;
}

// The circle of the back, where it is not that of the front.
std::optional<Circle> back_circle_of(const std::string& path, const PhotoOptions& photo, const Level& back,
                                     Report& report) {
  const bool find_both = photo.circle == "find" && !photo.back.empty();
  if (photo.back_circle.empty() && !find_both) return std::nullopt;
  const auto given = photo.back_circle.empty() ? std::nullopt : circle_in(photo.back_circle, "--back-circle");
  const Part where = in_one_picture(photo) ? halves(back)[1] : Part{0, 0, back.width(), back.height()};
  const Circle c =
      given ? *given : find(photo.back.empty() ? path : photo.back, photo, back, where, "--back-circle", report);
  tell_circle("back_circle", c, report);
  return c;
}

void tell_covered(const std::string& path, double covered, bool back, Report& report) {
  report.put("covered", covered);
  if (covered < 0.9999)
    note(fmt::format("envmap convert: {} {} {:.4g}% of all directions; the rest is black", path,
                     back ? "and its back show" : "shows", 100 * covered));
}

EnvironmentMap map_of(const std::string& path, const PhotoOptions& photo, const Level& pixels, const Level* back,
                      const ReadOptions& read, PhotoSource& made, Report& report) {
  const PhotoMapOptions how{.max_memory = read.max_memory, .max_pixels = read.max_pixels, .progress = {}};
  if (photo.of == PhotoOf::half_paraboloid) {
    EnvironmentMap map = paraboloid_map(pixels, back);
    tell_covered(path, back ? 1 : 0.5, back != nullptr, report);
    return map;
  }
  const Circle circle = circle_of(path, photo, pixels, report);
  if (in_one_picture(photo)) back = &pixels;
  const auto back_circle = back ? back_circle_of(path, photo, *back, report) : std::nullopt;
  std::vector<Circle> drawn{circle};
  if (back_circle && back == &pixels) drawn.push_back(*back_circle);
  if (!photo.picture.empty()) made.circle = with_circles(pixels, drawn);
  if (photo.of == PhotoOf::ball) return ball_map(pixels, circle, how);
  const Fisheye lens{.model = photo.of == PhotoOf::fisheye ? LensModel::equidistant : LensModel::equisolid,
                     .half = photo.field.value_or(180) * (pi / 360),
                     .circle = circle,
                     .width = pixels.width(),
                     .height = pixels.height()};
  std::optional<Fisheye> back_lens;
  if (back_circle)
    back_lens = Fisheye{.model = lens.model,
                        .half = lens.half,
                        .circle = *back_circle,
                        .width = back->width(),
                        .height = back->height()};
  FisheyeMap shown = fisheye_map(pixels, lens, back, how, back_lens);
  tell_covered(path, shown.covered, back != nullptr, report);
  return std::move(shown.map);
}

}  // namespace

void add_photo_words(Options& o, PhotoOptions& photo, ReadOptions& read) {
  Option& from = o["--from"];
  for (const std::string_view word : photo_words) from.words.emplace_back(word);
  from.help = "Also fisheye equisolid half-paraboloid (default: metadata, then image shape)";
  from.parse = [&photo, &read](const std::string& word) {
    const int lens = index_of(word, photo_words);
    photo.of = lens >= 0 ? std::optional(PhotoOf(lens + 1)) : std::nullopt;
    read.projection = lens >= 0 ? std::nullopt : projection_named(word);
    return photo.of || read.projection;
  };
}

void add_circle(Options& o, PhotoOptions& photo) {
  o.add("--circle", "X,Y,R|find", &photo.circle, "Ball or fisheye in the photo, in pixels (--circle-picture draws it)");
  Option& picture = o.add("--circle-picture", "FILE", &photo.picture, "Draw the circle over the photo");
  picture.file = File::output, picture.folded = true;
  o.add("--back", "FILE", &photo.back, "Photo of the other half, or --back-circle X,Y,R in the same picture").file =
      File::input;
  o.add("--back-circle", "X,Y,R|find", &photo.back_circle,
        "Circle of the other half, in --back FILE or in the same picture")
      .folded = true;
}

void resolve_photo_options(PhotoOptions& photo, const ReadOptions& read) {
  if (!photo.circle.empty() && !photo.of && read.projection == Projection::sphere) photo.of = PhotoOf::ball;
  const bool round = photo.of && photo.of != PhotoOf::half_paraboloid;
  const bool lens = round && photo.of != PhotoOf::ball;
  if (!photo.circle.empty() && !round) throw UsageError("--circle is for --from sphere, fisheye and equisolid");
  if (!photo.circle.empty()) (void)circle_in(photo.circle);
  if (!photo.back_circle.empty() && (!lens || photo.circle.empty()))
    throw UsageError("--back-circle is for --from fisheye and equisolid with --circle");
  if (!photo.back_circle.empty()) (void)circle_in(photo.back_circle, "--back-circle");
  if (!photo.picture.empty() && !round) throw UsageError("--circle-picture draws the circle: use --circle, too");
  if (!photo.picture.empty() && (!is_picture(photo.picture) || is_linear_picture(photo.picture)))
    throw UsageError(photo.picture, "--circle-picture must be a .png or .jpg");
  if (!photo.back.empty() && !lens && photo.of != PhotoOf::half_paraboloid)
    throw UsageError("--back is for --from fisheye, equisolid and half-paraboloid");
  if (photo.field && !lens)
    throw UsageError("--fov is for --from fisheye and equisolid, and for --to perspective, fisheye and cylinder");
  if (photo.of && (read.level > 0 || read.layout || read.border || read.ignore_envmap_attribute ||
                   read.border_samples || read.apply_pose))
    throw UsageError(
        "--level, --from-layout, --from-border, --ignore-envmap-attribute, --border-samples and --apply-pose are for "
        "maps, not for photos");
  if (photo.of && !lens && read.forward)
    throw UsageError("--from-forward is for latlong and angular maps and for fisheyes: use --rotate");
}

void tell_range(const std::string& path, const Source& photo) {
  if (is_integer(photo.depth))
    note(fmt::format("envmap convert: {}: holds no values above 1: lights that are brighter were clipped", path));
}

PhotoSource read_photo(const std::string& path, const PhotoOptions& photo, const ReadOptions& read, Report& report) {
  PhotoSource made{.source = read_picture(path, read), .circle = {}};
  tell_range(path, made.source);
  std::optional<Source> back;
  if (!photo.back.empty()) back = read_picture(photo.back, read);
  Source& source = made.source;
  try {
    EnvironmentMap map = map_of(path, photo, source.map.base(), back ? &back->map.base() : nullptr, read, made, report);
    source.map.levels = std::move(map.levels);
  } catch (const InputError& e) {
    if (!e.file().empty()) throw;
    throw InputError(path, e.what(), e.remedy());
  }
  if (has_forward(source.map.projection()))
    source.map.forward = read.forward.value_or(read.assumed_forward.value_or(Forward::plus_z));
  return made;
}

void write_circle(const PhotoOptions& photo, const Picture& circle) {
  write_stored(photo.picture, circle.size.width, circle.pixels, Depth::uint8, {.commit = settings().commit});
}

}  // namespace tools

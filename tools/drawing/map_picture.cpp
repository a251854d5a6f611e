#include "drawing/map_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "envmap/base/parallel.h"
#include "envmap/map/atlas.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/lookup.h"
#include "envmap/prefilter/prefilter.h"

namespace tools {
namespace {

using namespace envmap;

Layout layout_of(Projection p) { return p == Projection::cube ? Layout::cross : default_layout(p); }

// Which pixels of a line each pixel of another line covers, and how much of itself each one is.
struct Cover {
  int first;
  std::vector<float> parts;
};
std::vector<Cover> covers(int from, int to) {
  std::vector<Cover> all(static_cast<std::size_t>(to));
  const double step = double(from) / to;
  for (int k = 0; k < to; ++k) {
    Cover& cover = all[std::size_t(k)];
    const double low = k * step, high = std::min<double>(from, (k + 1) * step);
    cover.first = std::min(from - 1, int(low));
    for (int i = cover.first; i < high; ++i)
      cover.parts.push_back(float((std::min<double>(i + 1, high) - std::max<double>(i, low)) / step));
  }
  return all;
}

// The mean over each pixel. Enlarged pictures show their texels as squares.
// @param rows fills a span with the pixels of whole rows, from one on.
template <class Rows>
Picture shown_at(const Rows& rows, Size size, const Show& show, Size wanted) {
  Picture out(wanted, Colour(0));
  const std::vector<Cover> across = covers(size.width, wanted.width), down = covers(size.height, wanted.height);
  for_each_row(1, wanted.height, {}, [&](int, int j) {
    const Cover& below = down[std::size_t(j)];
    std::vector<Colour> radiance(below.parts.size() * std::size_t(size.width));
    rows(below.first, std::span(radiance));
    show(radiance);
    std::vector<Colour> wide(std::size_t(size.width), Colour(0));
    for (std::size_t r = 0; r < below.parts.size(); ++r)
      for (std::size_t i = 0; i < wide.size(); ++i) wide[i] += below.parts[r] * radiance[r * wide.size() + i];
    for (int i = 0; i < wanted.width; ++i) {
      const Cover& columns = across[std::size_t(i)];
      for (std::size_t c = 0; c < columns.parts.size(); ++c)
        out.at(i, j) += columns.parts[c] * wide[std::size_t(columns.first) + c];
    }
  });
  return out;
}

Picture page_picture(const Level& level, std::optional<int> face, const Show& show, int height) {
  const Rows rows = rows_of(level, Forward::plus_z);
  const Atlas atlas{rows, grid(layout_of(level.projection())), face.value_or(-1)};
  const Size size{atlas.width(), atlas.height()};
  const int width = std::max(1, int(std::lround(double(height) * size.width / size.height)));
  const auto gather = [&](int begin, std::span<Colour> out) {
    atlas.gather(begin, begin + int(std::ssize(out)) / size.width, out);
  };
  return shown_at(gather, size, show, {width, height});
}

constexpr std::pair<Direction, const char*> axes[] = {{{1, 0, 0}, "+X"},  {{-1, 0, 0}, "-X"}, {{0, 1, 0}, "+Y"},
                                                      {{0, -1, 0}, "-Y"}, {{0, 0, 1}, "+Z"},  {{0, 0, -1}, "-Z"}};

// ---- balls ----------------------------------------------------------------------------------------------------------

constexpr int per_pixel = 2;  // Rays along each side.

// What is seen of a ball of radius 1 at a point of its disc: `radiance` of the normal and the mirrored direction.
template <class Radiance>
Picture ball(const Rotation& to_world, int size, const Show& show, const Radiance& radiance) {
  const int fine = size * per_pixel;
  std::vector<Colour> pixels(std::size_t(fine) * std::size_t(fine), Colour(0));
  for_each_row(1, fine, {}, [&](int, int j) {
    for (int i = 0; i < fine; ++i) {
      const double s = (2 * i + 1.0) / fine - 1, t = 1 - (2 * j + 1.0) / fine, rest = 1 - s * s - t * t;
      if (rest <= 0) continue;
      const Direction normal(s, t, std::sqrt(rest)), mirrored = 2 * normal.z * normal - Direction(0, 0, 1);
      pixels[std::size_t(j) * std::size_t(fine) + std::size_t(i)] = radiance(to_world * normal, to_world * mirrored);
    }
  });
  const auto copy = [&](int begin, std::span<Colour> out) {
    std::copy_n(pixels.begin() + std::ptrdiff_t(begin) * fine, out.size(), out.begin());
  };
  return shown_at(copy, {fine, fine}, show, {size, size});
}

// Sizes at which texels are finer than the lobe changes; errors of 1% are not seen.
PrefilterOptions on_ball(const Lobe& lobe, int size) {
  return {.lobe = lobe, .to = Projection::cube, .size = size, .max_error = 1e-2};
}

// ---- histogram ------------------------------------------------------------------------------------------------------

struct Range {
  int first, last;  // Whole stops.
};

Range range_of(const Luminances& luminances, double white) {
  constexpr double seen = 1e-5;
  const auto& bins = luminances.bins();
  const auto holds = [](const Luminances::Bin& bin) { return bin.sphere > seen || bin.light > seen; };
  const int at_white = int(std::floor(portable::log2(white)));
  const auto first = std::ranges::find_if(bins, holds) - bins.begin();
  const auto last = bins.rend() - std::find_if(bins.rbegin(), bins.rend(), holds) - 1;
  if (last < first) return {at_white - 4, at_white + 4};  // All black.
  const auto stop = [](std::ptrdiff_t bin) { return int(bin) / Luminances::per_stop + Luminances::lowest; };
  return {std::min(stop(first), at_white - 1), std::max(stop(last), at_white) + 1};
}

// Shares by so many parts of each stop. Beyond the stops that were counted there is nothing.
std::vector<Luminances::Bin> coarse(const Luminances& luminances, const Range& range, int parts) {
  const int width = Luminances::per_stop / parts;
  std::vector<Luminances::Bin> out(std::size_t((range.last - range.first) * parts));
  for (std::size_t k = 0; k < out.size(); ++k)
    for (int b = 0; b < width; ++b) {
      const int at = (range.first - Luminances::lowest) * Luminances::per_stop + int(k) * width + b;
      if (at < 0 || at >= std::ssize(luminances.bins())) continue;
      const Luminances::Bin& from = luminances.bins()[std::size_t(at)];
      out[k].sphere += from.sphere, out[k].light += from.light;
    }
  return out;
}

void fill(Picture& picture, int left, int top, int right, int bottom, Colour colour) {
  for (int y = std::max(0, top); y < std::min(bottom, picture.size.height); ++y)
    for (int x = std::max(0, left); x < std::min(right, picture.size.width); ++x) picture.at(x, y) = colour;
}

}  // namespace

MapPicture::MapPicture(const Level& level, std::optional<int> face, const Show& show, int height)
    : projection_(level.projection()), face_(face), picture_(page_picture(level, face, show, height)) {}

std::optional<Point2> MapPicture::place(const Rotation& to_image, const Direction& d) const {
  const Location<double> at = locate(projection_, to_image * d);
  if (face_)
    return at.face == *face_ ? std::optional(Point2(at.u * picture_.size.width, at.v * picture_.size.height))
                             : std::nullopt;
  const Grid cells = grid(layout_of(projection_));
  const Slot slot = cells.slots[std::size_t(at.face)];
  return Point2((slot.column + at.u) * picture_.size.width / cells.columns,
                (slot.row + at.v) * picture_.size.height / cells.rows);
}

void MapPicture::mark(const EnvironmentMap& map, std::span<const Direction> lights) {
  const Rotation to_image = glm::transpose(image_to_world(map.forward));
  for (int degrees = 0; degrees < 360; degrees += 3) {
    const Direction level(portable::sin_pi(degrees / 180.0), 0, portable::cos_pi(degrees / 180.0));
    const auto at = place(to_image, level);
    if (at && picture_.holds(int(at->x), int(at->y)))
      picture_.at(int(at->x), int(at->y)) = Colour(degrees % 2 == 0 ? 1.0F : 0.0F);
  }
  const int text = std::clamp(picture_.size.height / 24, 10, 24);
  for (const auto& [axis, name] : axes)
    if (const auto at = place(to_image, axis)) draw_label(picture_, int(at->x), int(at->y), name, text);
  const Grid cells = grid(layout_of(projection_));
  if (projection_ == Projection::cube && !face_)
    for (std::size_t face = 0; face < cells.slots.size(); ++face)
      draw_label(picture_, cells.slots[face].column * picture_.size.width / cells.columns + text,
                 cells.slots[face].row * picture_.size.height / cells.rows + text, std::string(cube_face_names[face]),
                 text);
  for (const Direction& light : lights)
    if (const auto at = place(to_image, light)) draw_ring(picture_, at->x, at->y, 0.5 * text + 2);
}

TileRow lit_balls(const EnvironmentMap& map, const Show& show, int size) {
  const Rotation to_world = image_to_world(map.forward);
  TileRow row;
  const EnvironmentMap mirror = convert(map, {.to = {Projection::sphere, map.forward}, .size = size});
  MapPicture mirrored(mirror.base(), {}, show, size);
  row.push_back({std::move(mirrored.picture()), "mirror"});
  const Prefilterer source(borrowed(map));
  constexpr std::pair<double, int> rough[] = {{0.25, 128}, {0.5, 64}, {0.75, 32}};
  for (const auto& [roughness, finest] : rough) {
    const EnvironmentLookup light(source.make(on_ball(Lobe::ggx(roughness), finest)).map);
    row.push_back({ball(to_world, size, show, [&](const Direction&, const Direction& r) { return light(r); }),
                   fmt::format("GGX {}", roughness)});
  }
  const EnvironmentLookup light(source.make(on_ball(Lobe::diffuse(), 32)).map);
  row.push_back(
      {ball(to_world, size, show, [&](const Direction& n, const Direction&) { return light(n); }), "diffuse"});
  return row;
}

Picture histogram(const Luminances& luminances, double white, Size size) {
  constexpr int parts = 4, text = 11, foot = text + 6;
  constexpr Colour bars(0.5F), light(1.0F, 0.62F, 0.1F), lines(0.25F);
  const Range range = range_of(luminances, white);
  const std::vector<Luminances::Bin> shares = coarse(luminances, range, parts);
  double most = 1e-9;
  for (const Luminances::Bin& bin : shares) most = std::max({most, bin.sphere, bin.light});
  Picture picture(size, Colour(0.06F));
  const int ground = size.height - foot;
  const auto x_of = [&](double stop) { return int((stop - range.first) / (range.last - range.first) * size.width); };
  const auto y_of = [&](double share) { return ground - int(std::lround(share / most * (ground - 4))); };
  const int step = std::max(1, (range.last - range.first) / 12);
  for (int stop = range.first; stop <= range.last; ++stop)
    if (stop % step == 0) fill(picture, x_of(stop), 0, x_of(stop) + 1, ground, lines);
  int before = ground;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    const int left = x_of(range.first + double(k) / parts), right = x_of(range.first + double(k + 1) / parts);
    fill(picture, left, y_of(shares[k].sphere), right - 1, ground, bars);
    const int y = y_of(shares[k].light);
    fill(picture, left, std::min(y, before) - 1, left + 2, std::max(y, before) + 1, light);
    fill(picture, left, y - 1, right + 1, y + 1, light);
    before = y;
  }
  const int at_white = x_of(portable::log2(white));
  fill(picture, at_white, 0, at_white + 2, ground, Colour(1));
  for (int stop = range.first + 1; stop < range.last; ++stop)
    if (stop % step == 0)
      draw_label(picture, x_of(stop), size.height - foot / 2, stop == 0 ? "0" : fmt::format("{:+}", stop), text);
  return picture;
}

}  // namespace tools

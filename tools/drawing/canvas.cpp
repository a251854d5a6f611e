#include "drawing/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "cli/console.h"
#include "drawing/letters.h"
#include "envmap/base/error.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::uint32_t ink = 0x222222;
constexpr double rim = 1.5, dash = 4, gap = 3;

std::string paint(const std::optional<std::uint32_t>& colour) {
  return colour ? fmt::format("#{:06X}", *colour) : "none";
}

std::string svg_of(const Outline& o) {
  std::string path;
  for (const Place& p : o.points) path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "M" : "L", p.x, p.y);
  return fmt::format("<path d=\"{}{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{:g}\"{}/>\n", path,
                     o.closed ? "Z" : "", paint(o.fill), paint(o.stroke), o.width,
                     o.dashed ? fmt::format(" stroke-dasharray=\"{:g} {:g}\"", dash, gap) : "");
}

std::string svg_of(const Words& w) {
  constexpr std::string_view anchors[] = {"start", "middle", "end"};
  const std::string place = w.upwards
                                ? fmt::format("transform=\"translate({:.1f} {:.1f}) rotate(-90)\"", w.at.x, w.at.y)
                                : fmt::format("x=\"{:.1f}\" y=\"{:.1f}\"", w.at.x, w.at.y);
  return fmt::format(
      "<text {} font-size=\"{:g}\" text-anchor=\"{}\" stroke=\"white\" stroke-width=\"{:g}\" "
      "paint-order=\"stroke\">{}</text>\n",
      place, w.size, anchors[std::size_t(w.anchor)], 2 * rim, in_markup(w.text));
}

// ---- as pixels ------------------------------------------------------------------------------------------------------

Colour colour_of(std::uint32_t rgb) {
  return Colour(float(rgb >> 16 & 255), float(rgb >> 8 & 255), float(rgb & 255)) / 255.0F;
}

bool is_inside(const std::vector<Place>& polygon, double x, double y) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Place &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if ((a.y > y) != (b.y > y) && x < a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

// Of 4 x 4 points in the pixel, how many are inside.
float coverage(const std::vector<Place>& polygon, int i, int j) {
  int count = 0;
  for (int k = 0; k < 16; ++k) count += is_inside(polygon, i + (k % 4 + 0.5) / 4, j + (k / 4 + 0.5) / 4) ? 1 : 0;
  return float(count) / 16;
}

void fill(Picture& onto, const std::vector<Place>& polygon, std::uint32_t rgb) {
  const auto [left, right] = std::ranges::minmax(polygon, {}, &Place::x);
  const auto [top, bottom] = std::ranges::minmax(polygon, {}, &Place::y);
  for (int j = int(top.y); j <= int(bottom.y); ++j)
    for (int i = int(left.x); i <= int(right.x); ++i)
      if (onto.holds(i, j)) onto.at(i, j) = glm::mix(onto.at(i, j), colour_of(rgb), coverage(polygon, i, j));
}

// Its ends reach half the width beyond, so that joined lines have no notches.
void line(Picture& onto, Place a, Place b, double width, std::uint32_t rgb) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  if (length == 0) return;
  const double x = 0.5 * width * (b.x - a.x) / length, y = 0.5 * width * (b.y - a.y) / length;
  fill(onto,
       {{a.x - x - y, a.y - y + x}, {b.x + x - y, b.y + y + x}, {b.x + x + y, b.y + y - x}, {a.x - x + y, a.y - y - x}},
       rgb);
}

void dashes(Picture& onto, Place a, Place b, double width, std::uint32_t rgb, int scale) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  const auto at = [&](double d) { return a + (b - a) * d / length; };
  for (double d = 0; d < length; d += (dash + gap) * scale)
    line(onto, at(d), at(std::min(d + dash * scale, length)), width, rgb);
}

void draw(Picture& onto, const Outline& o, int scale) {
  std::vector<Place> points = o.points;
  for (Place& p : points) p *= scale;
  if (o.fill) fill(onto, points, *o.fill);
  if (!o.stroke) return;
  const std::size_t lines = o.closed ? points.size() : points.size() - 1;
  for (std::size_t k = 0; k < lines; ++k) {
    const Place &a = points[k], &b = points[(k + 1) % points.size()];
    if (o.dashed)
      dashes(onto, a, b, o.width * scale, *o.stroke, scale);
    else
      line(onto, a, b, o.width * scale, *o.stroke);
  }
}

// How much of each pixel letters cover: the baseline starts at (margin, margin + height).
struct Letters {
  Picture cover;
  int left, right;  // Of what is covered.
};
Letters letters_of(const std::string& text, int height, int margin) {
  if (font_file().empty())
    throw OutputError(fmt::format("no font to write words with: {}, or write .svg", install_font));
  const int room = int(1.4 * width_of(text, height)) + 2 * margin;
  Letters letters{Picture({room, 3 * height / 2 + 2 * margin}, Colour(0)), room, 0};
  Picture& cover = letters.cover;
  draw_letters(cover, margin, margin + height, text, height);
  float most = 0;
  for (int j = 0; j < cover.size.height; ++j)
    for (int i = 0; i < cover.size.width; ++i)
      if (const float c = cover.at(i, j).x; c > 0)
        most = std::max(most, c), letters.left = std::min(letters.left, i), letters.right = std::max(letters.right, i);
  if (most == 0)
    throw OutputError(
        fmt::format("{}: the font draws nothing of '{}': {}, or write .svg", font_file(), text, install_font));
  for (Colour& c : cover.pixels) c /= most;
  return letters;
}

void draw(Picture& onto, const Words& w, int scale) {
  if (w.text.find_first_not_of(' ') == std::string::npos) return;
  const int height = int(std::lround(w.size * scale)), reach = int(std::lround(rim * scale));
  Letters letters = letters_of(w.text, height, reach + 2);
  const int wide = letters.right - letters.left + 1;
  const int before = w.anchor == Anchor::start ? 0 : w.anchor == Anchor::middle ? wide / 2 : wide;
  const int x = int(std::lround(w.at.x * scale)), y = int(std::lround(w.at.y * scale));
  const auto blend = [&](int i, int j, float part, const Colour& colour) {
    const int along = i - letters.left - before, down = j - (reach + 2 + height);
    const int at_x = w.upwards ? x + down : x + along, at_y = w.upwards ? y - along : y + down;
    if (part > 0 && onto.holds(at_x, at_y)) onto.at(at_x, at_y) = glm::mix(onto.at(at_x, at_y), colour, part);
  };
  Picture& cover = letters.cover;
  const auto widened = [&](int i, int j) {
    float most = 0;
    for (int q = -reach; q <= reach; ++q)
      for (int p = -reach; p <= reach; ++p)
        if (p * p + q * q <= reach * reach && cover.holds(i + p, j + q))
          most = std::max(most, cover.at(i + p, j + q).x);
    return most;
  };
  for (int j = 0; j < cover.size.height; ++j)
    for (int i = 0; i < cover.size.width; ++i) blend(i, j, widened(i, j), Colour(1));
  for (int j = 0; j < cover.size.height; ++j)
    for (int i = 0; i < cover.size.width; ++i) blend(i, j, cover.at(i, j).x, colour_of(ink));
}

}  // namespace

// DejaVu Sans: digits 0.64 of its size, capitals 0.77 at most but for M and W, small letters 0.63 but for m and w.
double width_of(const std::string& text, double size) {
  double ems = 0;
  for (const char c : text) {
    if ((c & 0xC0) == 0x80) continue;  // The rest of a letter of UTF-8.
    ems += std::string_view("mwMW@%").find(c) != std::string_view::npos           ? 1.0
           : c == '-' || c == '.' || c == ':' || c == ' ' || c == 'i' || c == 'l' ? 0.37
           : static_cast<unsigned char>(c) >= 0x80                                ? 1.0
           : c >= 'A' && c <= 'Z'                                                 ? 0.73
                                                                                  : 0.63;
  }
  return size * ems;
}

std::string svg_of(const Drawing& drawing) {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"DejaVu Sans, sans-serif\" fill=\"{2}\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      drawing.width, drawing.height, paint(ink));
  for (const Outline& o : drawing.outlines) out += svg_of(o);
  for (const Words& w : drawing.words) out += svg_of(w);
  return out + "</svg>\n";
}

Picture picture_of(const Drawing& drawing, int scale) {
  Picture picture({int(drawing.width) * scale, int(drawing.height) * scale}, Colour(1));
  for (const Outline& o : drawing.outlines) draw(picture, o, scale);
  for (const Words& w : drawing.words) draw(picture, w, scale);
  return picture;
}

}  // namespace tools

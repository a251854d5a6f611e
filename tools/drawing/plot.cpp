#include "drawing/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace tools {
namespace {

constexpr double width = 900, height = 560, left = 90, right = 40, bottom = 70;
constexpr double label_size = 11, line_height = 18, mark_radius = 7;
constexpr std::uint32_t white = 0xFFFFFF, grid_grey = 0xDDDDDD, line_grey = 0x999999;

// Decades that hold all values; where some are 0, the first stands for that.
struct Axis {
  int first, last;
  bool has_zero;
  double from, to;  // On the page.

  [[nodiscard]] double at(double value) const {
    return value > 0 ? from + (to - from) * (std::log10(value) - first) / (last - first) : from;
  }
  [[nodiscard]] std::string name(int decade) const {
    return has_zero && decade == first ? "0" : fmt::format("1e{}", decade);
  }
};
Axis axis(std::span<const PlotPoint> points, double PlotPoint::*value, double from, double to) {
  double least = 1e300, most = 0;
  bool has_zero = false;
  for (const PlotPoint& p : points) {
    has_zero |= p.*value == 0;
    if (p.*value > 0) least = std::min(least, p.*value), most = std::max(most, p.*value);
  }
  if (most == 0) least = most = 1;
  const int first = int(std::floor(std::log10(least))), last = int(std::ceil(std::log10(most)));
  return {has_zero ? first - 1 : first, std::max(last, first + 1), has_zero, from, to};
}

// Okabe and Ito's colours (2008), which colour-blind people can tell apart; the marks do without.
constexpr std::array<std::uint32_t, 7> colours{0x0072B2, 0xD55E00, 0x009E73, 0xCC79A7, 0xE69F00, 0x56B4E9, 0x000000};

std::vector<Place> shape_of(std::size_t series) {
  switch (series % colours.size()) {
    case 0: break;
    case 1: return {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}};
    case 2: return {{0, -6}, {6, 5}, {-6, 5}};
    case 3: return {{0, -7}, {7, 0}, {0, 7}, {-7, 0}};
    case 4: return {{0, 6}, {6, -5}, {-6, -5}};
    case 5:
      return {{-2, -6}, {2, -6}, {2, -2}, {6, -2}, {6, 2},   {2, 2},
              {2, 6},   {-2, 6}, {-2, 2}, {-6, 2}, {-6, -2}, {-2, -2}};
    default: return {{-6, -2}, {0, -7}, {6, -2}, {4, 5}, {-4, 5}};
  }
  std::vector<Place> circle;
  for (int k = 0; k < 24; ++k) circle.push_back({5 * std::cos(k * 0.2617994), 5 * std::sin(k * 0.2617994)});
  return circle;
}

Outline mark(std::size_t series, Place at, bool filled) {
  const std::uint32_t colour = colours[series % colours.size()];
  Outline o{
      .points = shape_of(series), .fill = filled ? colour : white, .stroke = colour, .width = 1.6, .closed = true};
  for (Place& p : o.points) p += at;
  return o;
}

// ---- labels ---------------------------------------------------------------------------------------------------------

struct Box {
  double left, top, right, bottom;
  [[nodiscard]] bool meets(const Box& o) const {
    return left < o.right && o.left < right && top < o.bottom && o.top < bottom;
  }
};

// Finds places for labels near their marks, clear of marks, of each other and of the page's edge.
class Labels {
 public:
  Labels(const Box& room, std::vector<Place> marks) : room_(room), marks_(std::move(marks)) {}

  // From near to far, the sides first; far ones are led to by a line. @param must whether nothing is too far for it.
  void add(const std::string& text, Place mark, bool must, Drawing& onto) {
    const double wide = width_of(text, label_size) + 4;
    for (double away = 3; away < (must ? 400 : 30); away += 6)
      for (const double angle : {0.0, 180.0, -35.0, -145.0, 35.0, 145.0, -90.0, 90.0, -60.0, 60.0, -120.0, 120.0}) {
        const double c = std::cos(angle * 0.017453293), s = std::sin(angle * 0.017453293), reach = mark_radius + away;
        const double x = mark.x + reach * c + (std::abs(c) < 0.1 ? -0.5 * wide : c < 0 ? -wide : 0);
        const double y = mark.y + (reach + 0.5 * label_size) * s;
        const Box box{x, y - 0.6 * label_size, x + wide, y + 0.6 * label_size};
        if (!is_free(box)) continue;
        boxes_.push_back(box);
        if (away > 12)
          onto.outlines.push_back({{mark, {std::clamp(mark.x, box.left, box.right), y}}, {}, line_grey, 0.8});
        const Anchor anchor = std::abs(c) < 0.1 ? Anchor::middle : c < 0 ? Anchor::end : Anchor::start;
        const double at = anchor == Anchor::middle ? x + 0.5 * wide : anchor == Anchor::end ? x + wide - 2 : x + 2;
        onto.words.push_back({{at, y + 0.36 * label_size}, text, label_size, anchor});
        return;
      }
  }

 private:
  [[nodiscard]] bool is_free(const Box& box) const {
    if (box.left < room_.left || box.right > room_.right || box.top < room_.top || box.bottom > room_.bottom)
      return false;
    return std::ranges::none_of(boxes_, [&](const Box& o) { return o.meets(box); }) &&
           std::ranges::none_of(marks_, [&](const Place& p) {
             return Box{p.x - mark_radius, p.y - mark_radius, p.x + mark_radius, p.y + mark_radius}.meets(box);
           });
  }

  Box room_;
  std::vector<Place> marks_;
  std::vector<Box> boxes_;
};

// ---- the page -------------------------------------------------------------------------------------------------------

// Text that is too long ends in dots.
std::string fitted(std::string text, double size, double room) {
  if (width_of(text, size) <= room) return text;
  while (!text.empty() && ((text.back() & 0xC0) == 0x80 || width_of(text + "...", size) > room)) text.pop_back();
  return text + "...";
}

// What marks stand for, in as many lines as it takes. @return the bottom of the last.
double add_key(const std::vector<std::string>& series, Drawing& onto) {
  double x = left, y = 50;
  for (std::size_t k = 0; k < series.size(); ++k) {
    const double wide = 36 + width_of(series[k], 12);
    if (x + wide > width - right && x > left) x = left, y += line_height;
    onto.outlines.push_back(mark(k, {x + 6, y - 4}, true));
    onto.words.push_back({{x + 16, y}, series[k]});
    x += wide;
  }
  return y;
}

void add_grid(const Axis& x, const Axis& y, Drawing& onto) {
  for (int k = x.first; k <= x.last; ++k) {
    const double at = x.at(std::pow(10, k));
    onto.outlines.push_back({{{at, y.to}, {at, y.from}}, {}, grid_grey});
    onto.words.push_back({{at, y.from + 18}, x.name(k), 12, Anchor::middle});
  }
  for (int k = y.first; k <= y.last; ++k) {
    const double at = y.at(std::pow(10, k));
    onto.outlines.push_back({{{x.from, at}, {x.to, at}}, {}, grid_grey});
    onto.words.push_back({{x.from - 8, at + 4}, y.name(k), 12, Anchor::end});
  }
}

void add_points(const std::vector<PlotPoint>& points, const std::vector<std::string>& series, const Axis& x,
                const Axis& y, Drawing& onto) {
  std::vector<Place> places;
  Outline front{.points = {}, .stroke = line_grey, .width = 1.2, .dashed = true};
  for (const PlotPoint& p : points) {
    places.push_back({x.at(p.x), y.at(p.y)});
    if (p.front) front.points.push_back(places.back());
  }
  std::ranges::sort(front.points, {}, &Place::x);
  if (!front.points.empty()) onto.outlines.push_back(front);
  Labels labels({x.from + 2, y.to + 2, width - 4, y.from - 2}, places);
  for (const bool of_front : {true, false})
    for (std::size_t k = 0; k < points.size(); ++k)
      if (points[k].front == of_front) labels.add(points[k].label, places[k], of_front, onto);
  for (const bool of_front : {false, true})  // On top of what they beat.
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto which = std::size_t(std::ranges::find(series, points[k].series) - series.begin());
      if (points[k].front == of_front) onto.outlines.push_back(mark(which, places[k], of_front));
    }
}

}  // namespace

Drawing plot(std::span<const PlotPoint> all, const std::string& title, const std::string& x_axis,
             const std::string& y_axis) {
  std::vector<PlotPoint> points;
  for (const PlotPoint& p : all)
    if (p.x > 0 && std::isfinite(p.y)) points.push_back(p);
  Drawing page{width, height, {}, {}};
  page.words.push_back({{left, 28}, fitted(title, 16, width - left - right), 16});
  if (points.empty()) {
    page.words.push_back({{left, 80}, "nothing was measured"});
    return page;
  }
  std::vector<std::string> series;
  for (const PlotPoint& p : points)
    if (std::ranges::find(series, p.series) == series.end()) series.push_back(p.series);
  const double top = add_key(series, page) + 12;
  page.words.push_back({{left, height - 12}, "Filled: nothing else is further to the left and lower.", label_size});
  const Axis x = axis(points, &PlotPoint::x, left, width - right),
             y = axis(points, &PlotPoint::y, height - bottom, top);
  add_grid(x, y, page);
  page.words.push_back({{0.5 * (left + width - right), height - 28}, x_axis, 12, Anchor::middle});
  page.words.push_back({{26, 0.5 * (top + height - bottom)}, y_axis, 12, Anchor::middle, true});
  add_points(points, series, x, y, page);
  return page;
}

}  // namespace tools

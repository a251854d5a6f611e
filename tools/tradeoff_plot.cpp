#include "tradeoff_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace tools {
namespace {

constexpr double width = 900, height = 560, left = 90, right = 40, top = 60, bottom = 70;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else out += c;
  }
  return out;
}

std::string text(double x, double y, const std::string& anchor, const std::string& words, const std::string& more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more, escaped(words));
}

// Decades that hold all values; where some are 0, the first stands for that.
struct Axis {
  int first, last;
  bool has_zero;
  double from, to;  // On the page.

  [[nodiscard]] double at(double value) const {
    return value > 0 ? from + (to - from) * (std::log10(value) - first) / (last - first) : from;
  }
  [[nodiscard]] std::string name(int decade) const { return has_zero && decade == first ? "0" : fmt::format("1e{}", decade); }
};
Axis axis(std::span<const PlotPoint> points, double PlotPoint::* value, double from, double to) {
  double least = 1e300, most = 0;
  bool has_zero = false;
  for (const PlotPoint& p : points) {
    has_zero |= p.*value == 0;
    if (p.*value > 0) least = std::min(least, p.*value), most = std::max(most, p.*value);
  }
  if (most == 0) least = most = 1;
  const int first = static_cast<int>(std::floor(std::log10(least))), last = static_cast<int>(std::ceil(std::log10(most)));
  return {has_zero ? first - 1 : first, std::max(last, first + 1), has_zero, from, to};
}

// Okabe and Ito's colours (2008), which colour-blind people can tell apart; the marks do without.
constexpr std::array<const char*, 7> colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"};
std::string mark(std::size_t series, double x, double y, bool filled) {
  const char* colour = colours[series % colours.size()];
  const std::string paint = fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1.6\"", filled ? colour : "white", colour);
  const auto path = [&](const char* d) { return fmt::format("<path transform=\"translate({:.1f} {:.1f})\" d=\"{}\" {}/>\n", x, y, d, paint); };
  switch (series % colours.size()) {
    case 0: return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" {}/>\n", x, y, paint);
    case 1: return path("M-5,-5H5V5H-5Z");
    case 2: return path("M0,-6L6,5H-6Z");
    case 3: return path("M0,-7L7,0L0,7L-7,0Z");
    case 4: return path("M0,6L6,-5H-6Z");
    case 5: return path("M-2,-6H2V-2H6V2H2V6H-2V2H-6V-2H-2Z");
    default: return path("M-6,-2L0,-7L6,-2L4,5H-4Z");
  }
}

std::string grid(const Axis& x, const Axis& y) {
  std::string out;
  for (int k = x.first; k <= x.last; ++k) {
    const double at = x.at(std::pow(10, k));
    out += fmt::format("<path d=\"M{:.1f},{}V{}\" stroke=\"#ddd\"/>\n", at, top, height - bottom);
    out += text(at, height - bottom + 18, "middle", x.name(k));
  }
  for (int k = y.first; k <= y.last; ++k) {
    const double at = y.at(std::pow(10, k));
    out += fmt::format("<path d=\"M{},{:.1f}H{}\" stroke=\"#ddd\"/>\n", left, at, width - right);
    out += text(left - 8, at + 4, "end", y.name(k));
  }
  return out;
}

std::string front_line(std::span<const PlotPoint> points, const Axis& x, const Axis& y) {
  std::vector<const PlotPoint*> front;
  for (const PlotPoint& p : points)
    if (p.front) front.push_back(&p);
  std::ranges::sort(front, {}, &PlotPoint::x);
  std::string path;
  for (const PlotPoint* p : front) path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "M" : "L", x.at(p->x), y.at(p->y));
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#999\" stroke-width=\"1.2\" stroke-dasharray=\"4 3\"/>\n", path);
}

}  // namespace

std::string plot(std::span<const PlotPoint> all, const std::string& title, const std::string& x_axis, const std::string& y_axis) {
  std::vector<PlotPoint> points;
  for (const PlotPoint& p : all)
    if (p.x > 0 && std::isfinite(p.y)) points.push_back(p);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      width, height);
  out += text(left, 28, "start", title, " font-size=\"16\"");
  if (points.empty()) return out + text(left, top + 20, "start", "nothing was measured") + "</svg>\n";
  const Axis x = axis(points, &PlotPoint::x, left, width - right), y = axis(points, &PlotPoint::y, height - bottom, top);
  out += grid(x, y) + front_line(points, x, y);
  out += text(0.5 * (left + width - right), height - 28, "middle", x_axis);
  out += text(0, 0, "middle", y_axis, fmt::format(" transform=\"translate(26 {}) rotate(-90)\"", 0.5 * (top + height - bottom)));
  std::vector<std::string> series;
  for (const PlotPoint& p : points)
    if (std::ranges::find(series, p.series) == series.end()) series.push_back(p.series);
  for (const PlotPoint& p : points) {
    const auto which = static_cast<std::size_t>(std::ranges::find(series, p.series) - series.begin());
    out += mark(which, x.at(p.x), y.at(p.y), p.front);
  }
  for (const PlotPoint& p : points) {
    if (!p.front) continue;
    const bool at_right = x.at(p.x) > 0.7 * width;
    out += text(x.at(p.x) + (at_right ? -9 : 9), y.at(p.y) - 7, at_right ? "end" : "start", p.label,
                " font-size=\"11\" stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\"");
  }
  double at = left;
  for (std::size_t k = 0; k < series.size(); ++k) {
    out += mark(k, at + 6, 46, true) + text(at + 16, 50, "start", series[k]);
    at += 40 + 7.2 * static_cast<double>(series[k].size());
  }
  return out + "</svg>\n";
}

}  // namespace tools

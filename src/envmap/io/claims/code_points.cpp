#include "envmap/io/claims/code_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

struct NamedPrimaries {
  unsigned number;
  const char* name;
  Primaries primaries;
};

constexpr Point2 d65{0.3127, 0.3290}, c_white{0.310, 0.316};

// H.273, table 2.
constexpr NamedPrimaries all_primaries[] = {
    {1, "BT.709", rec709},
    {4, "BT.470 M", {{0.67, 0.33}, {0.21, 0.71}, {0.14, 0.08}, c_white}},
    {5, "BT.470 BG", {{0.64, 0.33}, {0.29, 0.60}, {0.15, 0.06}, d65}},
    {6, "BT.601", {{0.630, 0.340}, {0.310, 0.595}, {0.155, 0.070}, d65}},
    {7, "SMPTE 240M", {{0.630, 0.340}, {0.310, 0.595}, {0.155, 0.070}, d65}},
    {8, "film", {{0.681, 0.319}, {0.243, 0.692}, {0.145, 0.049}, c_white}},
    {9, "BT.2020", rec2020},
    {10, "XYZ", cie_xyz},
    {11, "P3 DCI", {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, {0.314, 0.351}}},
    {12, "Display P3", p3_d65},
    {22, "EBU 3213", {{0.630, 0.340}, {0.295, 0.605}, {0.155, 0.077}, d65}},
};

// ---- curves: of a signal from 0 to 1, light ---------------------------------------------------------------------

// BT.709, item 1.2, solved for L.
double of_bt709(double v) {
  constexpr double a = 1.09929682680944, b = 0.018053968510807;
  return v < 4.5 * b ? v / 4.5 : portable::pow((v + (a - 1)) / a, 1 / 0.45);
}

double of_smpte240(double v) { return v < 4 * 0.0228 ? v / 4 : portable::pow((v + 0.1115) / 1.1115, 1 / 0.45); }

// BT.2100, table 4: in units of 10000 cd/m^2.
double of_pq(double v) {
  constexpr double m1 = 2610.0 / 16384, m2 = 2523.0 / 4096 * 128, c1 = 3424.0 / 4096, c2 = 2413.0 / 4096 * 32,
                   c3 = 2392.0 / 4096 * 32;
  const double p = portable::pow(v, 1 / m2);
  return portable::pow(std::max(p - c1, 0.0) / (c2 - c3 * p), 1 / m1);
}

// BT.2100, table 5: light of the scene from 0 to 1.
double of_hlg(double v) {
  constexpr double a = 0.17883277, b = 1 - 4 * a, c = 0.55991073;
  return v <= 0.5 ? v * v / 3 : (portable::exp((v - c) / a) + b) / 12;
}

struct NamedCurve {
  unsigned number;
  const char* name;
  double (*light)(double signal);
};

constexpr unsigned srgb = 13, pq = 16, hlg = 18;

// H.273, table 3. Logarithms (9, 10) begin at .01, and the others say colours beyond those of a display.
constexpr NamedCurve all_curves[] = {
    {1, "BT.709", of_bt709},
    {4, "gamma 2.2", [](double v) { return portable::pow(v, 2.2); }},
    {5, "gamma 2.8", [](double v) { return portable::pow(v, 2.8); }},
    {6, "BT.601", of_bt709},
    {7, "SMPTE 240M", of_smpte240},
    {8, "linear", nullptr},
    {srgb, "sRGB", nullptr},
    {14, "BT.2020", of_bt709},
    {15, "BT.2020", of_bt709},
    {pq, "PQ", of_pq},
    {hlg, "HLG", of_hlg},
};

template <class Row>
const Row* find(std::span<const Row> rows, unsigned number) {
  const auto found = std::ranges::find(rows, number, &Row::number);
  return found == rows.end() ? nullptr : &*found;
}

const NamedPrimaries* primaries_with(unsigned number) {
  return find(std::span<const NamedPrimaries>(all_primaries), number == 2 ? 1 : number);
}
const NamedCurve* curve_with(unsigned number) {
  return find(std::span<const NamedCurve>(all_curves), number == 2 ? srgb : number);
}

// HLG's light of the scene -> that of a display of 1000 cd/m^2, black 0 (BT.2100, table 5, "HLG reference OOTF").
Colour displayed(const Flux& scene, const Flux& weights) {
  constexpr double peak = 1000, gamma = 1.2;
  const double luminance = glm::dot(scene, weights);
  const double gain = luminance > 0 ? peak / reference_white * portable::pow(luminance, gamma - 1) : 0;
  return Colour(gain * scene);
}

// Stored values -> signal.
struct Range {
  double black = 0, white = 1;
  [[nodiscard]] double signal(double v) const { return (v - black) / (white - black); }
};

Range range_of(const CodePoints& points) {
  if (points.full_range) return {};
  const double most = points.bits > 8 ? 65535 : 255, unit = points.bits > 8 ? 256 : 1;
  return {16 * unit / most, 235 * unit / most};
}

}  // namespace

std::string words(const CodePoints& points) {
  const NamedPrimaries* p = primaries_with(points.primaries);
  const NamedCurve* c = curve_with(points.transfer);
  const auto name = [](unsigned number, const auto* row) {
    return number == 2 ? "not specified" : row ? row->name : "not supported";
  };
  return fmt::format("primaries {} ({}), transfer {} ({}){}", points.primaries, name(points.primaries, p),
                     points.transfer, name(points.transfer, c), points.full_range ? "" : ", narrow range");
}

StatedColour colour_of(const CodePoints& points, const std::string& by) {
  const NamedPrimaries* p = primaries_with(points.primaries);
  const NamedCurve* curve = curve_with(points.transfer);
  if (!p || !curve) throw InputError(fmt::format("not supported: {} of {}", by, words(points)), Remedy::choose_space);
  StatedColour stated{.space = {.name = fmt::format("{} with the curve of {}", p->name, curve->name),
                                .primaries = p->primaries,
                                .by = by,
                                .decoded = true}};
  const unsigned number = points.transfer == 2 ? srgb : points.transfer;
  if (number == srgb && same(p->primaries, rec709)) stated.space.name = "sRGB";
  if (number == srgb && same(p->primaries, p3_d65)) stated.space.name = "Display P3";
  if (number == pq || number == hlg) stated.white_luminance = reference_white;
  const Range range = range_of(points);
  const Flux weights = luminance_weights(p->primaries);
  if (number == 8 && points.full_range) return stated;
  stated.decode = [=](std::span<Colour> colours) {
    if (!points.full_range)
      for (Colour& c : colours)
        for (int k = 0; k < 3; ++k) c[k] = float(std::max(range.signal(c[k]), 0.0));
    if (number == srgb) decode_srgb(colours);
    if (!curve->light) return;
    parallel_ranges(int(colours.size()), 1 << 12, [&](int begin, int end) {
      for (Colour& c : colours.subspan(std::size_t(begin), std::size_t(end - begin))) {
        Flux light;
        for (int k = 0; k < 3; ++k) light[k] = c[k] > 0 ? curve->light(double{c[k]}) : double{c[k]};
        c = number == hlg  ? displayed(light, weights)
            : number == pq ? Colour(10000.0 / reference_white * light)
                           : Colour(light);
      }
    });
  };
  return stated;
}

}  // namespace envmap

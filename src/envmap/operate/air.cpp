#include "envmap/operate/air.h"

#include <algorithm>
#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/primaries.h"
#include "envmap/maths/quadrature.h"

namespace envmap::air {
namespace {

// ---- figures --------------------------------------------------------------------------------------------------------

constexpr double molecule_height = 8e3, haze_height = 1.2e3;  // Scale heights in metres: Nishita et al. 1993.
constexpr double haze_albedo = 0.9;                           // Part of the extinction that scatters: Bruneton 2017.
// Of the cosine of the angle by which haze deflects light: Cornette and Shanks 1992, equation 9.
constexpr double mean_cosine =
    haze_asymmetry * 3 * (4 + haze_asymmetry * haze_asymmetry) / (5 * (2 + haze_asymmetry * haze_asymmetry));
constexpr double haze_exponent = 1.3;                 // Angstrom 1929.
constexpr double ozone_peak = 300 * 2.687e20 / 15e3;  // Molecules per m^3: 300 Dobson units in the tent of density().

// Means over 10 nm from 380 nm on. W/(m^2 nm) outside the air: ASTM G173, extraterrestrial (Gueymard 2004).
constexpr std::array<double, 36> solar{1.01249, 1.14716, 1.72765, 1.73054, 1.6887, 1.61253, 1.91198, 2.03474, 2.02042,
                                       2.02212, 1.93377, 1.95809, 1.91686, 1.8298, 1.8685,  1.8931,  1.85149, 1.8504,
                                       1.8341,  1.8345,  1.8147,  1.78158, 1.7533, 1.6965,  1.68194, 1.64654, 1.6048,
                                       1.52143, 1.55622, 1.5113,  1.474,   1.4482, 1.41018, 1.36775, 1.34188, 1.31429};
// 1e-26 m^2 a molecule of ozone at 233 K: Gorshelev et al. 2014.
constexpr std::array<double, 36> ozone_section{0.02818, 0.06636, 0.1527, 0.2763, 0.552, 0.8451, 1.582, 2.316, 3.669,
                                               4.924,   7.752,   9.016,  14.8,   16.02, 21.39,  27.55, 30.91, 35.0,
                                               42.66,   46.72,   43.98,  47.01,  50.19, 43.05,  37.4,  32.15, 26.62,
                                               22.38,   18.52,   14.73,  12.09,  9.423, 7.455,  6.566, 5.105, 4.15};

double wavelength(int band) { return 390 + 20 * band; }  // Nanometres.

// Vertical optical depth of molecules at sea level. Bodhaine et al. 1999, equation 30.
double molecule_depth(double nanometres) {
  const double square = nanometres * nanometres * 1e-6;
  return 0.0021520 * (1.0455996 - 341.29061 / square - 0.90230850 * square) /
         (1 + 0.0027059889 / square - 85.968563 * square);
}

// CIE 1931, 2 degrees. Wyman, Sloan and Shirley 2013, equation 4.
Flux colour_matching(double nanometres) {
  const auto lobe = [&](double peak, double below, double above) {
    const double off = (nanometres - peak) / (nanometres < peak ? below : above);
    return portable::exp(-0.5 * off * off);
  };
  return {1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2),
          0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
          1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8)};
}

// Rec.709 of 1 W/m^2 of sunlight in each band.
std::array<Flux, bands> make_band_colours() {
  const ColourMatrix from_xyz = glm::inverse(to_xyz(rec709));
  std::array<Flux, bands> colours;
  for (int b = 0; b < bands; ++b) {
    Flux sum(0);
    double power = 0;
    for (int nm = 0; nm < 20; ++nm) {
      const double irradiance = solar[2 * b + nm / 10];
      sum += irradiance * colour_matching(wavelength(b) - 9.5 + nm);
      power += irradiance;
    }
    colours[b] = from_xyz * (sum / power);
  }
  return colours;
}

// ---- geometry -------------------------------------------------------------------------------------------------------

constexpr int heights = 96, angles = 512;             // Of the columns towards the sun.
constexpr int later_heights = 32, later_angles = 20;  // Of light scattered twice and more.
constexpr double thickness = top_radius - ground_radius;

Column density(double radius) {
  const double height = std::max(0.0, radius - ground_radius);
  return {portable::exp(-height / molecule_height), portable::exp(-height / haze_height),
          std::max(0.0, 1 - std::abs(height - 25e3) / 15e3)};  // Ozone: Bruneton 2017.
}

// The ray as it is at a distance from its beginning.
Ray at(const Ray& ray, double t) {
  const double r = std::sqrt(std::max(0.0, ray.radius * ray.radius + t * (t + 2 * ray.radius * ray.mu)));
  return {r, std::clamp((ray.radius * ray.mu + t) / r, -1.0, 1.0),
          std::clamp((ray.radius * ray.mu_sun + t * ray.nu) / r, -1.0, 1.0), ray.nu, ray.to_ground};
}

double length(const Ray& ray) {
  const double across = ray.radius * ray.radius * (1 - ray.mu * ray.mu), along = -ray.radius * ray.mu;
  if (ray.to_ground) return std::max(0.0, along - std::sqrt(std::max(0.0, ground_radius * ground_radius - across)));
  return std::max(0.0, along + std::sqrt(std::max(0.0, top_radius * top_radius - across)));
}

template <int N>
void add_column(Column& sum, const Ray& ray, double from, double to) {
  const auto& rule = quadrature::rule<N>();
  for (int k = 0; k < N; ++k) {
    const Column c = density(at(ray, 0.5 * (from + to) + 0.5 * (to - from) * rule.node[k]).radius);
    const double weight = 0.5 * (to - from) * rule.weight[k];
    sum.molecules += weight * c.molecules;
    sum.haze += weight * c.haze;
    sum.ozone += weight * c.ozone;
  }
}

Column operator+(const Column& a, const Column& b) {
  return {a.molecules + b.molecules, a.haze + b.haze, a.ozone + b.ozone};
}

// Where a ray's light bends: nearest to the ground, and where it enters and leaves the ground's shadow.
std::array<double, 5> breaks(const Ray& ray, double end) {
  std::array<double, 5> cut{0, end, end, end, end};
  const double along = ray.radius * ray.mu_sun, a = 1 - ray.nu * ray.nu;
  const double b = ray.radius * ray.mu - along * ray.nu;
  const double c = ray.radius * ray.radius - along * along - ground_radius * ground_radius;
  int n = 1;
  const auto add = [&](double t) {
    if (t > 0 && t < end) cut[n++] = t;
  };
  add(-ray.radius * ray.mu);
  if (const double inside = b * b - a * c; inside > 0 && a > 1e-12)
    for (const double t : {(-b - std::sqrt(inside)) / a, (-b + std::sqrt(inside)) / a})
      if (along + t * ray.nu < 0) add(t);
  std::sort(cut.begin(), cut.end());
  return cut;
}

// f(weight, the ray there, column from its beginning) at N points between each two breaks.
template <int N, class F>
Column walk(const Ray& ray, double end, F&& f) {
  const auto cut = breaks(ray, end);
  const auto& rule = quadrature::rule<N>();
  Column sum;
  double last = 0;
  for (int piece = 0; piece + 1 < int(cut.size()); ++piece) {
    const double half = 0.5 * (cut[piece + 1] - cut[piece]);
    if (half <= 0) continue;
    for (int k = N; k-- > 0;) {  // The rule's nodes fall.
      const double t = cut[piece] + half * (1 + rule.node[k]);
      add_column<3>(sum, ray, last, t);
      last = t;
      f(half * rule.weight[k], at(ray, t), sum);
    }
  }
  add_column<3>(sum, ray, last, end);
  return sum;
}

// Between four neighbours of a table of `across` columns.
struct Cell {
  int first, across;
  double right, down;
  Cell(double row, double column, int rows, int columns) : across(columns) {
    const int i = std::clamp(int(row), 0, rows - 2), j = std::clamp(int(column), 0, columns - 2);
    first = i * columns + j;
    down = row - i;
    right = column - j;
  }
  template <class Get>
  double operator()(Get&& get) const {
    return (1 - down) * ((1 - right) * get(first) + right * get(first + 1)) +
           down * ((1 - right) * get(first + across) + right * get(first + across + 1));
  }
};

double of_height(double radius, int rows) {
  return (rows - 1) * std::sqrt(std::clamp((radius - ground_radius) / thickness, 0.0, 1.0));
}
double height_of(int row, int rows) { return ground_radius + thickness * row * row / ((rows - 1.0) * (rows - 1.0)); }

}  // namespace

double horizon(double radius) {
  const double ratio = ground_radius / radius;
  return -std::sqrt(std::max(0.0, 1 - ratio * ratio));
}

double molecule_phase(double nu) { return 3 / (16 * pi) * (1 + nu * nu); }

double haze_phase(double nu) {
  constexpr double g = haze_asymmetry;
  const double x = 1 + g * g - 2 * g * nu;
  return 3 / (8 * pi) * (1 - g * g) * (1 + nu * nu) / ((2 + g * g) * x * std::sqrt(x));
}

const Spectrum& sun_irradiance() {
  static const Spectrum made = [] {
    Spectrum s;
    for (int b = 0; b < bands; ++b) s[b] = 10 * (solar[2 * b] + solar[2 * b + 1]);
    return s;
  }();
  return made;
}

const Spectrum& limb_exponent() {
  static const Spectrum made = [] {
    Spectrum s;
    for (int b = 0; b < bands; ++b) s[b] = -0.023 + 292 / wavelength(b);
    return s;
  }();
  return made;
}

Flux to_rgb(const Spectrum& spectrum) {
  static const std::array<Flux, bands> colours = make_band_colours();
  Flux sum(0);
  for (int b = 0; b < bands; ++b) sum += spectrum[b] * colours[b];
  return sum;
}

Air::Air(const Parameters& p) : p_(p) {
  const double haze_depth = (p.turbidity - 1) * molecule_depth(550);
  for (int b = 0; b < bands; ++b) {
    const double nm = wavelength(b);
    molecules_[b] = molecule_depth(nm) / molecule_height;
    haze_[b] = haze_depth / haze_height * portable::pow(nm / 550, -haze_exponent);
    haze_scattering_[b] = haze_albedo * haze_[b];
    ozone_[b] = ozone_peak * 0.5e-26 * (ozone_section[2 * b] + ozone_section[2 * b + 1]);
    albedo_[b] = nm < 490 ? p.ground.b : nm < 590 ? p.ground.g : p.ground.r;
  }
  tabulate_columns();
  if (p.multiple) tabulate_later_orders();
  ground_sky_ = sky_irradiance(ground_radius, portable::cos(p.sun_zenith));
}

double Air::depth(const Column& c, int band) const {
  return molecules_[band] * c.molecules + haze_[band] * c.haze + ozone_[band] * c.ozone;
}

// Logarithms of the columns over those of flat air: smooth in both coordinates. Of ozone the column itself.
void Air::tabulate_columns() {
  columns_.resize(std::size_t(heights) * angles);
  for_each_row(1, heights, {}, [&](int, int row) {
    const double r = height_of(row, heights), edge = horizon(r);
    const Column here = density(r);
    for (int k = 0; k < angles; ++k) {
      const double x = k / (angles - 1.0);
      const Ray ray{r, edge + (1 - edge) * x * x, 0, 0};
      const double end = length(ray), nearest = std::clamp(-ray.radius * ray.mu, 0.0, end);
      Column sum;
      add_column<32>(sum, ray, 0, nearest);
      add_column<32>(sum, ray, nearest, end);
      columns_[std::size_t(row) * angles + k] = {
          portable::log(std::max(1e-300, sum.molecules / (molecule_height * here.molecules))),
          portable::log(std::max(1e-300, sum.haze / (haze_height * here.haze))), sum.ozone};
    }
  });
}

Column Air::towards_sun(double radius, double mu) const {
  const double edge = horizon(radius), x = std::sqrt(std::max(0.0, (mu - edge) / (1 - edge)));
  const Cell cell(of_height(radius, heights), (angles - 1) * x, heights, angles);
  const double height = std::max(0.0, radius - ground_radius);
  return {molecule_height *
              portable::exp(cell([&](int k) { return columns_[k].molecules; }) - height / molecule_height),
          haze_height * portable::exp(cell([&](int k) { return columns_[k].haze; }) - height / haze_height),
          cell([&](int k) { return columns_[k].ozone; })};
}

Spectrum Air::sunlight(double radius, double mu_sun) const {
  Spectrum s{};
  if (mu_sun < horizon(radius)) return s;
  const Column c = towards_sun(radius, mu_sun);
  for (int b = 0; b < bands; ++b) s[b] = portable::exp(-depth(c, b));
  return s;
}

// Irradiance of the ground by the sun alone.
Spectrum Air::ground_light(double mu_sun) const {
  Spectrum s = sunlight(ground_radius, mu_sun);
  for (int b = 0; b < bands; ++b) s[b] *= sun_irradiance()[b] * std::max(0.0, mu_sun);
  return s;
}

// ---- light that was scattered more than once ------------------------------------------------------------------------

/// Over all directions at a point, from the air and from the ground: the mean of light scattered once and evenly, and
/// the part of an even light that returns.
struct Air::Mean {
  Spectrum air_light{}, air_part{}, ground_light{}, ground_part{};
};

Air::Mean Air::mean_over_sphere(double radius, double mu_sun) const {
  constexpr int zeniths = 8, turns = 4;
  const auto& rule = quadrature::rule<zeniths>();
  const double edge = horizon(radius), sine_sun = std::sqrt(1 - mu_sun * mu_sun);
  Mean mean;
  for (int k = 0; k < 2 * zeniths * turns; ++k) {
    const int node = k / 2 / turns;
    const bool down = k % 2 != 0;
    const double from = down ? -1 : edge, to = down ? edge : 1;
    const double mu = 0.5 * (from + to) + 0.5 * (to - from) * rule.node[node];
    const double weight = 0.25 * (to - from) * rule.weight[node] / turns;
    const double nu = mu * mu_sun + std::sqrt(1 - mu * mu) * sine_sun * portable::cos_pi((k / 2 % turns + 0.5) / turns);
    const Ray ray{radius, mu, mu_sun, std::clamp(nu, -1.0, 1.0), down};
    const double end = length(ray);
    const Column all = walk<12>(ray, end, [&](double step, const Ray& there, const Column& passed) {
      const Column here = density(there.radius);
      const Spectrum sun = sunlight(there.radius, there.mu_sun);
      for (int b = 0; b < bands; ++b) {
        const double returned = weight * step * portable::exp(-depth(passed, b)) *
                                (here.molecules * molecules_[b] + here.haze * haze_scattering_[b]);
        mean.air_part[b] += returned;
        mean.air_light[b] += returned * sun[b] * sun_irradiance()[b] / (4 * pi);
      }
    });
    if (!down) continue;
    const Spectrum ground = ground_light(at(ray, end).mu_sun);
    for (int b = 0; b < bands; ++b) {
      const double returned = weight * albedo_[b] * portable::exp(-depth(all, b));
      mean.ground_part[b] += returned;
      mean.ground_light[b] += returned * ground[b] / pi;
    }
  }
  return mean;
}

// Hillaire 2020, equations 5 to 10, with a ground that returns light of all orders. Haze deflects little of the light
// that comes up from the ground back down: that is scattered as by evenly scattering haze of 1 - g of its density (the
// similarity of van de Hulst 1974).
void Air::tabulate_later_orders() {
  later_.resize(std::size_t(later_heights) * later_angles);
  for_each_row(1, later_heights * later_angles, {}, [&](int, int k) {
    const double angle = p_.sun_zenith + p_.reach * (2.0 * (k % later_angles) / (later_angles - 1) - 1);
    const Mean m = mean_over_sphere(height_of(k / later_angles, later_heights), portable::cos(angle));
    for (int b = 0; b < bands; ++b) {
      const double once = m.air_light[b] + m.ground_light[b];
      const double all = once / std::max(1e-9, 1 - m.air_part[b] - m.ground_part[b]);
      later_[k].logarithm[b] = portable::log(std::max(1e-300, all));
      later_[k].haze[b] = all > 0 ? 1 - mean_cosine * (m.ground_light[b] / all + m.ground_part[b]) : 1;
    }
  });
}

// Scattered light a metre where the air is as dense as `here`.
Spectrum Air::later_orders(const Ray& there, const Column& here) const {
  const double off = (portable::acos(there.mu_sun) - p_.sun_zenith) / p_.reach;
  const Cell cell(of_height(there.radius, later_heights), std::clamp(0.5 * (off + 1), 0.0, 1.0) * (later_angles - 1),
                  later_heights, later_angles);
  Spectrum s;
  for (int b = 0; b < bands; ++b)
    s[b] = portable::exp(cell([&](int k) { return later_[k].logarithm[b]; })) *
           (here.molecules * molecules_[b] +
            here.haze * haze_scattering_[b] * cell([&](int k) { return later_[k].haze[b]; }));
  return s;
}

// ---- what is seen ---------------------------------------------------------------------------------------------------

Scattered Air::scattered(const Ray& ray) const {
  Scattered seen;
  const double end = length(ray);
  const Column all = walk<24>(ray, end, [&](double step, const Ray& there, const Column& passed) {
    const Column here = density(there.radius);
    if (there.mu_sun >= horizon(there.radius)) {
      const Column both = passed + towards_sun(there.radius, there.mu_sun);
      for (int b = 0; b < bands; ++b) {
        const double light = step * portable::exp(-depth(both, b));
        seen.molecules[b] += light * here.molecules * molecules_[b];
        seen.haze[b] += light * here.haze * haze_scattering_[b];
      }
    }
    if (!p_.multiple) return;
    const Spectrum later = later_orders(there, here);
    for (int b = 0; b < bands; ++b) seen.even[b] += step * portable::exp(-depth(passed, b)) * later[b];
  });
  if (!ray.to_ground) return seen;
  const Spectrum sun = ground_light(at(ray, end).mu_sun);
  for (int b = 0; b < bands; ++b)
    seen.even[b] += albedo_[b] / pi * (sun[b] + ground_sky_[b]) * portable::exp(-depth(all, b));
  return seen;
}

Spectrum Air::sky_irradiance(double radius, double mu_sun) const {
  constexpr int zeniths = 24, turns = 32;
  const auto& rule = quadrature::rule<zeniths>();
  const double sine_sun = std::sqrt(std::max(0.0, 1 - mu_sun * mu_sun));
  const auto rows = map_rows<Spectrum>(zeniths, [&](int row) {
    Spectrum sum{};
    const double x = 0.5 * (1 + rule.node[row]), mu = x * x, weight = rule.weight[row] * x * mu * 2 * pi / turns;
    for (int turn = 0; turn < turns; ++turn) {
      const double nu = mu * mu_sun + std::sqrt(1 - mu * mu) * sine_sun * portable::cos_pi((turn + 0.5) / turns);
      const Scattered s = scattered({radius, mu, mu_sun, std::clamp(nu, -1.0, 1.0)});
      for (int b = 0; b < bands; ++b)
        sum[b] += weight * (s.even[b] +
                            sun_irradiance()[b] * (molecule_phase(nu) * s.molecules[b] + haze_phase(nu) * s.haze[b]));
    }
    return sum;
  });
  Spectrum sum{};
  for (const Spectrum& row : rows)
    for (int b = 0; b < bands; ++b) sum[b] += row[b];
  return sum;
}

}  // namespace envmap::air

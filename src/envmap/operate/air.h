/// @file
/// Sunlight in spherical air, in bands of the visible spectrum.
#pragma once

#include <array>
#include <vector>

#include "envmap/maths/vector.h"

namespace envmap::air {

inline constexpr int bands = 18;  ///< 20 nm each, from 380 to 740 nm.
using Spectrum = std::array<double, bands>;

inline constexpr double ground_radius = 6371e3, top_radius = ground_radius + 100e3;  // metres
inline constexpr double haze_asymmetry = 0.8;                                        ///< Bruneton 2017.

/// Of molecules (Rayleigh) and of haze (Cornette and Shanks 1992). Per steradian.
/// @param nu cosine of the angle by which light is deflected.
double molecule_phase(double nu);
double haze_phase(double nu);

/// Irradiance of the sun outside the air, in W/m^2 a band.
const Spectrum& sun_irradiance();
/// Cosine of the zenith angle at which the ground begins, as seen at a distance from the centre of the Earth.
double horizon(double radius);
/// Exponent of the sun's darkening towards its limb, mu^alpha (Hestroffer and Magnan 1998).
const Spectrum& limb_exponent();
/// Linear Rec.709 of a spectrum in W/m^2 a band; luminance 1 for 1 W/m^2 at the peak of y.
Flux to_rgb(const Spectrum& spectrum);

/// Metres of air at the density of the ground along a line; of ozone at the density of its peak.
struct Column {
  double molecules = 0, haze = 0, ozone = 0;
};

/// A line of sight. Cosines of the zenith angles of the line and of the sun, and of the angle between the two.
struct Ray {
  double radius, mu, mu_sun, nu;
  bool to_ground = false;
};

/// Radiance along a ray: E (molecules P_m + haze P_h) + even, with E and P as above.
struct Scattered {
  Spectrum molecules{}, haze{}, even{};
};

struct Parameters {
  double turbidity;
  Rgb<double> ground;
  bool multiple;
  double sun_zenith;  ///< Radians, at the viewer.
  double reach;       ///< How far the sun's zenith angle is from that along any ray, in radians.
};

class Air {
 public:
  explicit Air(const Parameters& p);

  /// The part of the sun's light that arrives at a point; 0 in the ground's shadow.
  [[nodiscard]] Spectrum sunlight(double radius, double mu_sun) const;
  [[nodiscard]] Scattered scattered(const Ray& ray) const;
  /// Irradiance of a horizontal surface by the sky above it.
  [[nodiscard]] Spectrum sky_irradiance(double radius, double mu_sun) const;

 private:
  struct Mean;
  /// Logarithm of the mean radiance scattered twice or more, and which part of the haze scatters it.
  struct Later {
    Spectrum logarithm, haze;
  };
  [[nodiscard]] double depth(const Column& c, int band) const;
  [[nodiscard]] Column towards_sun(double radius, double mu) const;
  [[nodiscard]] Spectrum ground_light(double mu_sun) const;
  [[nodiscard]] Mean mean_over_sphere(double radius, double mu_sun) const;
  [[nodiscard]] Spectrum later_orders(const Ray& there, const Column& here) const;
  void tabulate_columns();
  void tabulate_later_orders();

  Parameters p_;
  Spectrum molecules_{}, haze_scattering_{}, haze_{}, ozone_{}, albedo_{};  // Per metre; albedo of 1.
  Spectrum ground_sky_{};                                                   // Irradiance of the ground by the sky.
  std::vector<Column> columns_;
  std::vector<Later> later_;
};

}  // namespace envmap::air

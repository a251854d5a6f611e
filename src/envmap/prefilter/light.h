/// @file
/// A part of the source as a lobe sees it from afar: its flux, where it lies and how it spreads.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "envmap/prefilter/patch.h"

namespace envmap {

/// Red, green and blue flux, in units of the source's mean radiance, and steradians: what a white map would give.
inline constexpr std::size_t light_channels = 4;
using LightFlux = std::array<float, light_channels>;

/// Moments of the flux over a block of texels. Place and spread are those of all channels together; what sets a channel
/// apart is its dipole, and beyond that a bound.
struct Light {
  Direction centre{0};  ///< Mean direction: inside the sphere, by half the variance.
  Symmetric covariance{};
  LightFlux flux{};
  std::array<Vec3<float>, light_channels> dipole{};  ///< Of each channel about the centre: sum of flux x offset.
  float uneven = 0;  ///< No channel's second moment, over its flux, is farther than this from the covariance.
  float spread = 0;  ///< Cube root of the mean |offset|^3, that of the channel where it is largest, or above.
  float reach = 0;   ///< No direction is farther from the centre.
};

/// Even radiance over a patch. @param radiance in units of the mean.
Light light_of(const Patch& patch, const Flux& radiance);

/// Several as one.
Light united(std::span<const Light> parts);

/// Many texels as one light, faster than united(): texels of a row share their covariance, spread and reach.
class LightSum {
 public:
  /// Begins a row. @param alike one of its texels; its place and solid angle count nothing.
  void start(const Patch& alike);
  /// @param middle a unit vector. @param radiance in units of the mean.
  void add(const Direction& middle, double solid_angle, const Flux& radiance);
  [[nodiscard]] Light light() const;
  void clear() { rows_.clear(), texels_.clear(); }

 private:
  struct Row {
    Patch alike;
    double inside;  // Length of a texel's mean direction.
    std::size_t first;
  };
  struct Texel {
    Direction centre;
    LightFlux flux;
  };
  std::vector<Row> rows_;
  std::vector<Texel> texels_;
};

}  // namespace envmap

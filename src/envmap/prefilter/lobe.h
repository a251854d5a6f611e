/// @file
/// Lobes: what radiance is weighed with about each direction of a prefiltered map.
#pragma once

#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

/// `table` stays the last.
enum class LobeShape { diffuse, phong, ggx, blinn_phong, charlie, table };
inline constexpr std::string_view lobe_shape_names[] = {"diffuse", "phong", "ggx", "blinn-phong", "charlie", "table"};
/// The shapes that a name and a parameter say in full: all but tables.
inline constexpr std::span<const std::string_view> parametric_lobe_names{lobe_shape_names,
                                                                         std::size(lobe_shape_names) - 1};
template <>
inline constexpr std::size_t enumerators<LobeShape> = std::size(lobe_shape_names);

/// NaN: a shape that has a parameter is refused without one.
inline constexpr double unset_parameter = std::numeric_limits<double>::quiet_NaN();

/// A value of a tabulated lobe at a cosine of the angle to its middle.
struct LobeSample {
  double cosine, value;
};

/// One lobe. With L the radiance of the source, constant over each of its texels, every lobe 0 below the horizon, and k
/// the scale of the map:
///   diffuse  E(n) = (k / pi) integral of L(l) cos(n,l) dl
///   phong    R(r) = k integral of L(l) cos(r,l)^m dl; k = (m + 1) / (2 pi) if nothing is said
///   ggx      R(r) = k integral of L(l) D(h) cos(n,l) dl / integral of D(h) cos(n,l) dl, with n = v = r, h half way
///            between r and l, D Trowbridge and Reitz's, a = roughness^2
///   blinn-phong  the same with D(h) = cos(n,h)^m
///   charlie      the same with D(h) = sin(n,h)^(1/a), a = roughness^2
///   table        R(r) = k integral of L(l) f(cos(r,l)) dl / integral of f(cos(r,l)) dl, with f linear between samples
class Lobe {
 public:
  static Lobe diffuse() { return Lobe(LobeShape::diffuse); }
  static Lobe phong(double exponent) { return Lobe(LobeShape::phong, exponent); }
  /// @param roughness perceptual, 0 to 1. A lobe of roughness 0 is a mirror's.
  static Lobe ggx(double roughness) { return Lobe(LobeShape::ggx, roughness); }
  static Lobe blinn_phong(double exponent) { return Lobe(LobeShape::blinn_phong, exponent); }
  /// @param roughness perceptual, 0 to 1.
  static Lobe charlie(double roughness) { return Lobe(LobeShape::charlie, roughness); }
  /// A lobe that was measured or computed. Copies of it share the samples.
  /// @param samples by rising or falling cosine, 0 to 1, at least 1e-9 apart. One is at cosine 1. The lobe is 0 below
  /// the least cosine: it breaks off there unless that value is 0. Values are finite, not negative, and not all 0.
  /// @throws UsageError
  static Lobe table(std::vector<LobeSample> samples);

  /// @param parameter exponent of phong and blinn-phong, 0 to 1e9, or roughness of ggx and charlie, 0 to 1: they need
  /// one. diffuse has none, and refuses one. table() makes tables. @throws UsageError
  explicit Lobe(LobeShape shape, double parameter = unset_parameter);

  [[nodiscard]] LobeShape shape() const { return shape_; }
  [[nodiscard]] double parameter() const { return parameter_; }  ///< NaN for diffuse and tables.
  [[nodiscard]] std::span<const LobeSample> samples() const;     ///< By rising cosine; empty but for tables.

  /// Whether it is ggx of roughness 0. The result has the texels of the source where it has the same grid. Else each
  /// texel is the mean of the source over it, by the area filter, so that flux is kept.
  [[nodiscard]] bool is_mirror() const { return shape_ == LobeShape::ggx && parameter_ == 0; }

 private:
  LobeShape shape_;
  double parameter_;
  std::shared_ptr<const std::vector<LobeSample>> samples_ = {};
};

/// Lobes of one shape, one for each parameter: of the levels of a chain. @throws UsageError as Lobe does.
std::vector<Lobe> lobes_of(LobeShape shape, std::span<const double> parameters);

}  // namespace envmap

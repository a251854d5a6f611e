/// @file
/// Diffuse, Phong and GGX maps, by the method that meets an error.
#pragma once

#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/lobe.h"
#include "envmap/sample/filter.h"

namespace envmap::prefiltering {
class PreparedSource;
}

namespace ENVMAP_EXPORT envmap {

enum class Shape { diffuse, phong, ggx, blinn_phong, charlie };
inline constexpr std::string_view shape_names[] = {Cosine::name, Phong::name, Ggx::name, BlinnPhong::name,
                                                   Charlie::name};
template <>
inline constexpr std::size_t enumerators<Shape> = std::size(shape_names);

enum class Method { automatic, exact, treecode, prefix_sums, multilevel };
inline constexpr std::string_view method_names[] = {"auto", "exact", "treecode", "prefix-sums", "multilevel"};
template <>
inline constexpr std::size_t enumerators<Method> = std::size(method_names);
/// What the treecode was called up to version 1.0.
inline constexpr std::string_view former_name_of_treecode = "hierarchical";

/// NaN: a lobe that has a parameter is refused without one.
inline constexpr double unset_parameter = std::numeric_limits<double>::quiet_NaN();

/// One map to make. With L the radiance of the source, constant over each of its texels, and every lobe 0 below the
/// horizon:
///   diffuse  E(n) = (k / pi) integral of L(l) cos(n,l) dl
///   phong    R(r) = k integral of L(l) cos(r,l)^m dl; k = (m + 1) / (2 pi) if nothing is said
///   ggx      R(r) = k integral of L(l) D(h) cos(n,l) dl / integral of D(h) cos(n,l) dl, with n = v = r, h half way
///            between r and l, D Trowbridge and Reitz's, a = roughness^2
///   blinn-phong  the same with D(h) = cos(n,h)^m
///   charlie      the same with D(h) = sin(n,h)^(1/a), a = roughness^2
struct Prefilter {
  Shape shape = Shape::diffuse;
  /// Exponent m of phong and blinn-phong, 0 to 1e9, or perceptual roughness of ggx and charlie, 0 to 1: they need one.
  /// diffuse has none, and refuses one.
  double parameter = unset_parameter;
  std::optional<double> scale = {};  ///< k; otherwise white stays 1.
  Projection to = Projection::cube;
  int size = 64;  ///< Height of a face.
  Forward forward = Forward::plus_z;
  Method method = Method::automatic;
  /// Which rows of the result to make, `size` for each face, true or false; empty: all.
  /// They come out as in the whole map.
  std::vector<char> rows = {};
  double max_error = 1e-3;  ///< Metric `max` of compare(): of every texel.
};

/// How often a method took one of its steps, such as "taps": the same on every machine and for any number of threads.
struct StepCount {
  std::string_view step;
  std::uint64_t count;
};

/// What was done, and how far any texel is off.
struct Prefiltered {
  EnvironmentMap map;
  Method method;  ///< Never automatic: that of most texels.
  double seconds = 0;
  /// The largest bound of a texel, relative to it or to `floor`; 0 for exact sums and copied texels.
  double error = 0;
  double floor = 0;        ///< 0.001 x the solid-angle mean of the source, times k: smaller results are held to it.
  std::int64_t exact = 0;  ///< Texels that were summed exactly, since nothing faster was sure enough of them.
  std::optional<Filter> resampled = {};  ///< Of a mirror: the filter that made it, or nearest where texels were copied.
  std::vector<StepCount> work = {};      ///< Steps that were taken. Those of other maps made meanwhile count, too.
};

/// The levels of a chain, and how each was made: Prefiltered without its map.
struct PrefilteredChain {
  EnvironmentMap map;
  std::vector<Prefiltered> levels;
};

/// The filter of a mirror, else the method.
std::string_view method_name(const Prefiltered& done);

/// Whether the lobe is a mirror's, ggx of roughness 0. The result has the texels of the source where it has the same
/// grid. Else each texel is the mean of the source over it, by the area filter, so that flux is kept.
inline bool is_mirror(const Prefilter& p) { return p.shape == Shape::ggx && p.parameter == 0; }

/// @throws UsageError where the parameter is out of its range, or set where the lobe has none.
Lobe lobe_of(const Prefilter& wanted);

/// A map prepared for prefiltering: many lobes share the work. Safe for several threads at once: they take turns, and
/// each turn uses all cores. A result does not depend on the lobes that were made before.
class PrefilterSource {
 public:
  /// A map that is neither a cube nor latlong is prefiltered as the cube that convert() makes of it, by the area filter
  /// at its own density: its texels are samples of an image on a disc, which no rim should cut.
  /// @param map must outlive it. @param run of the cube, where one is made.
  /// @throws InputError where a texel is NaN, infinite or negative: bounds of errors are of radiance.
  explicit PrefilterSource(const EnvironmentMap& map, const Run& run = {});
  /// Takes the map over.
  explicit PrefilterSource(EnvironmentMap&& map, const Run& run = {});
  ~PrefilterSource();
  PrefilterSource(PrefilterSource&&) noexcept;  ///< One that was moved from can only be assigned to.
  PrefilterSource& operator=(PrefilterSource&&) noexcept;

  /// What is prefiltered, radiance constant over each texel, and what errors are counted from: the map or its cube.
  [[nodiscard]] const EnvironmentMap& source() const;

  /// Makes one map. Every texel has a bound of its error: proved, but for multilevel sums, whose bound has a factor of
  /// the lobe that was measured. `automatic` takes the method of the least predicted cost. Texels whose bound is over
  /// the error wanted are summed exactly.
  /// @throws UsageError where a field is out of its range (bounds.h).
  Prefiltered make(const Prefilter& wanted, const Run& run = {}) const;

  /// Makes the levels of a chain: level k is as `base` with parameter k, and its height is base.size / 2^k, rounded
  /// down, at least 1. level_roughnesses() has the parameters that engines look for.
  /// @param base `parameter` has no meaning, and `rows` must be empty.
  /// @throws UsageError where a field is out of its range (bounds.h), or where there are more levels than halve the
  /// first down to one texel: write() and pack() take no others.
  PrefilteredChain make_chain(const Prefilter& base, std::span<const double> parameters, const Run& run = {}) const;

 private:
  Prefiltered make_now(const Prefilter& wanted, const Progress& progress) const;

  std::unique_ptr<prefiltering::PreparedSource> prepared_;
};

}  // namespace envmap

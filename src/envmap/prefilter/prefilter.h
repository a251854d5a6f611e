/// @file
/// Diffuse, Phong and GGX maps, by the method that meets an error.
#pragma once

#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
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

enum class Method { automatic, exact, treecode, prefix_sums, multilevel };
inline constexpr std::string_view method_names[] = {"auto", "exact", "treecode", "prefix-sums", "multilevel"};
template <>
inline constexpr std::size_t enumerators<Method> = std::size(method_names);
/// What the treecode was called up to version 1.0.
inline constexpr std::string_view former_name_of_treecode = "hierarchical";

/// One map to make.
struct PrefilterOptions {
  Lobe lobe = Lobe::diffuse();
  std::optional<double> scale = {};  ///< k of lobe.h; otherwise white stays 1.
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

/// @throws UsageError where the method does not make the lobe to the error.
void check_method(const PrefilterOptions& options);

/// A map prepared for prefiltering: many lobes share the work. Safe for several threads at once: they take turns, and
/// each turn uses all cores. A result does not depend on the lobes that were made before.
class Prefilterer {
 public:
  /// A map that is neither a cube nor latlong is prefiltered as the cube that convert() makes of it, by the area filter
  /// at its own density: its texels are samples of an image on a disc, which no rim should cut.
  /// @param map is shared: it must not change. @param run of the cube, where one is made.
  /// @throws InputError where a texel is NaN, infinite or negative: bounds of errors are of radiance.
  explicit Prefilterer(std::shared_ptr<const EnvironmentMap> map, const Run& run = {});
  /// Copies the map, or takes it over.
  explicit Prefilterer(const EnvironmentMap& map, const Run& run = {}) : Prefilterer(map.clone(), run) {}
  explicit Prefilterer(EnvironmentMap&& map, const Run& run = {})
      : Prefilterer(std::make_shared<const EnvironmentMap>(std::move(map)), run) {}
  ~Prefilterer();
  Prefilterer(Prefilterer&&) noexcept;  ///< One that was moved from can only be assigned to.
  Prefilterer& operator=(Prefilterer&&) noexcept;

  /// What is prefiltered, radiance constant over each texel, and what errors are counted from: the map or its cube.
  [[nodiscard]] const EnvironmentMap& source() const;

  /// Makes one map. Every texel has a bound of its error: proved, but for multilevel sums, whose bound has a factor of
  /// the lobe that was measured. `automatic` takes the method of the least predicted cost. Texels whose bound is over
  /// the error wanted are summed exactly.
  /// @throws UsageError where a field is out of its range (bounds.h). AccuracyError where a texel of a table would take
  /// too many nodes: tables have no exact sum.
  Prefiltered make(const PrefilterOptions& wanted, const Run& run = {}) const;

  /// Makes the levels of a chain, one for each lobe: level k is as `base` with lobe k, and its height is
  /// base.size / 2^k, rounded down, at least 1. level_roughnesses() has what engines look for.
  /// @param base of all levels; `lobe` must be as it is by default, and `rows` empty.
  /// @throws UsageError where a field is out of its range (bounds.h), or where there are more levels than halve the
  /// first down to one texel: write() and pack() take no others.
  PrefilteredChain make_chain(std::span<const Lobe> lobes, const PrefilterOptions& base = {},
                              const Run& run = {}) const;

 private:
  Prefiltered make_now(const PrefilterOptions& wanted, const Progress& progress) const;

  std::unique_ptr<prefiltering::PreparedSource> prepared_;
};

}  // namespace envmap

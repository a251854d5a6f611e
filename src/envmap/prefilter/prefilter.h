/// @file
/// Diffuse, Phong and GGX maps, by the method that meets an error.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/map/environment_map.h"
#include "envmap/base/progress.h"
#include "envmap/prefilter/lobe.h"

namespace ENVMAP_EXPORT envmap {

enum class Shape { diffuse, phong, ggx };
inline constexpr std::string_view shape_names[] = {"diffuse", "phong", "ggx"};

enum class Method { automatic, exact, hierarchical, spectral, sh };
inline constexpr std::string_view method_names[] = {"auto", "exact", "hierarchical", "spectral", "sh"};

/// One map to make. With L the radiance of the source, constant over each of its texels, and every lobe 0 below the
/// horizon:
///   diffuse  E(n) = (k / pi) integral of L(l) cos(n,l) dl
///   phong    R(r) = k integral of L(l) cos(r,l)^m dl; k = (m + 1) / (2 pi) if nothing is said
///   ggx      R(r) = k integral of L(l) D(h) cos(n,l) dl / integral of D(h) cos(n,l) dl, with n = v = r, h half way
///            between r and l, D Trowbridge and Reitz's, a = roughness^2
struct Prefilter {
  Shape shape = Shape::diffuse;
  double parameter = 0;         ///< Exponent m, or perceptual roughness from 0 to 1.
  std::optional<double> scale;  ///< k; otherwise white stays 1.
  Projection to = Projection::cube;
  int size = 64;  ///< Height of a face.
  Forward forward = Forward::plus_z;
  Method method = Method::automatic;
  int order = 0;            ///< Of the method sh; 0: what the lobe needs, at most 32.
  double max_error = 1e-3;  ///< Metric `max` of compare().
};

/// What was done, and what it was measured to do.
struct Prefiltered {
  EnvironmentMap map;
  Method method;                ///< Never automatic.
  double seconds = 0;           ///< To make it, without the check.
  double error = 0;             ///< Largest of the directions checked; 0 for the exact method.
  std::int64_t directions = 0;  ///< Checked.
  bool reached = true;          ///< error <= max_error, or the exact method.
};

/// Whether the lobe is a mirror's, ggx of roughness 0: the result is then the texel of the source in its direction.
inline bool is_mirror(const Prefilter& p) { return p.shape == Shape::ggx && p.parameter == 0; }

/// @throws UsageError where the parameter is out of its range.
Lobe lobe_of(const Prefilter& wanted);

/// A map prepared for prefiltering: many lobes share the work. Not for several threads at once.
class PrefilterSource {
 public:
  /// @param map must outlive it.
  explicit PrefilterSource(const EnvironmentMap& map);
  ~PrefilterSource();
  PrefilterSource(const PrefilterSource&) = delete;

  /// Makes one map and checks it: `automatic` refines until the error is met, and turns to the exact method where
  /// nothing faster does: spectral where the result has many texels for the lobe's width and no sun asks for more degrees
  /// than there are, else hierarchical. `hierarchical` refines, too; the others do what they are told and say how it went.
  ///
  /// Results are checked by verify().
  Prefiltered make(const Prefilter& wanted, const Progress& progress = {}) const;

 private:
  struct Prepared;
  const EnvironmentMap& map_;
  std::unique_ptr<Prepared> prepared_;
};

}  // namespace envmap

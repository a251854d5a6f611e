/// @file
/// A lobe as the treecode sums it: P(t+) + K, with t the cosine.
///
/// Where the horizon cuts a node and the slope of the lobe jumps there, a Taylor series is of no use. So the first
/// terms of the lobe's series in t at the horizon, P, go to prefix sums with a bound of their own (prefix_sums.h). The
/// nodes sum the rest, K, which is smoother at the horizon.
#pragma once

#include <variant>

#include "envmap/prefilter/lobe_formulas.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"

namespace envmap::prefiltering {

struct TreecodeLobe {
  LobeFormula lobe;
  ClampedCosinePolynomial horizon_terms;  ///< P.
  /// Number of derivatives of K that are bounded at the horizon, up to 4. All but the last are continuous. A Phong lobe
  /// of exponent 1 < m < 2 has only the first, which changes by at most m s^(m-1) over a step of s.
  int smooth = 4;

  [[nodiscard]] bool has_horizon_terms() const { return horizon_terms.integral() > 0; }
  /// Whether K is not 0.
  [[nodiscard]] bool has_rest() const;
};

/// @return nothing for Phong lobes of exponent 0 to 1, which jump or have an unbounded slope at the horizon.
std::optional<TreecodeLobe> treecode_lobe(const LobeFormula& lobe);

}  // namespace envmap::prefiltering

/// @file
/// A lobe as a treecode sums it: what bends at the horizon goes to prefix sums (prefix_sums.h), the rest to the nodes.
///
/// A Taylor series is of no use where the horizon cuts a node and the lobe has a kink there. With t = cos, the lobe is
/// P(t+) + K, P a polynomial that hinges sum with a bound of their own, and K smoother at the horizon.
#pragma once

#include <variant>

#include "envmap/prefilter/lobe.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"

namespace envmap::prefiltering {

struct TreecodeLobe {
  Lobe lobe;
  HingePolynomial hinges;  ///< P.
  /// K has so many bounded derivatives where the horizon cuts a node, up to 4. All but the last are continuous. Of a
  /// Phong lobe of exponent 1 < m < 2 the first alone, which changes by at most m s^(m-1) over s.
  int smooth = 4;

  [[nodiscard]] bool has_hinges() const { return hinges.integral() > 0; }
  /// Whether anything is left to the nodes.
  [[nodiscard]] bool has_rest() const;
};

/// P of Blinn's lobe: the binomial series of k t ((1 + t) / 2)^p. Of powers below 1 the third term is below 0, and
/// stays with K.
HingePolynomial blinn_hinges(const BlinnPhong& lobe);

/// Nothing for Phong lobes of exponent 0 to 1, which break off at the horizon.
std::optional<TreecodeLobe> treecode_lobe(const Lobe& lobe);

}  // namespace envmap::prefiltering

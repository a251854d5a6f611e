// The split of each lobe at the horizon.
#include "envmap/prefilter/treecode/lobe_bounds.h"

#include <algorithm>

namespace envmap::prefiltering {
namespace {

// Trowbridge-Reitz is k t / (A - B t)^2 with A = a + b and B = b. All terms of its series in t are above 0.
TreecodeLobe split(const Ggx& l) {
  const double whole = l.a + l.b, first = l.scale / (whole * whole), ratio = l.b / whole;
  return {l, {{first, 2 * first * ratio, 3 * first * ratio * ratio}}, 4};
}

TreecodeLobe split(const BlinnPhong& l) { return {l, blinn_horizon_terms(l), l.power >= 1 ? 4 : 3}; }

// Only the first term: those after it alternate and are many times the lobe.
TreecodeLobe split(const Charlie& l) { return {l, {{l.kink(), 0, 0}}, 2}; }

}  // namespace

bool TreecodeLobe::has_rest() const { return !clamped_cosine_polynomial(lobe); }

std::optional<TreecodeLobe> treecode_lobe(const LobeFormula& lobe) {
  if (const auto whole = clamped_cosine_polynomial(lobe)) return TreecodeLobe{lobe, *whole, 4};
  if (const auto* phong = std::get_if<Phong>(&lobe)) {
    if (phong->exponent <= 1) return std::nullopt;
    return TreecodeLobe{lobe, {}, int(std::min(4.0, phong->exponent))};
  }
  if (const auto* ggx = std::get_if<Ggx>(&lobe)) return split(*ggx);
  if (const auto* blinn = std::get_if<BlinnPhong>(&lobe)) return split(*blinn);
  return split(std::get<Charlie>(lobe));
}

}  // namespace envmap::prefiltering

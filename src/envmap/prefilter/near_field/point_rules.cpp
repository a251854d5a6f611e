// The limits of the rules follow from the remainder of Gauss's rules. That of N points is N!^4 / ((2N + 1) (2N)!^3)
// times the 2N-th derivative (Abramowitz and Stegun 1964, 25.4.30): 1e-5 to 5e-5 of a texel.
#include "envmap/prefilter/near_field/point_rules.h"

#include <algorithm>
#include <cmath>

namespace envmap::prefiltering {
namespace {

// The variation over a panel of a face up to which its error is below kappa (tests/bench/kappa.cpp).
constexpr double widest_panel = 1.35;

// A rule for sides over which a power falls far.
struct SteepRule {
  SideRule rule;
  double part;  // Keeps the remainder below that of four points.
};

// Points times points rise by less than 1.6 from rule to rule.
const std::array<SteepRule, 9>& steep_rules() {
  using quadrature::rule;
  static const std::array<SteepRule, 9> rules{{{four_points, 1},
                                               {SideRule(rule<5>()), 1.5},
                                               {SideRule(rule<6>()), 2.1},
                                               {SideRule(rule<7>()), 2.75},
                                               {SideRule(rule<8>()), 3.4},
                                               {SideRule(rule<10>()), 4.7},
                                               {SideRule(rule<12>()), 6.05},
                                               {SideRule(rule<14>()), 7.4},
                                               {SideRule(rule<16>()), 8.8}}};
  return rules;
}

const SteepRule& steepest(const LevelKernel& k, double side) {
  const double variation = variation_over(k, side);
  for (const SteepRule& r : steep_rules())
    if (variation <= r.part) return r;
  return steep_rules().back();
}

}  // namespace

double variation_over(const LevelKernel& k, double side) {
  return side * double(k.power * k.part) * (std::sqrt(2 * double(k.end)) + side) / double(k.max_variation);
}

std::optional<int> panels_on_face(const LevelKernel& k, double side) {
  constexpr double narrow = 1.6e-2;
  constexpr int most = 10;  // Points cost less from there on.
  const int panels = std::max(1, int(std::ceil(variation_over(k, side) / widest_panel)));
  if (k.kind != LevelKernel::Kind::power || k.part * k.end > narrow || panels > most) return std::nullopt;
  return panels;
}

double reach_of_panels(const LevelKernel& k, double side, int panels) {
  return widest_panel * panels * double(k.max_variation) / (side * double(k.power * k.part)) - side;
}

const SideRule& steepest_rule(const LevelKernel& k, double side) { return steepest(k, side).rule; }

// A power takes as many points as it needs where it is steepest, and multiples of four on the way there.
Rules rules_of(const LevelKernel& k, double side) {
  Rules rules;
  if (k.kind == LevelKernel::Kind::ggx) {
    rules.add(two_points, 0.028), rules.add(three_points, 0.175), rules.add(four_points, 0.45);
    return rules;
  }
  rules.add(two_points, 0.06), rules.add(three_points, 0.4);
  const SteepRule& last = steepest(k, side);
  for (const SteepRule& r : steep_rules())
    if (&r == &last || (&r < &last && r.rule.count % 4 == 0)) rules.add(r.rule, r.part);
  return rules;
}

// The steepness rises with the distance from the middle, and the number of texels with its square.
double points_in_texel(const LevelKernel& k, double side) {
  const Rules rules = rules_of(k, side);
  const double variation = variation_over(k, side);
  double sum = 0, served = 0;
  for (const RuleAcross& r : rules.used()) {
    const bool last = &r == &rules.used().back();
    const double within = last ? 1 : std::min(1.0, (r.part / variation) * (r.part / variation));
    sum += (within - served) * double(r.rule->count * r.rule->count), served = within;
  }
  return sum;
}

}  // namespace envmap::prefiltering

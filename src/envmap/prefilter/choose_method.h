/// @file
/// The quickest way to make a map within an error: what each method would take, in one unit, by counted work.
#pragma once

#include <optional>

#include "envmap/prefilter/multilevel/multilevel.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"
#include "envmap/prefilter/sheen/sheen.h"
#include "envmap/prefilter/treecode/lobe_bounds.h"

namespace envmap::prefiltering {

struct Choice {
  Method method = Method::exact;
  double cost = 0;                        ///< About, in nanoseconds of two cores, with what the source takes.
  std::optional<HingePolynomial> hinges;  ///< Of prefix sums.
  std::optional<MultilevelPlan> plan;     ///< Of multilevel sums,
  std::optional<SheenPlan> sheen;         ///< or those of sheen.
  std::optional<TreecodeLobe> tree;       ///< Of the treecode.
};

/// @param texels of the whole result. @param wanted a method, or the quickest that serves.
Choice choose(const Lobe& lobe, const Level& source, double texels, double error, Method wanted);

}  // namespace envmap::prefiltering

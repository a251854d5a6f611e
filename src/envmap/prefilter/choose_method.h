/// @file
/// The method of least predicted cost that makes a map within an error. One table of costs, in nanoseconds for each
/// unit of counted work, predicts all methods.
#pragma once

#include <variant>

#include "envmap/prefilter/multilevel/multilevel.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"
#include "envmap/prefilter/sheen/sheen.h"
#include "envmap/prefilter/treecode/lobe_bounds.h"

namespace envmap::prefiltering {

/// A method and its plan for a map. `plan` is empty for the exact sum.
struct Choice {
  Method method = Method::exact;
  double cost = 0;  ///< In nanoseconds of two cores, preparing the source included.
  std::variant<std::monostate, ClampedCosinePolynomial, MultilevelPlan, SheenPlan, TreecodeLobe> plan = {};
};

/// @param texels of the whole result. @param wanted a method, or automatic for the quickest.
Choice choose(const LobeFormula& lobe, const Level& source, double texels, double error, Method wanted);

}  // namespace envmap::prefiltering

// The predicted cost of a map between neighbouring parameters of a lobe: nobody should wait ten times as long for a
// lobe that is 5% narrower. work_counters_test.cpp holds the predictions to the work that is done.
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "envmap/prefilter/choose_method.h"
#include "envmap/prefilter/near_field/point_rules.h"

namespace envmap::cost_steps_test {
namespace {

using namespace envmap::prefiltering;

struct Family {
  const char* name;
  double least, most;
  double most_ratio;
  std::function<LobeFormula(double)> lobe;
};
// The grids of ggx are powers of two, so that the levels of a chain share them: one more costs a small map almost
// twice.
const std::array families{Family{"ggx", 0.02, 1, 2, [](double x) { return LobeFormula(Ggx(x)); }},
                          Family{"phong", 5, 1e6, 1.7, [](double x) { return LobeFormula(Phong{x}); }},
                          Family{"blinn-phong", 1, 1e6, 1.7, [](double x) { return LobeFormula(BlinnPhong(x)); }},
                          Family{"charlie", 0.1, 1, 1.7, [](double x) { return LobeFormula(Charlie(x)); }}};

// What makes a method another one, whose cost is its own: the near field of latlong maps, prefix sums at the horizon,
// and the widths of texels over which the near field of a power is interpolated.
std::array<int, 4> kind_of(const Choice& choice, const Level& source) {
  const auto* plan = std::get_if<MultilevelPlan>(&choice.plan);
  if (plan == nullptr) return {int(choice.method), -1, -1, -1};
  const bool power = plan->near_field ? plan->near_field->kind == LevelKernel::Kind::power
                                      : plan->steps[0].kernel.kind == LevelKernel::Kind::power;
  if (power && source.projection() == Projection::cube)
    return {int(choice.method), 0, int(plan->has_horizon_terms()), 0};
  const bool by_points = plan->near_field && source.projection() == Projection::latlong &&
                         variation_over(*plan->near_field, pi / source.height()) > most_panels;
  return {int(choice.method), int(plan->near_field.has_value()), int(plan->has_horizon_terms()), int(by_points)};
}

TEST(CostSteps, NeighboursCostAboutTheSame) {
  std::array<Level, 4> sources{Level(Projection::latlong, 2048), Level(Projection::latlong, 512),
                               Level(Projection::cube, 1024), Level(Projection::cube, 256)};
  int compared = 0;
  for (const Family& family : families)
    for (const Level& source : sources)
      for (const int size : {64, 256})
        for (const double error : {1e-3, 5e-4, 1e-4}) {
          Choice before;
          for (double x = family.least; x <= family.most; x *= 1.05) {
            Choice now = choose(family.lobe(x), source, 6.0 * size * size, error, Method::automatic);
            if (before.cost > 0 && kind_of(before, source) == kind_of(now, source)) {
              ++compared;
              const double ratio = now.cost / before.cost;
              EXPECT_LT(std::max(ratio, 1 / ratio), family.most_ratio)
                  << family.name << ' ' << x << ", " << source.height() << " rows, " << size << ", " << error;
            }
            before = std::move(now);
          }
        }
  EXPECT_GT(compared, 10000);
}

}  // namespace
}  // namespace envmap::cost_steps_test
